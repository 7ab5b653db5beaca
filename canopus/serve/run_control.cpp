#include "canopus/serve/run_control.hpp"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/serve/control_message.hpp"
#include "canopus/serve/device_control.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::serve {

namespace {

/// The PLC of a request: by its name, or the only one.
Result<std::size_t> plc_of(plant::Plant& plant, const ControlFields& fields) {
  const std::size_t count = plant.plc_count();
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < count; ++i) names.emplace_back(plant.plc_section(i).name);
  if (!fields.has("plc")) {
    if (count == 1) return 0;
    if (count == 0) return std::unexpected(std::string("the plant has no PLC; expected \"for\""));
    return std::unexpected(fmt::format("plc is missing; expected {}", text::one_of(names)));
  }
  const auto wanted = fields.text("plc");
  if (!wanted) return std::unexpected(wanted.error());
  for (std::size_t i = 0; i < count; ++i) {
    if (names[i] == *wanted) return i;
  }
  return std::unexpected(fmt::format("the plant has no PLC \"{}\"{}", *wanted,
                                     count == 0 ? "" : text::suggestion(*wanted, names)));
}

Result<PlantRuns::Goal> goal_of(plant::Plant& plant, const ControlFields& fields) {
  if (const auto good = fields.check({"plc", "scans", "for", "until"}); !good) {
    return std::unexpected(good.error());
  }
  PlantRuns::Goal goal;
  if (!fields.has("scans") && !fields.has("for") && !fields.has("until")) {
    return std::unexpected(
        std::string("what to wait for is missing; expected \"scans\", \"for\" or \"until\""));
  }
  if (fields.has("plc") || fields.has("scans") || fields.has("until") || plant.plc_count() == 1) {
    const auto plc = plc_of(plant, fields);
    if (!plc) return std::unexpected(plc.error());
    goal.plc = *plc;
  }
  if (const Json* scans = fields.find("scans")) {
    if (!scans->is_number_unsigned())
      return std::unexpected(std::string("scans: expected a number from 0 on"));
    goal.scans = scans->get<std::uint64_t>();
  }
  if (fields.has("for")) {
    const auto duration = fields.duration("for");
    if (!duration) return std::unexpected(duration.error());
    goal.duration = *duration;
  }
  if (fields.has("until")) {
    const auto written = fields.text("until");
    if (!written) return std::unexpected(written.error());
    auto condition = PlcCondition::parse(*written, plant.rack(*goal.plc));
    if (!condition) return std::unexpected("until: " + condition.error());
    goal.until = *condition;
  }
  return goal;
}

Result<Json> result_of(const PlantRuns::Goal& goal, const PlantRuns::Outcome& outcome) {
  if (outcome.plant_ended) {
    return std::unexpected(
        fmt::format("the run of the plant ended first, {} later", ascii::counted(outcome.scans, "scan")));
  }
  Json result = Json::object();
  if (goal.plc) result["scans"] = outcome.scans;
  if (goal.until) result["met"] = outcome.is_met;
  return result;
}

}  // namespace

ControlServer::CallOff RunControl::answer(std::string_view line, ControlServer::Reply reply) {
  Json fields = control_request(line);
  if (!fields.is_object() || fields.value("request", "") != "run") {
    reply(DeviceControl(plant_).answer(line));
    return {};
  }
  auto goal = goal_of(plant_, ControlFields(fields));
  if (!goal) {
    reply(control_answer(fields, std::unexpected(goal.error()), plant_.timeline().now()));
    return {};
  }
  const auto done = [this, fields = std::move(fields), goal = *goal,
                     reply = std::move(reply)](const PlantRuns::Outcome& outcome) {
    reply(control_answer(fields, result_of(goal, outcome), plant_.timeline().now()));
  };
  return [this, number = runs_.start(std::move(*goal), done)] { runs_.cancel(number); };
}

}  // namespace canopus::serve
