#include "canopus/serve/device_control.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/serve/control_message.hpp"
#include "canopus/serve/program_control.hpp"
#include "canopus/text/nearest_word.hpp"

namespace canopus::serve {

namespace {

using canopen::Entry;

/// One request and the plant it is for.
class Request {
 public:
  Request(plant::Plant& plant, const Json& fields) : plant_(plant), fields_(fields) {}

  Result<Json> carry_out();

 private:
  [[nodiscard]] Result<std::size_t> device() const;
  Result<Json> list() const;
  Result<Json> get() const;
  Result<Json> set();
  Result<Json> release();
  Result<Json> modules() const;

  [[nodiscard]] can::Time now() const { return plant_.timeline().now(); }
  [[nodiscard]] Json shown(const sim::Device& device, const Entry& entry) const;

  plant::Plant& plant_;
  ControlFields fields_;
};

Json plate_of(const plant::NodeLabel& label) {
  return {{"bus", label.bus}, {"node", label.node_id}, {"name", label.name}};
}

/// A module's status as in the engineering tool's module diagnostics.
Json module_json(const plant::ModuleStatus& status, const std::vector<module::ModuleErrorRecord>& errors) {
  const module::ModuleInformation& information = status.information;
  Json leds = Json::array();
  for (const module::Led& led : status.leds) {
    leds.push_back({{"name", led.name}, {"pattern", module::name(led.pattern)}});
  }
  Json shown_errors = Json::array();
  for (const module::ModuleErrorRecord& error : errors) {
    Json details = Json::object();
    for (const auto& [name, value] : error.details) {
      if (!name.empty()) details[std::string(name)] = value;
    }
    shown_errors.push_back({{"code", fmt::format("{:04X}", error.code)},
                            {"class", module::name(error.error_class)},
                            {"overview", error.overview},
                            {"details", std::move(details)}});
  }
  return {{"module", status.label.name},
          {"plc", status.plc},
          {"bus", status.label.bus},
          {"on", status.is_on},
          {"leds", std::move(leds)},
          {"function_mode", status.is_on ? Json(information.function_mode) : Json()},
          {"function_mode_name", information.function_mode_name},
          {"bit_rate", information.bit_rate ? Json(*information.bit_rate) : Json()},
          {"node", information.node_id ? Json(*information.node_id) : Json()},
          {"errors", std::move(shown_errors)}};
}

/// In words, of a module that is on.
Json history_of(plant::Plant& plant, std::size_t number) {
  const plant::CatalogueEntry* const entry = plant::find_module(plant.module_section(number).model);
  if (entry == nullptr) return Json::array();
  return error_groups(plant::error_history(*entry, plant.module(number), plant.timeline().now()));
}

std::string where(const plant::NodeLabel& label) { return fmt::format("{}:{}", label.bus, label.node_id); }

/// By its name, node-ID, or bus and node-ID.
Result<std::size_t> Request::device() const {
  const auto wanted = fields_.text("device");
  if (!wanted) return std::unexpected(wanted.error());
  std::vector<std::size_t> found;
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < plant_.device_count(); ++i) {
    const plant::NodeLabel& label = plant_.device(i).status().label;
    names.push_back(label.name);
    if (label.name == *wanted) found.push_back(i);
  }
  for (std::size_t i = 0; found.empty() && i < plant_.device_count(); ++i) {
    if (where(plant_.device(i).status().label) == *wanted) found.push_back(i);
  }
  for (std::size_t i = 0, before = found.size(); before == 0 && i < plant_.device_count(); ++i) {
    if (std::to_string(plant_.device(i).status().label.node_id) == *wanted) found.push_back(i);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    std::vector<std::string> places;
    for (const std::size_t i : found) places.push_back(where(plant_.device(i).status().label));
    return std::unexpected(fmt::format("there is more than one device \"{}\"; expected one of {}", *wanted,
                                       fmt::join(places, ", ")));
  }
  for (const plant::NodeStatus& node : plant_.nodes()) {
    if (!node.is_module || (node.label.name != *wanted && where(node.label) != *wanted)) continue;
    return std::unexpected(fmt::format(
        "\"{}\" is a module: its values are words of its buffer memory (canopus plc write)", *wanted));
  }
  return std::unexpected(fmt::format("the plant has no device \"{}\"{}", *wanted,
                                     names.empty() ? "" : text::suggestion(*wanted, names)));
}

Json Request::shown(const sim::Device& device, const Entry& entry) const {
  const canopen::DataType type = entry.description->type;
  Json object{{"object", canopen::object_text(entry.index, entry.sub)},
              {"name", device.file().dictionary->name(entry)},
              {"type", eds::name(type)},
              {"value", plant::json_value(type, device.node().dictionary().get<std::uint64_t>(entry))}};
  for (const sim::Forcing::Force& force : device.forced()) {
    if (force.entry.index != entry.index || force.entry.sub != entry.sub) continue;
    object["forced"] = true;
    object["beneath"] = plant::json_value(type, force.beneath);
    if (force.until != can::never) object["until"] = plant_seconds(force.until);
    return object;
  }
  object["forced"] = false;
  return object;
}

Result<Json> Request::list() const {
  if (auto good = fields_.check({}); !good) return std::unexpected(good.error());
  Json devices = Json::array();
  for (std::size_t i = 0; i < plant_.device_count(); ++i) {
    plant::DeviceOnBus& seat = plant_.device(i);
    Json device = plate_of(seat.status().label);
    device["state"] = seat.status().is_on ? canopen::name(seat.status().state) : "off";
    device["forced"] = Json::array();
    for (const sim::Forcing::Force& force : seat.device().forced()) {
      device["forced"].push_back(shown(seat.device(), force.entry));
    }
    devices.push_back(std::move(device));
  }
  Json plcs = Json::array();
  for (std::size_t i = 0; i < plant_.plc_count(); ++i) {
    const plc::Rack& rack = plant_.rack(i);
    const bool run = rack.cpu_state() == module::CpuState::run;
    plcs.push_back({{"name", plant_.plc_section(i).name},
                    {"cpu", rack.model().name},
                    {"family", plc::family_info(rack.model().family).name},
                    {"state", rack.is_paused() ? "pause"
                              : run            ? "run"
                                               : "stop"},
                    {"scan", std::chrono::duration<double>(rack.scan().period()).count()},
                    {"scans", rack.scan().count(now())}});
  }
  return Json{{"devices", std::move(devices)}, {"plcs", std::move(plcs)}};
}

Result<Json> Request::get() const {
  if (auto good = fields_.check({"device", "object"}); !good) return std::unexpected(good.error());
  const auto number = device();
  if (!number) return std::unexpected(number.error());
  const sim::Device& device = plant_.device(*number).device();
  Json answer = plate_of(plant_.device(*number).status().label);
  answer["objects"] = Json::array();
  if (fields_.has("object")) {
    const auto object = fields_.text("object");
    if (!object) return std::unexpected(object.error());
    const auto entry = plant::find_process_value(device, *object);
    if (!entry) return std::unexpected(entry.error());
    answer["objects"].push_back(shown(device, *entry));
    return answer;
  }
  for (const Entry& entry : plant::process_values(device)) answer["objects"].push_back(shown(device, entry));
  return answer;
}

Result<Json> Request::set() {
  if (auto good = fields_.check({"device", "object", "value", "for"}); !good)
    return std::unexpected(good.error());
  const auto number = device();
  if (!number) return std::unexpected(number.error());
  plant::DeviceOnBus& seat = plant_.device(*number);
  const auto object = fields_.text("object");
  if (!object) return std::unexpected(object.error());
  const auto entry = plant::find_process_value(seat.device(), *object);
  if (!entry) return std::unexpected(entry.error());
  const Json* value = fields_.find("value");
  if (value == nullptr || !(value->is_number() || value->is_boolean() || value->is_string())) {
    return std::unexpected("value: expected a number, true or false, or a string that holds one");
  }
  const std::string written = value->is_string() ? value->get<std::string>() : value->dump();
  const auto bits = plant::parse_value(written, *entry, *seat.device().file().dictionary);
  if (!bits) return std::unexpected("value: " + bits.error());
  can::Time until = can::never;
  if (fields_.has("for")) {
    const auto duration = fields_.duration("for");
    if (!duration) return std::unexpected(duration.error());
    until = can::later(now(), *duration);
  }
  seat.device().force(*entry, *bits, until, now());
  Json answer = plate_of(seat.status().label);
  answer["objects"] = Json::array({shown(seat.device(), *entry)});
  return answer;
}

Result<Json> Request::release() {
  if (auto good = fields_.check({"device", "object"}); !good) return std::unexpected(good.error());
  const auto number = device();
  if (!number) return std::unexpected(number.error());
  plant::DeviceOnBus& seat = plant_.device(*number);
  std::vector<Entry> entries;
  if (fields_.has("object")) {
    const auto object = fields_.text("object");
    if (!object) return std::unexpected(object.error());
    const auto entry = plant::find_process_value(seat.device(), *object);
    if (!entry) return std::unexpected(entry.error());
    entries.push_back(*entry);
  } else {
    for (const sim::Forcing::Force& force : seat.device().forced()) entries.push_back(force.entry);
  }
  Json answer = plate_of(seat.status().label);
  answer["objects"] = Json::array();
  for (const Entry& entry : entries) {
    if (!seat.device().release(entry, now())) {
      return std::unexpected(fmt::format("{} is not forced", canopen::object_text(entry.index, entry.sub)));
    }
    answer["objects"].push_back(shown(seat.device(), entry));
  }
  return answer;
}

Result<Json> Request::modules() const {
  if (auto good = fields_.check({"module"}); !good) return std::unexpected(good.error());
  std::string wanted;
  if (fields_.has("module")) {
    const auto text = fields_.text("module");
    if (!text) return std::unexpected(text.error());
    wanted = *text;
  }
  Json list = Json::array();
  std::vector<std::string_view> names;
  const std::vector<plant::ModuleStatus> all = plant_.modules();
  for (std::size_t i = 0; i < all.size(); ++i) {
    names.push_back(all[i].label.name);
    if (fields_.has("module") && wanted != all[i].label.name) continue;
    list.push_back(module_json(all[i], plant_.module_errors(i)));
    list.back()["history"] = all[i].is_on ? history_of(plant_, i) : Json::array();
  }
  if (list.empty() && fields_.has("module")) {
    return std::unexpected(fmt::format("the plant has no module \"{}\"{}", wanted,
                                       names.empty() ? "" : text::suggestion(wanted, names)));
  }
  return Json{{"modules", std::move(list)}};
}

Result<Json> Request::carry_out() {
  const auto wanted = fields_.text("request");
  if (!wanted) return std::unexpected(wanted.error());
  if (*wanted == "list") return list();
  if (*wanted == "get") return get();
  if (*wanted == "set") return set();
  if (*wanted == "release") return release();
  if (*wanted == "modules") return modules();
  if (is_program_request(*wanted)) return program_request(plant_, fields_, *wanted);
  static constexpr std::string_view known[] = {"list",    "get", "set",      "release",
                                               "modules", "run", "variables"};
  return std::unexpected(
      fmt::format("request: \"{}\" is unknown{}", *wanted, text::suggestion(*wanted, known)));
}

}  // namespace

text::Json error_groups(const std::vector<plant::ErrorGroup>& groups) {
  text::Json list = text::Json::array();
  for (const plant::ErrorGroup& group : groups) {
    text::Json lines = text::Json::array();
    for (const plant::ErrorLine& line : group.lines) {
      lines.push_back({{"where", line.where}, {"code", line.code}, {"meaning", line.meaning}});
      if (line.at) lines.back()["t"] = can::seconds(*line.at);
    }
    list.push_back({{"title", group.title}, {"lines", std::move(lines)}});
  }
  return list;
}

std::string DeviceControl::answer(std::string_view request) {
  const Json fields = control_request(request);
  Result<Json> result =
      std::unexpected(std::string("this is no JSON object; expected a line such as {\"request\": \"list\"}"));
  if (fields.is_object()) result = Request(plant_, fields).carry_out();
  return control_answer(fields, result, plant_.timeline().now());
}

}  // namespace canopus::serve
