#pragma once

#include <vector>

#include "canopus/module/engine/module_context.hpp"
#include "canopus/module/interface/led.hpp"

namespace canopus::module {

/// What the LEDs of the model show. `last_frame`: when one was sent or received last; can::Time{} if none was.
[[nodiscard]] std::vector<Led> leds_of(const ModuleContext& parts, can::Time last_frame, can::Time now);

}  // namespace canopus::module
