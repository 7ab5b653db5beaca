#pragma once

namespace canopus::cli {

/// "0.1.0": what the file VERSION says.
[[nodiscard]] const char* version() noexcept;

}  // namespace canopus::cli
