#include "canopus/serve/program_view.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/module/interface/module.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plc/execution/device_label.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/plc/execution/program_text.hpp"
#include "canopus/program/variables.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::serve {

namespace {

double seconds(can::Duration time) { return std::chrono::duration<double>(time).count(); }

/// A file of the program's, by its number.
std::size_t file_number(const plc::ProgramExecution& execution, std::string_view file) {
  const auto& sources = execution.sources();
  return static_cast<std::size_t>(std::ranges::find(sources, file, &plc::ProgramSource::name) -
                                  sources.begin());
}

Json place_of(const plc::ProgramExecution& execution, const program::SourcePosition& position) {
  return {{"file", file_number(execution, execution.machine().program().files[position.file])},
          {"line", position.line}};
}

/// SD0 of an iQ-R and FX5 is hexadecimal in their manuals.
std::string code_text(plc::CpuFamily family, std::uint16_t code) {
  const bool is_hexadecimal = family == plc::CpuFamily::iqr || family == plc::CpuFamily::fx5;
  return is_hexadecimal ? fmt::format("{:04X}H", code) : fmt::format("{}", code);
}

Json error_of(const plant::Plant& plant, plc::CpuFamily family, const plc::ProgramExecution& execution) {
  const plc::ProgramExecution::Error& error = *execution.error();
  Json json = place_of(execution, error.position);
  json["column"] = error.position.column;
  json["code"] = error.code;
  json["code_text"] = code_text(family, error.code);
  json["text"] = shown_file(plant, error.text);
  json["t"] = can::seconds(error.time);
  return json;
}

Json task_of(const plc::ProgramTasks::Row& row) {
  Json task{{"name", row.task.name},
            {"kind", name(row.task.kind)},
            {"priority", row.task.priority},
            {"programs", row.task.programs},
            {"runs", row.runs}};
  if (row.task.kind == plc::TaskKind::fixed_scan) task["every"] = seconds(row.task.every);
  if (row.task.kind == plc::TaskKind::event) task["on"] = row.task.on;
  return task;
}

/// A device's value, without an access of the program: of a module's buffer memory what it holds.
std::string device_value(plc::Rack& rack, const program::DevicePoint& point, can::Time now) {
  if (point.is_buffer) {
    module::Module* const module = rack.module_at(static_cast<std::uint16_t>(16U * point.unit));
    module::BufferMemoryAccess* const buffer = module == nullptr ? nullptr : module->buffer_memory();
    if (buffer == nullptr || point.number >= buffer->buffer_memory_size()) return "?";
    return fmt::format("{}", buffer->peek(point.number, now));
  }
  const auto device = static_cast<plc::Device>(point.device);
  if (point.is_bit) {
    std::uint8_t bit = 0;
    if (!rack.read_bits(device, point.number, {&bit, 1}, now)) return "?";
    return bit != 0 ? "TRUE" : "FALSE";
  }
  std::uint16_t word = 0;
  if (!rack.read_words(device, point.number, {&word, 1}, now)) return "?";
  return fmt::format("{}", word);
}

Json value_of(plant::Plant& plant, std::size_t plc, const plc::NamedValue& named) {
  Json value{{"column", named.column}, {"length", named.length}, {"name", named.name}};
  if (named.is_device) {
    plc::Rack& rack = plant.rack(plc);
    const auto point = plc::CpuDeviceNames(rack.model()).point(named.name);
    value["type"] = point && point->is_bit ? "BOOL" : "WORD";
    value["value"] = point ? device_value(rack, *point, plant.timeline().now()) : "?";
    value["device"] = true;
    value["forced"] = false;
    value["writable"] = false;
    return value;
  }
  const program::Machine& machine = plant.program(plc)->machine();
  const auto variable = machine.find(named.name);
  value["type"] = variable ? variable->type->name : "";
  value["value"] = machine.read(named.name).value_or("?");
  value["forced"] = machine.is_forced(named.name);
  value["writable"] = variable && !variable->is_constant;
  return value;
}

}  // namespace

std::string shown_file(const plant::Plant& plant, std::string_view file) {
  const std::filesystem::path folder = std::filesystem::path(plant.file().path).parent_path();
  const std::string start = folder.empty() ? "" : folder.lexically_normal().string() + '/';
  return std::string(!start.empty() && file.starts_with(start) ? file.substr(start.size()) : file);
}

