#pragma once
// The program of a PLC, made of the files that its section of the plant file names.

#include <memory>
#include <string>
#include <vector>

#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/program/program.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::plant {

struct PlcSection;

struct PlcProgram {
  std::shared_ptr<const program::Program> program{};  ///< none with errors
  std::vector<text::FileError> errors{};              ///< at the files' places in the plant file
  std::vector<plc::ProgramSource> sources{};
  std::vector<plc::DeviceLabel> labels{};
};
/// `plant_file`: the path of the plant file, which the programs' are relative to.
[[nodiscard]] PlcProgram compile_program(const PlcSection& plc, const std::string& plant_file);

}  // namespace canopus::plant
