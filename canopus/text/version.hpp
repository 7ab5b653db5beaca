#pragma once

namespace canopus::text {

/// The contents of the file VERSION, for example "1.0.0".
[[nodiscard]] const char* program_version() noexcept;

}  // namespace canopus::text
