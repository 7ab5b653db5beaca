#pragma once

#include <memory>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::module::fx3u_can {

/// The object dictionary in CANopen 405 mode [FX3U-CAN 5.6, 5.9].
[[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> object_dictionary();

}  // namespace canopus::module::fx3u_can
