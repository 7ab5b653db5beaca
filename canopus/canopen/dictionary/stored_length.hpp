#pragma once

#include <cstddef>
#include <cstdint>

namespace canopus::canopen {

/// Bytes of a value's length.
enum class StoredLength : std::uint8_t { two_bytes = 2, four_bytes = 4 };
/// The longest value that can be stored, in bytes.
[[nodiscard]] constexpr std::size_t longest_stored_value(StoredLength form) noexcept {
  return form == StoredLength::two_bytes ? 0xFFFF : 0xFFFF'FFFF;
}

}  // namespace canopus::canopen
