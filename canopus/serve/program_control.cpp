#include "canopus/serve/program_control.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plc_program.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/program/machine.hpp"
#include "canopus/serve/program_view.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::serve {

namespace {

constexpr std::array<std::string_view, 1> by_name = {"name"};
constexpr std::array<std::string_view, 2> with_value = {"name", "value"};
constexpr std::array<std::string_view, 2> at_line = {"file", "line"};
constexpr std::array<std::string_view, 4> of_lines = {"file", "from", "count", "block"};

constexpr std::array<ProgramRequest, 14> requests = {{
    {"variables", {}, true},
    {"program", of_lines, true},
    {"read variable", by_name, true},
    {"write variable", with_value},
    {"force variable", with_value},
    {"release variable", by_name},
    {"release all", {}},
    {"halt program", {}},
    {"single scan", {}},
    {"continue program", {}},
    {"set break", at_line},
    {"clear break", at_line},
    {"clear breaks", {}},
    {"change program", {}},
}};

/// The PLC of the request: the only one with a program, or the one that is named.
Result<std::size_t> plc_with_program(plant::Plant& plant, const ControlFields& fields) {
  std::optional<std::string> wanted;
  if (fields.has("plc")) {
    const auto text = fields.text("plc");
    if (!text) return std::unexpected(text.error());
    wanted = *text;
  }
  std::vector<std::size_t> found;
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < plant.plc_count(); ++i) {
    if (plant.program(i) == nullptr) continue;
    names.push_back(plant.plc_section(i).name);
    if (!wanted || *wanted == names.back()) found.push_back(i);
  }
  if (found.size() == 1) return found.front();
  if (names.empty())
    return std::unexpected(
        "no PLC of the plant has a program; expected program = [\"main.st\"] in its [[plc]]");
  if (!wanted) return std::unexpected("plc is missing; several PLCs have a program");
  return std::unexpected(
      fmt::format("plc: no PLC \"{}\" has a program{}", *wanted, text::suggestion(*wanted, names)));
}

Result<Json> shown(const program::Machine& machine, const std::string& name) {
  const auto variable = machine.find(name);
  if (!variable) return std::unexpected("name: " + variable.error());
  return Json{{"name", name},
              {"type", variable->type->name},
              {"value", *machine.read(name)},
              {"forced", machine.is_forced(name)}};
}

/// The label of that name which stands for a device, if there is no variable of that name; null: there is none.
const plc::DeviceLabel* label_of(plant::Plant& plant, std::size_t plc, const ControlFields& fields) {
  const auto name = fields.text("name");
  const plc::ProgramExecution& execution = *plant.program(plc);
  return !name || execution.machine().find(*name) ? nullptr : execution.label(*name);
}

/// A value as it is written in a program.
Result<std::string> value_of(const ControlFields& fields) {
  const Json* const value = fields.find("value");
  if (value == nullptr || !(value->is_number() || value->is_boolean() || value->is_string()))
    return std::unexpected("value: expected a number, true or false, or a string such as \"T#1s\"");
  return value->is_string() ? value->get<std::string>() : value->dump();
}

/// "read variable" and "write variable" of a label. It cannot be forced.
Result<Json> label_request(plant::Plant& plant, std::size_t plc, const plc::DeviceLabel& label,
                           const ControlFields& fields, std::string_view request) {
  plc::Rack& rack = plant.rack(plc);
  const can::Time now = plant.timeline().now();
  if (request == "write variable") {
    const auto value = value_of(fields);
    if (!value) return std::unexpected(value.error());
    if (const auto done = plc::write_label(rack, label, *value, now); !done)
      return std::unexpected("value: " + done.error());
  } else if (request != "read variable") {
    return std::unexpected(
        fmt::format("name: \"{}\" stands for {}: a device cannot be forced", label.name, label.device));
  }
  const auto shown = plc::read_label(rack, label, now);
  if (!shown) return std::unexpected("name: " + shown.error());
  return Json{{"name", label.name}, {"type", label.type},     {"value", *shown},
              {"forced", false},    {"device", label.device}, {"comment", label.comment}};
}

Result<Json> variables(const program::Machine& machine) {
  Json list = Json::array();
  for (const program::Symbol& symbol : machine.program().symbols) {
    Json row{{"name", symbol.name},
             {"type", symbol.type->name},
             {"value", machine.read(symbol.name).value_or("")}};
    if (!symbol.comment.empty()) row["comment"] = symbol.comment;
    list.push_back(std::move(row));
  }
  return Json{{"variables", std::move(list)}};
}

Result<Json> write(program::Machine& machine, const ControlFields& fields, bool is_force) {
  const auto name = fields.text("name");
  if (!name) return std::unexpected(name.error());
  const auto written = value_of(fields);
  if (!written) return std::unexpected(written.error());
  if (const auto known = machine.find(*name); !known) return std::unexpected("name: " + known.error());
  const auto done = is_force ? machine.force(*name, *written) : machine.write(*name, *written);
  if (!done) return std::unexpected("value: " + done.error());
  return shown(machine, *name);
}

Result<Json> release(program::Machine& machine, const ControlFields& fields) {
  const auto name = fields.text("name");
  if (!name) return std::unexpected(name.error());
  if (const auto done = machine.release(*name); !done) return std::unexpected(done.error());
  return shown(machine, *name);
}

Result<std::uint32_t> number(const ControlFields& fields, std::string_view key, std::uint32_t least,
                             std::uint32_t most) {
  const Json* const value = fields.find(key);
  if (value != nullptr && value->is_number_unsigned()) {
    const auto given = value->get<std::uint64_t>();
    if (given >= least && given <= most) return static_cast<std::uint32_t>(given);
  }
  return std::unexpected(fmt::format("{}: expected a number from {} to {}", key, least, most));
}

