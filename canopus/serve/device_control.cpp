#include "canopus/serve/device_control.hpp"

#include <algorithm>
#include <expected>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canopus/eds/value.hpp"
#include "canopus/plant/device_seat.hpp"
#include "canopus/plant/process_value.hpp"
#include "canopus/text/nearest_word.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::serve {

namespace {

using canopen::Entry;
using Json = nlohmann::ordered_json;
template <typename Value>
using Result = std::expected<Value, std::string>;

/// One request and the plant it is for.
class Request {
 public:
  Request(plant::Plant& plant, const Json& fields) : plant_(plant), fields_(fields) {}

  Result<Json> carry_out();

 private:
  Result<void> check_fields(std::initializer_list<std::string_view> known) const;
  [[nodiscard]] Result<std::string> text(std::string_view key) const;
  [[nodiscard]] Result<std::size_t> device() const;
  Result<Json> list() const;
  Result<Json> get() const;
  Result<Json> set();
  Result<Json> release();

  [[nodiscard]] can::Time now() const { return plant_.timeline().now(); }
  [[nodiscard]] Json shown(const sim::Device& device, const Entry& entry) const;
  [[nodiscard]] static double seconds(can::Time time) {
    return static_cast<double>(time.time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
  }

  plant::Plant& plant_;
  const Json& fields_;
};

Json plate_of(const plant::NodeLabel& label) {
  return {{"bus", label.bus}, {"node", label.node_id}, {"name", label.name}};
}

std::string where(const plant::NodeLabel& label) { return fmt::format("{}:{}", label.bus, label.node_id); }

Result<void> Request::check_fields(std::initializer_list<std::string_view> known) const {
  for (const auto& [key, value] : fields_.items()) {
    if (key == "request" || key == "id") continue;
    if (std::ranges::find(known, key) != known.end()) continue;
    std::vector<std::string_view> expected{"request", "id"};
    expected.insert(expected.end(), known.begin(), known.end());
    return std::unexpected(
        fmt::format("\"{}\" is no field of this request; expected {}", key, text::one_of(expected)));
  }
  return {};
}

Result<std::string> Request::text(std::string_view key) const {
  const auto found = fields_.find(key);
  if (found == fields_.end()) return std::unexpected(fmt::format("{} is missing; expected a string", key));
  if (!found->is_string()) return std::unexpected(fmt::format("{}: expected a string", key));
  return found->get<std::string>();
}

/// By its name, node-ID, or bus and node-ID.
Result<std::size_t> Request::device() const {
  const auto wanted = text("device");
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
  Json object{{"object", plant::shown_object(entry)},
              {"name", device.file().dictionary->name(entry)},
              {"type", eds::name(type)},
              {"value", plant::json_value(type, device.node().dictionary().get<std::uint64_t>(entry))}};
  for (const sim::Forcing::Force& force : device.forced()) {
    if (force.entry.index != entry.index || force.entry.sub != entry.sub) continue;
    object["forced"] = true;
    object["beneath"] = plant::json_value(type, force.beneath);
    if (force.until != can::never) object["until"] = seconds(force.until);
    return object;
  }
  object["forced"] = false;
  return object;
}

Result<Json> Request::list() const {
  if (auto good = check_fields({}); !good) return std::unexpected(good.error());
  Json devices = Json::array();
  for (std::size_t i = 0; i < plant_.device_count(); ++i) {
    plant::DeviceSeat& seat = plant_.device(i);
    Json device = plate_of(seat.status().label);
    device["state"] = seat.status().is_on ? canopen::name(seat.status().state) : "off";
    device["forced"] = Json::array();
    for (const sim::Forcing::Force& force : seat.device().forced()) {
      device["forced"].push_back(shown(seat.device(), force.entry));
    }
    devices.push_back(std::move(device));
  }
  return Json{{"devices", std::move(devices)}};
}

Result<Json> Request::get() const {
  if (auto good = check_fields({"device", "object"}); !good) return std::unexpected(good.error());
  const auto number = device();
  if (!number) return std::unexpected(number.error());
  const sim::Device& device = plant_.device(*number).device();
  Json answer = plate_of(plant_.device(*number).status().label);
  answer["objects"] = Json::array();
  if (fields_.contains("object")) {
    const auto object = text("object");
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
  if (auto good = check_fields({"device", "object", "value", "for"}); !good)
    return std::unexpected(good.error());
  const auto number = device();
  if (!number) return std::unexpected(number.error());
  plant::DeviceSeat& seat = plant_.device(*number);
  const auto object = text("object");
  if (!object) return std::unexpected(object.error());
  const auto entry = plant::find_process_value(seat.device(), *object);
  if (!entry) return std::unexpected(entry.error());
  const auto value = fields_.find("value");
  if (value == fields_.end() || !(value->is_number() || value->is_boolean() || value->is_string())) {
    return std::unexpected("value: expected a number, true or false, or a string that holds one");
  }
  const std::string written = value->is_string() ? value->get<std::string>() : value->dump();
  const auto bits = plant::parse_value(written, *entry, *seat.device().file().dictionary);
  if (!bits) return std::unexpected("value: " + bits.error());
  can::Time until = can::never;
  if (fields_.contains("for")) {
    const auto hold = text("for");
    const auto duration = hold ? text::parse_duration(*hold) : std::unexpected(hold.error());
    if (!duration) return std::unexpected("for: " + duration.error());
    if (*duration == can::Duration::zero()) return std::unexpected("for: expected more than 0");
    until = can::later(now(), *duration);
  }
  seat.device().force(*entry, *bits, until, now());
  plant_.device_touched(*number);
  Json answer = plate_of(seat.status().label);
  answer["objects"] = Json::array({shown(seat.device(), *entry)});
  return answer;
}

Result<Json> Request::release() {
  if (auto good = check_fields({"device", "object"}); !good) return std::unexpected(good.error());
  const auto number = device();
  if (!number) return std::unexpected(number.error());
  plant::DeviceSeat& seat = plant_.device(*number);
  std::vector<Entry> entries;
  if (fields_.contains("object")) {
    const auto object = text("object");
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
      return std::unexpected(fmt::format("{} is not forced", plant::shown_object(entry)));
    }
    answer["objects"].push_back(shown(seat.device(), entry));
  }
  plant_.device_touched(*number);
  return answer;
}

Result<Json> Request::carry_out() {
  const auto wanted = text("request");
  if (!wanted) return std::unexpected(wanted.error());
  if (*wanted == "list") return list();
  if (*wanted == "get") return get();
  if (*wanted == "set") return set();
  if (*wanted == "release") return release();
  static constexpr std::string_view known[] = {"list", "get", "set", "release"};
  return std::unexpected(
      fmt::format("request: \"{}\" is unknown{}", *wanted, text::suggestion(*wanted, known)));
}

}  // namespace

std::string DeviceControl::answer(std::string_view request) {
  Json answer;
  const Json fields = Json::parse(request, nullptr, false);
  if (fields.is_object() && fields.contains("id") && fields["id"].is_primitive()) answer["id"] = fields["id"];
  Result<Json> result =
      std::unexpected(std::string("this is no JSON object; expected a line such as {\"request\": \"list\"}"));
  if (fields.is_object()) result = Request(plant_, fields).carry_out();
  answer["ok"] = result.has_value();
  answer["t"] =
      static_cast<double>(plant_.timeline().now().time_since_epoch() / std::chrono::microseconds(1)) / 1e6;
  if (result) {
    answer.update(*result);
  } else {
    answer["error"] = result.error();
  }
  return text::printable_json(answer.dump(-1, ' ', false, Json::error_handler_t::replace)) + '\n';
}

}  // namespace canopus::serve
