#include "canopus/instruction_list/compiler.hpp"

#include <algorithm>
#include <utility>

#include "canopus/instruction_list/list_compiler.hpp"

namespace canopus::instruction_list {

namespace {

constexpr std::size_t most_bytes = 16'000'000;  // of all files
constexpr std::size_t most_sources = 1000;

}  // namespace

std::string program_name(const std::string& path) {
  const std::size_t slash = path.find_last_of("/\\");
  std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  if (const std::size_t point = name.find_last_of('.'); point != std::string::npos && point > 0)
    name.resize(point);
  return name;
}

Compilation compile(std::span<const Source> sources, Family family, const program::DeviceNames& devices,
                    std::shared_ptr<program::Program> before, std::span<const Label> labels) {
  Compilation result;
  std::shared_ptr<program::Program> made = std::move(before);
  if (!made) {
    made = std::make_shared<program::Program>();
    made->code.push_back({});  // where a program that called nothing ends
    made->positions.push_back({});
  }
  Shared shared{*made, devices, family, result.errors, labels};
  std::size_t bytes = 0;
  for (const Source& source : sources) {
    bytes += source.bytes.size();
    if (bytes > most_bytes || made->files.size() >= most_sources) {
      result.errors.push_back({source.name, 1,
                               "expected at most " + std::to_string(most_sources) + " files with " +
                                   std::to_string(most_bytes) + " bytes in all"});
      break;
    }
    const auto file = static_cast<std::uint16_t>(made->files.size());
    made->files.push_back(source.name);
    const std::size_t errors = result.errors.size();
    const ProgramText text = read_program_csv(source.name, source.bytes, result.errors);
    if (result.errors.size() == errors) ListCompiler(shared, file).compile(text, program_name(source.name));
    if (result.errors.size() >= most_errors) break;
  }
  if (result.errors.empty()) shared.interrupts.finish();
  if (result.errors.size() > most_errors) result.errors.resize(most_errors);
  if (result.errors.empty()) result.program = std::move(made);
  return result;
}

}  // namespace canopus::instruction_list
