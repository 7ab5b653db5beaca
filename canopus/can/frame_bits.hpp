#pragma once
// How long a frame is on the wire, in bits, stuff bits counted [ISO 11898-1 10].

#include <cstdint>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::can {

/// Bits from SOF to the end of EOF, stuff bits included, intermission (3 bits) excluded.
[[nodiscard]] unsigned frame_bits(const Frame& frame) noexcept;

/// Recessive bits between two frames.
inline constexpr unsigned intermission_bits = 3;

/// CRC sequence (15 bits, polynomial 4599H) of the frame as sent.
[[nodiscard]] std::uint16_t frame_crc(const Frame& frame) noexcept;

/// Time of `bits` bits at `bit_rate` bit/s: exact for every CiA bit rate.
[[nodiscard]] constexpr Duration bit_time(std::uint64_t bits, std::uint32_t bit_rate) noexcept {
  return Duration(static_cast<std::int64_t>(bits * 1'000'000'000ULL / bit_rate));
}

}  // namespace canopus::can
