#pragma once
// Compiles instruction lists of the MELSEC families into programs of the register machine.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canopus/instruction_list/instructions.hpp"
#include "canopus/instruction_list/label.hpp"
#include "canopus/instruction_list/program_csv.hpp"
#include "canopus/program/program.hpp"

namespace canopus::instruction_list {

struct Source {
  std::string
      name;  ///< of the file, for errors; the program is called as the file, without folder and extension
  std::string bytes;  ///< a program CSV of GX Works
};

struct Compilation {
  std::shared_ptr<program::Program> program{};  ///< none with errors
  std::vector<CompileError> errors{};           ///< of all files, in their order, at most 100
};

/// The name of a file's program: "MAIN" of "programs/MAIN.csv".
[[nodiscard]] std::string program_name(const std::string& path);

/// Each file is a program; they are executed in their order, behind those of `before`, whose global variables are labels, too.
/// `devices`: those of the CPU.
[[nodiscard]] Compilation compile(std::span<const Source> sources, Family family,
                                  const program::DeviceNames& devices,
                                  std::shared_ptr<program::Program> before = nullptr,
                                  std::span<const Label> labels = {});

}  // namespace canopus::instruction_list
