#pragma once
// A concise DCF of one entry, and its download to 1F22H by the command interface.

#include <algorithm>

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {

inline void expect_abort(IntelligentScenario& s, const Words& command, std::uint32_t code,
                         Where where = Where::current()) {
  s.cif(command, where);
  s.expect(
      1000,
      {0x000F, 0x0003, 0, static_cast<std::uint16_t>(code & 0xFFFF), static_cast<std::uint16_t>(code >> 16)},
      where);
}

// One entry: 1017H:00 = 1000 (2 bytes).
inline const Words one_entry{0x0001, 0x0000, 0x1017, 0x0200, 0x0000, 0xE800, 0x0003};

inline Words download(std::uint16_t sub, std::uint16_t bytes = 13) {
  Words command{0x0002, 0, 0x1F22, sub, bytes};
  command.insert(command.end(), one_entry.begin(), one_entry.end());
  return command;
}

}  // namespace canopus::scenario
