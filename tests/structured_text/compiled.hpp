#pragma once
// A small program, compiled and run scan by scan.

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/program/machine.hpp"
#include "canopus/structured_text/compiler.hpp"

#include "memory_devices.hpp"

namespace compiled {

namespace st = canopus::structured_text;
using canopus::program::Machine;

inline std::string text(const std::vector<st::CompileError>& errors) {
  std::string all;
  for (const st::CompileError& error : errors)
    all += error.file + ':' + std::to_string(error.line) + ':' + std::to_string(error.column) + ": " +
           error.message + '\n';
  return all;
}

/// The errors of a source, one line each: "main.st:2:3: expected ;".
inline std::string errors_of(const std::string& source) {
  memory_devices::MemoryDevices devices;
  const std::vector<st::Source> sources = {{"main.st", source}};
  return text(st::compile(sources, &devices).errors);
}

class Plc {
 public:
  explicit Plc(const std::string& source) {
    const std::vector<st::Source> sources = {{"main.st", source}};
    st::Compilation made = st::compile(sources, &devices);
    EXPECT_EQ(text(made.errors), "") << source;
    if (made.program) machine = std::make_unique<Machine>(std::move(made.program));
  }
  /// `scans` scans, 10 ms each; the fault of one that was not ended, as text.
  std::string run(int scans = 1) {
    for (int i = 0; i < scans; ++i) {
      if (!machine) return "no program";
      const auto fault = machine->scan(now, &devices);
      if (fault) return canopus::program::fault_text(machine->program(), *fault);
      now += 10'000'000;
    }
    return "";
  }
  std::string read(std::string_view path) const {
    if (!machine) return "no program";
    const auto value = machine->read(path);
    return value ? *value : value.error();
  }
  void write(std::string_view path, std::string_view value) {
    if (!machine) return;
    const auto done = machine->write(path, value);
    EXPECT_TRUE(done) << done.error();
  }

  memory_devices::MemoryDevices devices;
  std::unique_ptr<Machine> machine;
  std::int64_t now = 0;  // ns
};

}  // namespace compiled
