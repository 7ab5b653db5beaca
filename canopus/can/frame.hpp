#pragma once
// A classical CAN frame, data or remote, with an 11-bit (base) or 29-bit (extended) identifier [ISO 11898-1].

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace canopus::can {

inline constexpr std::uint32_t max_base_identifier = 0x7FF;
inline constexpr std::uint32_t max_extended_identifier = 0x1FFF'FFFF;

/// 16 bytes, trivially copyable. Bytes beyond length() are 0, so frames compare as values.
struct Frame {
  std::uint32_t identifier = 0;  ///< 0..7FFH, or 0..1FFFFFFFH when extended
  bool extended = false;         ///< 29-bit identifier (IDE recessive)
  bool remote = false;           ///< remote frame (RTR recessive): no data; dlc is the requested length
  std::uint8_t dlc = 0;          ///< 0..15 as on the wire; 9..15 mean 8 bytes
  alignas(8) std::array<std::uint8_t, 8> data{};  // aligned: frames are copied and compared as two words

  /// Number of data bytes on the wire, 0..8: 0 for a remote frame.
  [[nodiscard]] constexpr std::size_t length() const noexcept {
    return remote ? 0 : std::min<std::size_t>(dlc, 8);
  }
  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const noexcept {
    return {data.data(), length()};
  }

  friend constexpr bool operator==(const Frame&, const Frame&) = default;
};
static_assert(sizeof(Frame) == 16);

/// A base data frame: `data_frame(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0})`. At most 8 bytes.
constexpr Frame data_frame(std::uint32_t identifier, std::span<const std::uint8_t> bytes) noexcept {
  Frame frame{.identifier = identifier};
  frame.dlc = static_cast<std::uint8_t>(std::min<std::size_t>(bytes.size(), 8));
  std::copy_n(bytes.begin(), frame.dlc, frame.data.begin());
  return frame;
}
constexpr Frame data_frame(std::uint32_t identifier,
                           std::initializer_list<std::uint8_t> bytes = {}) noexcept {
  return data_frame(identifier, std::span<const std::uint8_t>(bytes.begin(), bytes.size()));
}

/// A base remote frame asking for `dlc` bytes.
constexpr Frame remote_frame(std::uint32_t identifier, std::uint8_t dlc = 0) noexcept {
  return {.identifier = identifier, .remote = true, .dlc = dlc};
}

}  // namespace canopus::can
