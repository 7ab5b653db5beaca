#include "canopus/cli/network_project/bus_session.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {
namespace {

using master::ComparedValue;
using master::WriteStep;
using network_project::NetworkProject;
using network_project::ProjectNode;
using Json = text::Json;

std::string_view state_name(ComparedValue::State state) {
  switch (state) {
    case ComparedValue::State::same: return "same";
    case ComparedValue::State::different: return "different";
    case ComparedValue::State::refused: return "refused";
    case ComparedValue::State::not_answered: return "no answer";
  }
  return "";
}

std::string_view state_name(WriteStep::State state) {
  switch (state) {
    case WriteStep::State::not_tried: return "not tried";
    case WriteStep::State::written: return "written";
    case WriteStep::State::refused: return "refused";
    case WriteStep::State::not_answered: return "no answer";
  }
  return "";
}

std::string words(std::span<const std::uint8_t> bytes, canopen::DataType type) {
  const auto value = client::show_value(bytes, type);
  return value ? *value : client::show_bytes(bytes);
}

std::string found_text(const ComparedValue& value) {
  const auto text = master::value_text(value.object, value.type, value.found);
  return text ? *text : words(value.found, value.type);
}

bool has(const std::vector<WriteStep>& steps, WriteStep::State state) {
  return std::ranges::find(steps, state, &WriteStep::state) != steps.end();
}

/// 1000H alone is read: it only tests whether the node answers.
bool is_asked_alone(const ComparedValue& value) {
  return std::ranges::all_of(value.wanted, [](std::uint8_t byte) { return byte == 0; });
}

std::string object_text(text::ObjectName object) { return canopen::object_text(object.index, object.sub); }

std::string title_of(const ProjectNode& node, text::ObjectName object) {
  const canopen::Entry entry = node.device->dictionary->find(object.index, object.sub);
  return entry ? network_project::object_title(*node.device, entry) : "";
}

}  // namespace

BusSession::BusSession(const ProjectArguments& arguments, BusLoop& bus, can::Duration time_out)
    : arguments_(arguments), bus_(bus), time_out_(time_out) {
  bus_.need({link::IdentifierFilter::function(canopen::cob_id::sdo_response)});
}

void BusSession::compare(const ProjectNode& node) {
  BusObjects objects(bus_, node.id(), time_out_);
  const auto values = compared(node, objects);
  if (values) print_summary(node, *values, "is as the project has it");
}

void BusSession::write(const ProjectNode& node) {
  BusObjects objects(bus_, node.id(), time_out_);
  const auto values = compared(node, objects);
  if (!values) return;
  auto steps = master::plan_writes(*node.device, node.id(), *values);
  if (steps.empty()) {
    print_summary(node, *values, "is as the project has it");
    if (arguments_.save && arguments_.yes) save(node, objects);
    return;
  }
  if (!arguments_.yes) {
    print_summary(node, *values, "");
    for (const WriteStep& step : steps) print_result(node, step, "would be written", {}, false);
    return;
  }
  print_differences(node, *values);
  {
    ObjectProgress progress(bus_, node.shown_name());
    master::write(steps, objects, progress.function());
  }
  // The values that the device has now count, not its answers during the write.
  const auto now =
      has(steps, WriteStep::State::not_answered) ? std::nullopt : values_of_device(node, objects);
  print_writes(node, steps, now ? &*now : nullptr);
  if (!now)
    return silent(node, "no longer answers: whether it keeps what it has acknowledged cannot be known");
  if (has(steps, WriteStep::State::refused)) ++summary_.refused;
  print_summary(node, *now, "is as the project has it, read back");
  if (arguments_.save) save(node, objects);
}

