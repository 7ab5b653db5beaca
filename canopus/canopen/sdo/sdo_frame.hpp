#pragma once
// The eight bytes of SDO frames [CiA 301 7.2.4.3]: byte 0 is the command specifier, bytes 1-3 index and
// sub-index where the service has them, the rest data. Shared by server and client.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

#include "canopus/can/frame.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/service/frame_of.hpp"

namespace canopus::canopen::sdo {

/// Bits 5-7 of byte 0, client to server.
enum class ClientCommand : std::uint8_t {
  download_segment = 0,
  initiate_download = 1,
  initiate_upload = 2,
  upload_segment = 3,
  abort = 4,
  block_upload = 5,
  block_download = 6,
  network_indication = 7,
};

/// Bits 5-7 of byte 0, server to client.
enum class ServerCommand : std::uint8_t {
  upload_segment = 0,
  download_segment = 1,
  initiate_upload = 2,
  initiate_download = 3,
  abort = 4,
  block_download = 5,
  block_upload = 6,
};

/// Bits 0-1 of byte 0 in a block upload's frames, client to server.
enum class BlockUpload : std::uint8_t { initiate = 0, end = 1, response = 2, start = 3 };

inline constexpr std::uint8_t crc_bit = 0x04;  ///< of the initiate frames of block transfers
inline constexpr std::uint8_t expedited_bit = 0x02;
inline constexpr std::uint8_t size_bit = 0x01;
inline constexpr std::uint8_t toggle_bit = 0x10;
inline constexpr std::uint8_t last_bit = 0x01;
inline constexpr std::uint8_t unused_bits = 0x0E;   ///< of a segment: bytes without data
inline constexpr std::uint8_t last_segment = 0x80;  ///< of a segment in a block transfer
inline constexpr std::size_t segment_size = 7;

/// What all frames to one side of a channel begin with. `key`: identifier, bit 29 = extended.
[[nodiscard]] constexpr FrameHead head(std::uint32_t key) noexcept { return {key, 8}; }

[[nodiscard]] inline can::Frame frame(FrameHead head, unsigned command) noexcept {
  return frame_of(head, command & 0xFFU);
}

/// Index and sub-index as a frame's data word has them, in bits 8-31.
[[nodiscard]] constexpr std::uint32_t multiplexer(std::uint16_t index, std::uint8_t sub) noexcept {
  return std::uint32_t{index} << 8 | std::uint32_t{sub} << 24;
}
inline constexpr std::uint32_t multiplexer_mask = 0xFFFF'FF00;

[[nodiscard]] inline can::Frame frame(FrameHead head, unsigned command, std::uint32_t multiplexer,
                                      std::uint32_t value = 0) noexcept {
  return frame_of(head, (command & 0xFFU) | multiplexer | std::uint64_t{value} << 32);
}

[[nodiscard]] inline can::Frame abort_frame(FrameHead head, std::uint32_t multiplexer,
                                            AbortCode code) noexcept {
  return frame(head, 0x80, multiplexer, static_cast<std::uint32_t>(code));
}

[[nodiscard]] inline std::uint32_t multiplexer(const can::Frame& f) noexcept {
  return static_cast<std::uint32_t>(data_word(f)) & multiplexer_mask;
}
/// The command in bits 5-7, what else is in its byte left out, and the multiplexer.
[[nodiscard]] inline std::uint32_t command_and_multiplexer(const can::Frame& f) noexcept {
  return static_cast<std::uint32_t>(data_word(f)) & (multiplexer_mask | 0xE0U);
}
[[nodiscard]] inline std::uint16_t index(const can::Frame& f) noexcept {
  return can::load_as<std::uint16_t>(&f.data[1]);
}
/// Bytes 4-7 as a number.
[[nodiscard]] inline std::uint32_t value(const can::Frame& f) noexcept {
  return static_cast<std::uint32_t>(data_word(f) >> 32);
}
/// Data bytes of a segment of either direction (command with n in bits 1-3).
[[nodiscard]] inline std::size_t segment_length(const can::Frame& f) noexcept {
  return segment_size - (f.data[0] >> 1 & 7U);
}
/// A segment of a block transfer: `command` is its number and bit 7; of `rest`, the first 7 bytes go out.
[[nodiscard]] inline can::Frame block_segment(FrameHead head, unsigned command,
                                              std::span<const std::uint8_t> rest) noexcept {
  std::uint64_t bytes = 0;
  if (rest.size() > segment_size) {
    std::memcpy(&bytes, rest.data(), 8);  // one byte too many, which the shift drops: one load
  } else {
    std::copy(rest.begin(), rest.end(), reinterpret_cast<std::uint8_t*>(&bytes));
  }
  return frame_of(head, bytes << 8 | (command & 0xFFU));
}
/// Data bytes of an expedited transfer: 4 - n when the size is indicated, else all 4.
[[nodiscard]] inline std::span<const std::uint8_t> expedited_data(const can::Frame& f) noexcept {
  const std::size_t unused = (f.data[0] & size_bit) != 0 ? f.data[0] >> 2 & 3U : 0U;
  return {&f.data[4], 4 - unused};
}
/// A segment of either direction: `toggle` is its toggle bit; of `rest`, up to 7 bytes go out. `last`: the
/// last bit is set.
[[nodiscard]] inline can::Frame segment(FrameHead head, unsigned toggle, std::span<const std::uint8_t> rest,
                                        bool last) noexcept {
  const std::size_t unused = rest.size() < segment_size ? segment_size - rest.size() : 0;
  return block_segment(head, toggle | static_cast<unsigned>(unused) << 1 | (last ? last_bit : 0U), rest);
}

}  // namespace canopus::canopen::sdo
