#pragma once
// Small programs with their inputs and expected values, scan by scan.

#include <charconv>
#include <initializer_list>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "compiled.hpp"

namespace programs {

/// `scans`: the scans, with ';' between them, 10 ms apart from 0 on: what happens before the scan, '>', and what holds behind it.
///   before: "in=TRUE" a variable of the program P, ".g=5" a global one, "#X1=1" a device,
///           "@25ms" or "@7us" the time of the scan, "cut" a power cut, "cold" a cold start
///   behind: "t.Q=TRUE" and the like; "!words" a fault whose text ends so, spaces written as '_'
struct Example {
  const char* variables;   ///< of the program P
  const char* statements;  ///< of it
  const char* scans;
  const char* units = "";  ///< what stands before the program
};

inline std::string_view next_part(std::string_view& rest, char end) {
  const std::size_t at = std::min(rest.find(end), rest.size());
  const std::string_view part = rest.substr(0, at);
  rest.remove_prefix(std::min(at + 1, rest.size()));
  return part;
}

inline std::uint16_t& device(compiled::Plc& plc, std::string_view name) {  // "D12", X and Y in octal
  unsigned number = 0;
  std::from_chars(name.data() + 1, name.data() + name.size(), number,
                  name[0] == 'X' || name[0] == 'Y' ? 8 : 10);
  return plc.devices.word(name[0], number);
}

inline std::string path(std::string_view name) {
  return name.starts_with('.') ? std::string(name.substr(1)) : "P." + std::string(name);
}

inline void prepare(compiled::Plc& plc, std::string_view what) {
  if (what == "cut") return plc.machine->warm_start();
  if (what == "cold") return plc.machine->cold_start();
  if (what.starts_with('@')) {
    std::int64_t number = 0;
    const char* const unit = std::from_chars(what.data() + 1, what.data() + what.size(), number).ptr;
    plc.now = number * (*unit == 'u' ? 1'000 : 1'000'000);
    return;
  }
  std::string_view value = what;
  const std::string_view name = next_part(value, '=');
  if (name.starts_with('#'))
    device(plc, name.substr(1)) = static_cast<std::uint16_t>(std::stol(std::string(value), nullptr, 0));
  else
    plc.write(path(name), value);
}

inline void judge(const compiled::Plc& plc, std::string_view what) {
  std::string_view value = what;
  const std::string_view name = next_part(value, '=');
  if (name.starts_with('#'))
    EXPECT_EQ(std::to_string(device(const_cast<compiled::Plc&>(plc), name.substr(1))), value) << what;
  else
    EXPECT_EQ(plc.read(path(name)), value) << what;
}

inline void check(std::initializer_list<Example> examples) {
  for (const Example& example : examples) {
    SCOPED_TRACE(std::string(example.units) + " | " + example.variables + " | " + example.statements + " | " +
                 example.scans);
    compiled::Plc plc(std::string(example.units) + "\nPROGRAM P\nVAR " + example.variables + " END_VAR\n" +
                      example.statements + "\nEND_PROGRAM\n");
    if (!plc.machine) continue;
    std::string_view scans = example.scans;
    for (int number = 1; !scans.empty(); ++number) {
      SCOPED_TRACE("scan " + std::to_string(number));
      std::string_view behind = next_part(scans, ';');
      std::string_view before = behind.contains('>') ? next_part(behind, '>') : std::exchange(behind, {});
      while (!before.empty())
        if (const std::string_view word = next_part(before, ' '); !word.empty()) prepare(plc, word);
      std::string fault = plc.run();
      std::ranges::replace(fault, ' ', '_');
      std::string expected_fault;
      while (!behind.empty()) {
        const std::string_view word = next_part(behind, ' ');
        if (word.starts_with('!'))
          expected_fault = word.substr(1);
        else if (!word.empty())
          judge(plc, word);
      }
      if (expected_fault.empty())
        EXPECT_EQ(fault, "");
      else
        EXPECT_TRUE(fault.ends_with(expected_fault)) << fault;
    }
  }
}

}  // namespace programs