void BusSession::accept_values(NetworkProject& project, std::uint8_t node_id) {
  const ProjectNode node = *project.find(node_id);
  BusObjects objects(bus_, node_id, time_out_);
  if (!is_the_device(node, objects)) return;
  NetworkProject changed = project;
  ObjectProgress progress(bus_, node.shown_name());
  const auto values = master::find_changed(*node.device, node_id, objects, progress.function());
  unsigned taken = 0;
  for (const ComparedValue& value : values) {
    if (value.state == ComparedValue::State::not_answered) {
      return silent(node, "no longer answers: nothing is taken over");
    }
    const auto text = master::value_text(value.object, value.type, value.found);
    const auto done =
        value.state != ComparedValue::State::different || !text
            ? std::expected<void, std::string>(std::unexpected(
                  value.reason.empty() ? std::string("no value that a DCF could hold") : value.reason))
            : changed.set_value(node_id, value.object.index, value.object.sub, *text);
    print_accepted_value(node, value, done ? std::string() : done.error());
    if (done) ++taken;
  }
  project = std::move(changed);
  ++(taken == 0 ? summary_.same : summary_.different);
  if (!arguments_.bus.json)
    print_line("{}: {} taken over", node.shown_name(), ascii::counted(taken, "value"));
}

int BusSession::end() {
  if (arguments_.bus.json) {
    print_json(Json{{"event", "summary"},
                    {"same", summary_.same},
                    {"different", summary_.different},
                    {"no_answer", summary_.silent},
                    {"refused", summary_.refused}});
  }
  if (summary_.silent != 0) return project_code::no_answer;
  if (summary_.refused != 0) return project_code::aborted;
  return summary_.different != 0 ? project_code::different : project_code::done;
}

void BusSession::silent(const ProjectNode& node, std::string_view what) {
  ++summary_.silent;
  if (arguments_.bus.json) {
    print_json(Json{{"node", node.id()}, {"state", "no answer"}, {"reason", what}});
  } else {
    print_line("{}: {}", node.shown_name(), what);
  }
}

bool BusSession::is_the_device(const ProjectNode& node, BusObjects& objects) {
  if (node.device == nullptr) {
    print_error("canopus project: {}: {}", node.shown_name(), node.trouble());
    ++summary_.different;
    return false;
  }
  const auto identity = master::compare_identity(*node.device, objects);
  bool is_good = true;
  for (const ComparedValue& value : identity) {
    if (value.state == ComparedValue::State::not_answered) {
      if (!value.reason.empty()) silent(node, fmt::format("does not answer ({})", value.reason));
      return false;
    }
    if (value.state == ComparedValue::State::same || is_asked_alone(value)) continue;
    is_good = false;
    print_result(node, value);
  }
  if (is_good) return true;
  ++summary_.different;
  if (!arguments_.bus.json) print_line("{}: it is another device, which is left alone", node.shown_name());
  return false;
}

std::optional<std::vector<ComparedValue>> BusSession::compared(const ProjectNode& node, BusObjects& objects) {
  if (!is_the_device(node, objects)) return std::nullopt;
  auto values = values_of_device(node, objects);
  if (!values) silent(node, "no longer answers");
  return values;
}

std::optional<std::vector<ComparedValue>> BusSession::values_of_device(const ProjectNode& node,
                                                                       BusObjects& objects) {
  ObjectProgress progress(bus_, node.shown_name());
  auto values = master::compare_configuration(*node.device, node.id(), objects, progress.function());
  const bool is_silent =
      std::ranges::find(values, ComparedValue::State::not_answered, &ComparedValue::state) != values.end();
  if (is_silent) return std::nullopt;
  return values;
}

void BusSession::print_differences(const ProjectNode& node, const std::vector<ComparedValue>& values) {
  for (const ComparedValue& value : values) {
    if (value.state != ComparedValue::State::same) print_result(node, value);
  }
}

void BusSession::print_summary(const ProjectNode& node, const std::vector<ComparedValue>& values,
                               std::string_view good) {
  const auto wrong = std::ranges::count_if(
      values, [](const ComparedValue& value) { return value.state != ComparedValue::State::same; });
  ++(wrong == 0 ? summary_.same : summary_.different);
  print_differences(node, values);
  if (arguments_.bus.json) {
    print_json(Json{{"node", node.id()},
                    {"state", wrong == 0 ? "same" : "different"},
                    {"values", values.size()},
                    {"differ", wrong}});
  } else if (wrong != 0) {
    print_line("{}: different: {} of {}", node.shown_name(), wrong, ascii::counted(values.size(), "value"));
  } else {
    print_line("{}: {} ({})", node.shown_name(), good, ascii::counted(values.size(), "value"));
  }
}