constexpr std::uint32_t last_line = 10'000'000;

Result<Json> change_break(plant::Plant& plant, std::size_t plc, const ControlFields& fields, bool is_set) {
  const auto written = fields.text("file");
  if (!written) return std::unexpected(written.error());
  const auto file = program_file(plant, plc, *written);
  if (!file) return std::unexpected(file.error());
  const auto line = number(fields, "line", 1, last_line);
  if (!line) return std::unexpected(line.error());
  program::Machine& machine = plant.program(plc)->machine();
  if (is_set) {
    constexpr std::size_t most_breaks = 100;  // each one costs a copy of the code
    if (machine.breaks().size() >= most_breaks)
      return std::unexpected(fmt::format("line: expected at most {} breaks; clear some first", most_breaks));
    const auto placed = machine.set_break(*file, *line);
    if (!placed) return std::unexpected("line: " + placed.error());
    return Json{{"file", shown_file(plant, *file)}, {"line", *placed}};
  }
  if (!machine.clear_break(*file, *line))
    return std::unexpected(fmt::format("line: there is no break in line {} of {}", *line, *written));
  return Json{{"breaks", machine.breaks().size()}};
}

/// The status; with `file` its lines, too.
Result<Json> program(plant::Plant& plant, std::size_t plc, const ControlFields& fields) {
  Json result = program_status(plant, plc);
  if (!fields.has("file")) return result;
  const auto written = fields.text("file");
  if (!written) return std::unexpected(written.error());
  const auto file = program_file(plant, plc, *written);
  if (!file) return std::unexpected(file.error());
  const auto from = fields.has("from") ? number(fields, "from", 1, last_line) : Result<std::uint32_t>(1);
  if (!from) return std::unexpected(from.error());
  const auto count = fields.has("count") ? number(fields, "count", 1, most_program_lines)
                                         : Result<std::uint32_t>(most_program_lines);
  if (!count) return std::unexpected(count.error());
  std::string block;
  if (fields.has("block")) {
    const auto text = fields.text("block");
    if (!text) return std::unexpected(text.error());
    block = *text;
  }
  const auto& sources = plant.program(plc)->sources();
  const auto place = std::ranges::find(sources, *file, &plc::ProgramSource::name) - sources.begin();
  const Json lines = program_lines(plant, plc, static_cast<std::size_t>(place), *from, *count, block);
  for (const auto& [key, value] : lines.items()) result[key] = value;
  return result;
}

Result<Json> change(plant::Plant& plant, std::size_t plc) {
  plant::PlcProgram made = plant::compile_program(plant.plc_section(plc), plant.file().path);
  if (made.program == nullptr) return std::unexpected(made.errors.front().message);
  plant.program(plc)->change(std::move(made.program), std::move(made.sources), std::move(made.labels));
  Json result = *variables(plant.program(plc)->machine());
  result["changed"] = true;
  return result;
}

/// In RUN, or it would not go on.
Result<Json> run_mode(plant::Plant& plant, std::size_t plc, std::string_view request) {
  plc::ProgramExecution& execution = *plant.program(plc);
  const std::string_view state = program_state(plant, plc);
  if (state != "run" && state != "halted")
    return std::unexpected(
        fmt::format("the CPU is not in RUN, but {}", state == "off" ? "has no supply" : state));
  if (request == "halt program") execution.halt();
  if (request == "single scan") execution.single_scan();
  if (request == "continue program") execution.resume();
  return Json{{"state", program_state(plant, plc)}};
}

}  // namespace

std::span<const ProgramRequest> program_requests() noexcept { return requests; }

bool is_program_request(std::string_view request) noexcept {
  return std::ranges::find(requests, request, &ProgramRequest::name) != requests.end();
}

Result<Json> program_request(plant::Plant& plant, const ControlFields& fields, std::string_view request) {
  const ProgramRequest& known = *std::ranges::find(requests, request, &ProgramRequest::name);
  std::vector<std::string_view> allowed(known.fields.begin(), known.fields.end());
  allowed.emplace_back("plc");
  if (const auto good = fields.check(allowed); !good) return std::unexpected(good.error());
  const auto plc = plc_with_program(plant, fields);
  if (!plc) return std::unexpected(plc.error());
  program::Machine& machine = plant.program(*plc)->machine();
  if (request.ends_with(" variable"))
    if (const plc::DeviceLabel* const label = label_of(plant, *plc, fields))
      return label_request(plant, *plc, *label, fields, request);
  if (request == "variables") return variables(machine);
  if (request == "program") return program(plant, *plc, fields);
  if (request == "change program") return change(plant, *plc);
  if (request == "write variable") return write(machine, fields, false);
  if (request == "force variable") return write(machine, fields, true);
  if (request == "release variable") return release(machine, fields);
  if (request == "set break") return change_break(plant, *plc, fields, true);
  if (request == "clear break") return change_break(plant, *plc, fields, false);
  if (request == "release all") {
    const std::size_t count = machine.forced();
    machine.release_all();
    return Json{{"released", count}};
  }
  if (request == "clear breaks") {
    machine.clear_breaks();
    return Json{{"breaks", 0}};
  }
  if (request == "read variable") {
    const auto name = fields.text("name");
    if (!name) return std::unexpected(name.error());
    return shown(machine, *name);
  }
  return run_mode(plant, *plc, request);
}

}  // namespace canopus::serve
