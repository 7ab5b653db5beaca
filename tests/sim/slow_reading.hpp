#pragma once
// What a receiver makes of the bits of a frame, read anew from its SOF: for slow_bus.hpp.

#include <algorithm>
#include <cstddef>
#include <string>

#include "can/slow_frame.hpp"

namespace canopus::sim::slow {

/// What the last bit of a frame says to a receiver that has seen the bits from SOF to it.
struct Reading {
  enum class Place { stuffed, crc_delimiter, ack_slot, ack_delimiter, eof, last } place = Place::stuffed;
  bool stuff_error = false;
  bool crc_good = false;
  bool next_is_ack_slot = false;
};

inline Reading read(const std::string& seen) {
  Reading reading;
  std::string payload;
  std::size_t stuffed_bits = 0;  // of `seen`
  std::size_t length = 0;        // of the payload with its CRC, once the DLC is known
  char last = '1';
  int row = 0;
  for (const char bit : seen) {
    if (length != 0 && payload.size() == length && row < 5) break;  // what follows is not stuffed
    ++stuffed_bits;
    if (row == 5 && bit == last) {
      reading.stuff_error = true;
      return reading;
    }
    const bool is_stuff_bit = row == 5;
    row = bit == last ? row + 1 : 1;
    last = bit;
    if (is_stuff_bit) continue;
    payload += bit;
    const bool extended = payload.size() > 13 && payload[13] == '1';
    const std::size_t header = extended ? 39 : 19;
    if (payload.size() != header || (payload.size() == 19 && extended)) continue;
    const int dlc = std::stoi(payload.substr(header - 4), nullptr, 2);
    const bool remote = payload[extended ? 32 : 12] == '1';
    length = header + 8 * static_cast<std::size_t>(remote ? 0 : std::min(dlc, 8)) + 15;
  }
  const bool whole = length != 0 && payload.size() == length && row < 5;
  if (!whole) return reading;
  std::string expected;
  can::slow::append(expected, can::slow::crc(payload.substr(0, length - 15)), 15);
  reading.crc_good = payload.substr(length - 15) == expected;
  const std::size_t tail = seen.size() - stuffed_bits;
  reading.next_is_ack_slot = tail == 1;
  if (tail == 0) return reading;
  reading.place = tail == 1    ? Reading::Place::crc_delimiter
                  : tail == 2  ? Reading::Place::ack_slot
                  : tail == 3  ? Reading::Place::ack_delimiter
                  : tail == 10 ? Reading::Place::last
                               : Reading::Place::eof;
  return reading;
}

}  // namespace canopus::sim::slow
