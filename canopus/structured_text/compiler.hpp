#pragma once
// Compiles Structured Text [IEC 61131-3, 3rd edition, clause 7.3] into a program of the register machine.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canopus/program/program.hpp"

namespace canopus::structured_text {

struct Source {
  std::string name;  ///< of the file, for errors
  std::string text;
};

/// "main.st:12:5: expected ;"
struct CompileError {
  std::string file;
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  std::string message;
};

struct Compilation {
  std::shared_ptr<program::Program> program{};  ///< none with errors
  std::vector<CompileError> errors{};           ///< of all files, in their order, at most 100
};

/// All files are one program; PROGRAMs are executed in their order. `devices`: those of the CPU that is to run it; none: a program
/// of variables alone.
[[nodiscard]] Compilation compile(std::span<const Source> sources, const program::DeviceNames* devices);

}  // namespace canopus::structured_text
