#include "canopus/can/frame_bits.hpp"

#include <array>
#include <cstddef>

namespace canopus::can {
namespace {

constexpr unsigned crc_bits = 15;
constexpr unsigned crc_polynomial = 0x4599;
// CRC delimiter, ACK slot, ACK delimiter, EOF: never stuffed.
constexpr unsigned tail_bits = 1 + 1 + 1 + 7;
// SOF, identifier, RTR, IDE, r0, DLC of a base frame; SOF, identifier, SRR, IDE, identifier extension, RTR,
// r1, r0, DLC of an extended one.
constexpr unsigned base_header_bits = 1 + 11 + 1 + 1 + 1 + 4;
constexpr unsigned extended_header_bits = 1 + 11 + 1 + 1 + 18 + 1 + 2 + 4;
constexpr std::size_t max_header_bytes = 5;
constexpr std::size_t max_crc_bytes = max_header_bytes + 8;

// The CRC is linear and starts from 0, so the CRC of a frame is the XOR of what each of its bytes gives
// alone, and zeros in front of it change nothing. crc_table[k][b] is what byte b gives with k bytes after it.
using CrcTable = std::array<std::array<std::uint16_t, 256>, max_crc_bytes>;
constexpr CrcTable crc_table = [] {
  CrcTable table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte << (crc_bits - 8);
    for (std::size_t after = 0; after < max_crc_bytes; ++after) {
      for (unsigned bit = 0; bit < 8; ++bit) {
        crc <<= 1;
        if ((crc & (1U << crc_bits)) != 0) crc ^= (1U << crc_bits) | crc_polynomial;
      }
      table[after][byte] = static_cast<std::uint16_t>(crc);
    }
  }
  return table;
}();

// Bit stuffing as an automaton that eats a byte at a time. It has eight states: the level of the last bit on
// the wire and how many bits of that level there were in a row, 1..4 (a fifth is followed at once by a stuff
// bit of the other level, which is the first of its own row). stuff_table[b] holds for each state s, in its
// byte s, where b leads (eight times the state, so that it is the next shift) and, in the two bits above, how
// many stuff bits b cost: one step is one load, which does not wait for the state, and one shift.
using StuffTable = std::array<std::uint64_t, 256>;
constexpr unsigned stuff_state(unsigned level, unsigned row) { return (level << 2) | (row - 1); }
constexpr StuffTable stuff_table = [] {
  StuffTable table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    for (unsigned state = 0; state < 8; ++state) {
      unsigned level = state >> 2;
      unsigned row = (state & 3U) + 1;
      std::uint64_t stuffed = 0;
      for (unsigned bit = 8; bit-- > 0;) {
        const unsigned next = (byte >> bit) & 1U;
        row = next == level ? row + 1 : 1;
        level = next;
        if (row == 5) {
          ++stuffed;
          level ^= 1U;
          row = 1;
        }
      }
      table[byte] |= (stuffed << 6 | 8U * stuff_state(level, row)) << (8 * state);
    }
  }
  return table;
}();

struct Stuffing {
  std::uint64_t state;
  std::uint64_t sum = 0;  // 64 for each stuff bit

  [[gnu::always_inline]] void eat(std::uint64_t byte) noexcept {
    state = stuff_table[byte] >> (state & 63U);
    sum += state & 0xC0U;
  }
  [[nodiscard]] unsigned bits() const noexcept { return static_cast<unsigned>(sum / 64); }
};

/// SOF first, which is 0.
template <bool extended>
std::uint64_t header_of(const Frame& frame) noexcept {
  const std::uint64_t remote = frame.remote ? 1 : 0;
  const std::uint64_t length_code = frame.dlc & 15U;
  if constexpr (!extended) {
    return (std::uint64_t{frame.identifier} & max_base_identifier) << 7 | remote << 6 | length_code;
  }
  const std::uint64_t base = (frame.identifier >> 18) & max_base_identifier;
  const std::uint64_t extension = frame.identifier & 0x3FFFF;
  return base << 27 | std::uint64_t{3} << 25 | extension << 7 | remote << 6 | length_code;
}

template <bool extended>
unsigned crc_of(std::uint64_t header, const Frame& frame, std::size_t length) noexcept {
  unsigned crc = crc_table[length][header & 0xFF] ^ crc_table[length + 1][(header >> 8) & 0xFF] ^
                 crc_table[length + 2][(header >> 16) & 0xFF];
  if constexpr (extended) {
    crc ^= crc_table[length + 3][(header >> 24) & 0xFF] ^ crc_table[length + 4][header >> 32];
  }
  for (std::size_t byte = 0; byte < length; ++byte) crc ^= crc_table[length - 1 - byte][frame.data[byte]];
  return crc;
}

// Inlined with `length` known where it is 8, the most frequent one.
template <bool extended>
[[gnu::always_inline]] inline unsigned bits_of(const Frame& frame, std::size_t length) noexcept {
  const std::uint64_t header = header_of<extended>(frame);
  const unsigned crc = crc_of<extended>(header, frame, length);

  // Whole bytes need a few bits in front of SOF and one after the CRC that are not on the wire: alternating
  // ones in front, ending recessive as an idle bus is, and the complement of the last CRC bit behind. None of
  // them can make a fifth bit in a row.
  constexpr unsigned header_bits = extended ? extended_header_bits : base_header_bits;
  constexpr unsigned front_bits = (8 - header_bits % 8) % 8;
  constexpr std::uint64_t front = (0x15U & ((1U << front_bits) - 1U)) | 1U;
  const std::uint64_t head = header | front << header_bits;

  Stuffing stuffing{8U * stuff_state(front_bits % 2 == 0 ? 1 : 0, 1)};
  if constexpr (extended) {
    stuffing.eat((head >> 32) & 0xFF);
    stuffing.eat((head >> 24) & 0xFF);
  }
  stuffing.eat((head >> 16) & 0xFF);
  stuffing.eat((head >> 8) & 0xFF);
  stuffing.eat(head & 0xFF);
  for (std::size_t byte = 0; byte < length; ++byte) stuffing.eat(frame.data[byte]);
  stuffing.eat(crc >> 7);
  stuffing.eat((crc << 1 | (~crc & 1U)) & 0xFF);
  return header_bits + static_cast<unsigned>(8 * length) + crc_bits + tail_bits + stuffing.bits();
}

}  // namespace

std::uint16_t frame_crc(const Frame& frame) noexcept {
  const std::size_t length = frame.length();
  const unsigned crc = frame.extended ? crc_of<true>(header_of<true>(frame), frame, length)
                                      : crc_of<false>(header_of<false>(frame), frame, length);
  return static_cast<std::uint16_t>(crc);
}

unsigned frame_bits(const Frame& frame) noexcept {
  const std::size_t length = frame.length();
  if (frame.extended) return bits_of<true>(frame, length);
  return length == 8 ? bits_of<false>(frame, 8) : bits_of<false>(frame, length);
}

}  // namespace canopus::can