void BusSession::print_result(const ProjectNode& node, const ComparedValue& value) {
  const std::string title = title_of(node, value.object);
  if (arguments_.bus.json) {
    Json json{{"node", node.id()},
              {"object", object_text(value.object)},
              {"name", title},
              {"state", state_name(value.state)},
              {"project", client::json_value(value.wanted, value.type)}};
    json["device"] = value.found.empty() ? Json() : client::json_value(value.found, value.type);
    if (!value.reason.empty()) json["reason"] = value.reason;
    return print_json(json);
  }
  print_line("{}: {}  project {}, device {}  {}", node.shown_name(), object_text(value.object),
             words(value.wanted, value.type),
             value.reason.empty() ? words(value.found, value.type) : "- (" + value.reason + ")", title);
}

void BusSession::print_writes(const ProjectNode& node, const std::vector<WriteStep>& steps,
                              const Values* now) {
  constexpr std::string_view not_read_back = "acknowledged, not read back";
  for (auto step = steps.begin(); step != steps.end(); ++step) {
    if (step->state != WriteStep::State::written) {
      print_result(node, *step, state_name(step->state), step->reason,
                   step->state != WriteStep::State::not_tried);
      continue;
    }
    // A device that has lost its supply since may have lost the value, too.
    if (now == nullptr) {
      print_result(node, *step, not_read_back, {}, true);
      continue;
    }
    // A PDO is switched off first: only the last write of an object is there in the end.
    const bool is_last =
        std::ranges::find(std::next(step), steps.end(), step->object, &WriteStep::object) == steps.end();
    const auto found = std::ranges::find(*now, step->object, &ComparedValue::object);
    if (!is_last || found == now->end() || found->state == ComparedValue::State::same) {
      print_result(node, *step, state_name(step->state), {}, false);
    } else if (found->state == ComparedValue::State::different) {
      print_result(node, *step, "acknowledged, but not kept", "the device has " + found_text(*found) + " now",
                   true);
    } else {
      print_result(node, *step, not_read_back, found->reason, true);
    }
  }
}

void BusSession::print_result(const ProjectNode& node, const WriteStep& step, std::string_view state,
                              const std::string& reason, bool is_bad) {
  const canopen::Entry entry = node.device->dictionary->find(step.object.index, step.object.sub);
  const canopen::DataType type = entry ? entry.description->type : canopen::DataType::none;
  if (arguments_.bus.json) {
    Json json{{"node", node.id()},
              {"write", object_text(step.object)},
              {"value", client::json_value(step.value, type)},
              {"state", state}};
    if (!reason.empty()) json["reason"] = reason;
    return print_json(json);
  }
  print_line("{}: {} = {}: {}{}", node.shown_name(), object_text(step.object), words(step.value, type),
             paint(state, is_bad ? "31" : "32", arguments_.yes && wants_colour(STDOUT_FILENO)),
             reason.empty() || !is_bad ? "" : ", " + reason);
}

void BusSession::print_accepted_value(const ProjectNode& node, const ComparedValue& value,
                                      const std::string& why_not) {
  if (arguments_.bus.json) {
    Json json{
        {"node", node.id()}, {"object", object_text(value.object)}, {"name", title_of(node, value.object)}};
    json["value"] = value.found.empty() ? Json() : client::json_value(value.found, value.type);
    json["state"] = why_not.empty() ? "taken" : "left";
    if (!why_not.empty()) json["reason"] = why_not;
    return print_json(json);
  }
  print_line("{}: {} = {}  {}{}", node.shown_name(), object_text(value.object),
             value.found.empty() ? "-" : words(value.found, value.type), title_of(node, value.object),
             why_not.empty() ? "" : ": left alone, " + why_not);
}

void BusSession::save(const ProjectNode& node, BusObjects& objects) {
  constexpr std::uint8_t signature[] = {'s', 'a', 'v', 'e'};
  const auto saved = objects.write({0x1010, 1}, signature);
  if (!saved && !saved.error().is_refused) return silent(node, "did not answer to save (1010:01)");
  if (!saved) ++summary_.refused;
  if (arguments_.bus.json) {
    Json json{{"node", node.id()}, {"saved", saved.has_value()}};
    if (!saved) json["reason"] = saved.error().reason;
    return print_json(json);
  }
  print_line("{}: {}", node.shown_name(),
             saved ? "saved (1010:01)" : "not saved (1010:01): " + saved.error().reason);
}

}  // namespace canopus::cli
