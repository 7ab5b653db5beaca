#pragma once

namespace canopus::app {

/// "0.1.0": what the file VERSION says.
[[nodiscard]] const char* version() noexcept;

}  // namespace canopus::app