Result<std::string> program_file(plant::Plant& plant, std::size_t plc, std::string_view shown) {
  std::vector<std::string> names;
  for (const plc::ProgramSource& source : plant.program(plc)->sources()) {
    names.push_back(shown_file(plant, source.name));
    if (names.back() == shown || source.name == shown) return source.name;
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  return std::unexpected(
      fmt::format("file: the program has no file \"{}\"{}", shown, text::suggestion(shown, known)));
}

std::string_view program_state(plant::Plant& plant, std::size_t plc) {
  const plc::Rack& rack = plant.rack(plc);
  const plc::ProgramExecution& execution = *plant.program(plc);
  if (!rack.is_on()) return "off";
  if (execution.error()) return "error";
  if (rack.cpu_state() == module::CpuState::stop) return "stop";
  if (rack.is_paused()) return "pause";
  return execution.is_halted() ? "halted" : "run";
}

Json program_status(plant::Plant& plant, std::size_t plc) {
  const plc::ProgramExecution& execution = *plant.program(plc);
  const program::Machine& machine = execution.machine();
  const plc::Rack& rack = plant.rack(plc);
  Json status{
      {"plc", plant.plc_section(plc).name}, {"cpu", rack.model().name}, {"state", program_state(plant, plc)}};
  if (machine.is_halted()) status["halted_at"] = place_of(execution, machine.halted_at());
  if (execution.error()) status["error"] = error_of(plant, rack.model().family, execution);
  const plc::ScanTimes& times = execution.scan_times();
  status["scan"] = {{"count", rack.scan().count(plant.timeline().now())},
                    {"period", seconds(rack.scan().period())},
                    {"now", seconds(times.now)},
                    {"least", seconds(times.least)},
                    {"most", seconds(times.most)}};
  status["breaks"] = Json::array();
  for (const program::Machine::Break& one : machine.breaks())
    status["breaks"].push_back(place_of(execution, {.file = one.file, .line = one.line}));
  status["forced"] = Json::array();
  for (const std::string& name : machine.forced_names()) {
    const auto variable = machine.find(name);
    status["forced"].push_back({{"name", name},
                                {"type", variable ? variable->type->name : ""},
                                {"value", machine.read(name).value_or("?")}});
  }
  status["tasks"] = Json::array();
  for (const plc::ProgramTasks::Row& row : execution.tasks().rows()) status["tasks"].push_back(task_of(row));
  status["files"] = Json::array();
  for (const plc::ProgramSource& source : execution.sources())
    status["files"].push_back(shown_file(plant, source.name));
  return status;
}

Json program_lines(plant::Plant& plant, std::size_t plc, std::size_t file, std::uint32_t from,
                   std::uint32_t count, std::string_view block) {
  from = std::max<std::uint32_t>(from, 1);
  const plc::SourceView view = plc::source_view(*plant.program(plc), plant.rack(plc).model(), file, from,
                                                std::min(count, most_program_lines), block);
  Json lines{{"file", file}, {"from", from}, {"of", view.lines}, {"blocks", view.blocks}};
  if (!view.block.empty()) lines["block"] = view.block;
  lines["lines"] = Json::array();
  for (const plc::SourceLine& line : view.shown) {
    Json values = Json::array();
    for (const plc::NamedValue& value : line.values) values.push_back(value_of(plant, plc, value));
    lines["lines"].push_back({{"text", line.text}, {"code", line.has_code}, {"values", std::move(values)}});
  }
  return lines;
}

Json program_variables(plant::Plant& plant, std::size_t plc, std::string_view find, std::size_t from,
                       std::size_t count) {
  const program::Machine& machine = plant.program(plc)->machine();
  count = std::min(count, most_variables);
  Json list{{"from", from}, {"rows", Json::array()}};
  std::size_t matching = 0;
  program::for_each_variable(machine.program(), [&](const program::SingleVariable& variable) {
    const bool is_wanted = find.empty() || ascii::contains_ignoring_case(variable.name, find) ||
                           ascii::contains_ignoring_case(variable.type.name, find) ||
                           ascii::contains_ignoring_case(variable.comment, find);
    if (!is_wanted) return true;
    const std::size_t place = matching++;
    if (place < from || place - from >= count) return true;
    list["rows"].push_back({{"name", variable.name},
                            {"type", variable.type.name},
                            {"value", program::value_text(variable.type, machine.value_at(variable.place))},
                            {"forced", machine.is_forced(variable.name)},
                            {"writable", !variable.is_constant},
                            {"retain", variable.is_retained},
                            {"comment", variable.comment}});
    return true;
  });
  // Labels of devices are no variables of the machine, but have names, values and comments as these.
  for (const plc::DeviceLabel& label : plant.program(plc)->labels()) {
    const bool is_wanted = find.empty() || ascii::contains_ignoring_case(label.name, find) ||
                           ascii::contains_ignoring_case(label.type, find) ||
                           ascii::contains_ignoring_case(label.comment, find);
    if (!is_wanted) continue;
    const std::size_t place = matching++;
    if (place < from || place - from >= count) continue;
    list["rows"].push_back(
        {{"name", label.name},
         {"type", label.type},
         {"value", plc::read_label(plant.rack(plc), label, plant.timeline().now()).value_or("?")},
         {"forced", false},
         {"writable", true},
         {"retain", false},
         {"comment", label.comment}});
  }
  list["of"] = matching;
  return list;
}

}  // namespace canopus::serve
