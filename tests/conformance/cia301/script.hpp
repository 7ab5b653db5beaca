#pragma once
// A conformance case: a name and a script, one line per step.
//
//   605 40 18 10 01 00 00 00 00 -> 585 43 18 10 01 D0 01 00 00      a frame comes in, these are answered
//   000 02 05 ->                                                     nothing is answered
//   +100ms -> 100: 705 7F                                            time passes, these are sent
//
// Several frames are separated by " | ". Each case begins with node 5 of conversation.hpp, in Pre-operational
// at time 0.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopen/conversation.hpp"

namespace canopus::canopen {

struct Case {
  std::string name;  ///< letters, digits and _
  std::string script;
};

inline void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
inline std::string case_name(const testing::TestParamInfo<Case>& info) { return info.param.name; }

inline void run(Conversation& node, const std::string& script) {
  std::istringstream lines(script);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const auto arrow = line.find("->");
    if (arrow == std::string::npos) continue;
    const auto trimmed = [](std::string part) {
      const auto first = part.find_first_not_of(' ');
      if (first == std::string::npos) return std::string();
      return part.substr(first, part.find_last_not_of(' ') - first + 1);
    };
    const std::string step = trimmed(line.substr(0, arrow));
    const std::string expected = trimmed(line.substr(arrow + 2));
    const std::string said =
        step[0] == '+' ? node.wait(std::chrono::milliseconds(std::stol(step.substr(1)))) : node.receive(step);
    ASSERT_EQ(said, expected) << "line " << number << ": " << line;
  }
}

/// Two hexadecimal digits each.
inline std::string hex(std::uint64_t value, unsigned bytes) {
  std::string text;
  char digits[4];
  for (unsigned i = 0; i < bytes; ++i) {
    std::snprintf(digits, sizeof digits, " %02X", static_cast<unsigned>(value >> (8 * i) & 0xFF));
    text += digits;
  }
  return text;
}

}  // namespace canopus::canopen
