#pragma once

namespace canopus::cli {

/// "0.1.0": the contents of the file VERSION.
[[nodiscard]] const char* version() noexcept;

}  // namespace canopus::cli
