#include "canopus/plant/program_languages.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopus/ascii/words.hpp"
#include "canopus/instruction_list/compiler.hpp"

namespace canopus::plant {

namespace {

bool is_list(const structured_text::Source& source) {
  return source.name.size() > 4 &&
         ascii::equal_ignoring_case(std::string_view(source.name).substr(source.name.size() - 4), ".csv");
}

std::optional<instruction_list::Family> list_family(plc::CpuFamily family) {
  switch (family) {
    case plc::CpuFamily::q: return instruction_list::Family::q;
    case plc::CpuFamily::iqr: return instruction_list::Family::iqr;
    case plc::CpuFamily::fx3: return instruction_list::Family::fx3;
    case plc::CpuFamily::fx5: return instruction_list::Family::fx5;
    case plc::CpuFamily::as300: break;
  }
  return std::nullopt;
}

/// The place of a program's file among the sources.
std::size_t order_of(const program::Program& program, std::uint32_t number,
                     std::span<const structured_text::Source> sources) {
  const program::SourcePosition& begin = program.positions[program.functions[number].entry];
  const auto found = std::ranges::find(sources, program.files[begin.file], &structured_text::Source::name);
  return static_cast<std::size_t>(found - sources.begin());
}

}  // namespace

structured_text::Compilation compile_languages(std::span<const structured_text::Source> sources,
                                               const plc::CpuModel& cpu, const program::DeviceNames& devices,
                                               std::span<const instruction_list::Label> labels) {
  std::vector<structured_text::Source> texts;
  std::vector<instruction_list::Source> lists;
  for (const structured_text::Source& source : sources) {
    if (is_list(source))
      lists.push_back({source.name, source.text});
    else
      texts.push_back(source);
  }
  structured_text::Compilation made;
  if (!texts.empty() || lists.empty()) made = structured_text::compile(texts, &devices);
  if (lists.empty()) return made;
  const auto family = list_family(cpu.family);
  if (!family) {
    made.errors.push_back({lists.front().name, 1, 1,
                           "instruction lists are for CPUs of MELSEC; expected Structured Text for the " +
                               std::string(cpu.name)});
    made.program = nullptr;
    return made;
  }
  instruction_list::Compilation added =
      instruction_list::compile(lists, *family, devices, made.program, labels);
  for (instruction_list::CompileError& error : added.errors)
    made.errors.push_back({std::move(error.file), error.line, 1, std::move(error.message)});
  made.program = made.errors.empty() ? std::move(added.program) : nullptr;
  if (made.program != nullptr)
    std::ranges::stable_sort(made.program->programs, {},
                             [&](std::uint32_t number) { return order_of(*made.program, number, sources); });
  return made;
}

}  // namespace canopus::plant
