#pragma once
// A concise DCF of one entry, and its way into 1F22H of the module.

#include <algorithm>
#include <deque>

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {

/// One entry: 1017:00, 2 bytes.
inline Bytes write_of_1017(std::uint16_t value) {
  return {1,
          0,
          0,
          0,
          0x17,
          0x10,
          0,
          2,
          0,
          0,
          0,
          static_cast<std::uint8_t>(value & 0xFF),
          static_cast<std::uint8_t>(value >> 8)};
}
inline const Bytes one_entry = write_of_1017(1000);

/// Another node writes this object of the module. The abort code; 0: taken.
inline std::uint32_t write_by_bus(IntelligentScenario& s, std::uint16_t index, std::uint8_t sub,
                                  const Bytes& value) {
  const std::uint32_t own = s.plug_in().node().node_id();
  std::uint32_t abort = 0;
  const auto request = [&](Bytes frame) {
    frame.resize(8);
    s.rx(0x600 + own, frame);
    std::deque<can::Frame>& sent = s.controller().sent;
    if (sent.empty() || sent.back().identifier != 0x580 + own) {
      ADD_FAILURE() << "no answer to an SDO";
      abort = 0xFFFFFFFF;
      return;
    }
    const auto& data = sent.back().data;
    if (data[0] == 0x80) abort = data[4] | data[5] << 8U | data[6] << 16U | std::uint32_t{data[7]} << 24U;
    sent.pop_back();
  };
  const auto low = static_cast<std::uint8_t>(index), high = static_cast<std::uint8_t>(index >> 8);
  const auto size = static_cast<std::uint8_t>(value.size());
  if (value.size() <= 4) {
    Bytes frame{static_cast<std::uint8_t>(0x23 | (4 - size) << 2), low, high, sub};
    frame.insert(frame.end(), value.begin(), value.end());
    request(frame);
    return abort;
  }
  request({0x21, low, high, sub, size});
  for (std::size_t at = 0, toggle = 0; at < value.size() && abort == 0; at += 7, toggle ^= 0x10) {
    const std::size_t bytes = std::min<std::size_t>(7, value.size() - at);
    const bool is_last = at + bytes == value.size();
    Bytes frame{static_cast<std::uint8_t>(toggle | (7 - bytes) << 1 | (is_last ? 1U : 0U))};
    frame.insert(frame.end(), value.begin() + static_cast<std::ptrdiff_t>(at),
                 value.begin() + static_cast<std::ptrdiff_t>(at + bytes));
    request(frame);
  }
  return abort;
}

/// Writes 1F22H:sub, of up to 124 bytes: by the command interface, or where that cannot do it by another node
/// [RJ71CN91 App. 5 note 2]. The abort code; 0: taken.
inline std::uint32_t write_concise_dcf(IntelligentScenario& s, std::uint16_t sub,
                                       const Bytes& file = one_entry) {
  if (s.is_rj71cn91()) return write_by_bus(s, 0x1F22, static_cast<std::uint8_t>(sub), file);
  Words command{0x0002, 0, 0x1F22, sub, static_cast<std::uint16_t>(file.size())};
  command.resize(5 + (file.size() + 1) / 2);
  for (std::size_t i = 0; i < file.size(); ++i)
    command[5 + i / 2] = static_cast<std::uint16_t>(command[5 + i / 2] | file[i] << (i % 2 * 8));
  s.cif(command);
  if (s.read(1000) == 0x0003) return 0;
  return s.read(1003) | std::uint32_t{s.read(1004)} << 16U;
}

}  // namespace canopus::scenario
