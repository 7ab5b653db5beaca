#include "canopus/campaign/invariant_checks.hpp"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "canopus/campaign/plant_access.hpp"
#include "canopus/campaign/python_check.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/process_value.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/text/text_values.hpp"
#include "canopus/trace/print/message_printer.hpp"

namespace canopus::campaign {
namespace {

/// No node is out of operation for longer than a time while it has supply.
class OperationalInvariant final : public InvariantCheck {
 public:
  using InvariantCheck::InvariantCheck;

  std::string attach(plant::Plant& plant) override {
    const std::vector<plant::NodeStatus> nodes = plant.nodes();
    for (const std::string& name : invariant().nodes) {
      if (std::ranges::none_of(nodes, [&](const plant::NodeStatus& node) { return node.label.name == name; }))
        return fmt::format("nodes: the plant has no node \"{}\"{}", name,
                           names_there_are(name, names_of(nodes)));
    }
    since_.assign(nodes.size(), can::Time{});
    is_reported_.assign(nodes.size(), false);
    return {};
  }
  void sample(const std::vector<plant::NodeStatus>& nodes, can::Time now) override {
    if (nodes.size() != since_.size()) return;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const plant::NodeStatus& node = nodes[i];
      const bool is_meant =
          invariant().nodes.empty() || std::ranges::count(invariant().nodes, node.label.name) != 0;
      if (!is_meant || !node.is_on || in_operation(node) || !counts(now)) {
        since_[i] = now;
      } else if (now - since_[i] > *invariant().within && !is_reported_[i]) {
        is_reported_[i] = true;
        const std::string condition(condition_name(node));
        fail(describe(node.label), condition,
             fmt::format("{} for longer than {}", condition, text::describe_duration(*invariant().within)),
             now);
      }
    }
  }

 private:
  static std::vector<std::string> names_of(const std::vector<plant::NodeStatus>& nodes) {
    std::vector<std::string> names;
    for (const plant::NodeStatus& node : nodes) names.emplace_back(node.label.name);
    return names;
  }

  std::vector<can::Time> since_;
  std::vector<bool> is_reported_;
};

/// A number of the plant: an object, a word or a variable.
class ValueInvariant final : public InvariantCheck {
 public:
  using InvariantCheck::InvariantCheck;

  std::string attach(plant::Plant& plant) override {
    plant_ = &plant;
    const Invariant& wanted = invariant();
    if (!wanted.object.empty()) return attach_object();
    const FoundNumber plc = find_plc(plant, wanted.target.plc);
    if (!plc) return plc.error();
    plc_ = *plc;
    if (!wanted.variable.empty()) {
      name_ = wanted.variable;
      if (plant.program(plc_) == nullptr) return "variable: the PLC has no program";
      const auto value = plant.program(plc_)->machine().read(wanted.variable);
      if (!value) return fmt::format("variable: {}", value.error());
      return number_of(*value) ? ""
                               : fmt::format("variable: {} is {}, expected a number or BOOL", name_, *value);
    }
    name_ = wanted.word;
    const auto address = find_word(plant.rack(plc_), wanted.word);
    if (!address) return address.error();
    address_ = *address;
    return {};
  }
  void sample(const std::vector<plant::NodeStatus>& /*nodes*/, can::Time now) override {
    if (!counts(now)) return;
    const std::optional<double> value = read(now);
    if (!value) return;
    const Invariant& wanted = invariant();
    const bool in_range = (!wanted.low || *value >= *wanted.low) && (!wanted.high || *value <= *wanted.high);
    if (wanted.expectation == Expectation::always) {
      if (!in_range && !std::exchange(was_reported_, true)) {
        const bool is_low = wanted.low && *value < *wanted.low;
        fail(name_, is_low ? "below its range" : "above its range",
             fmt::format("is {:.10g}, expected {}", *value, range_text()), now);
      }
    } else if (in_range) {
      if (!std::exchange(was_reported_, true))
        seen(name_, "in the range", fmt::format("is {:.10g}", *value), now);
    }
    check_changes(*value, now);
  }

 private:
  std::string attach_object() {
    const FoundNumber device = find_device(*plant_, invariant().target.device);
    if (!device) return device.error();
    device_ = &plant_->device(*device);
    const auto entry = plant::find_process_value(device_->device(), invariant().object);
    if (!entry) return fmt::format("object: {}", entry.error());
    entry_ = *entry;
    name_ = fmt::format("{} {}", invariant().target.device, invariant().object);
    return {};
  }
  static std::optional<double> number_of(const std::string& text) {
    if (text == "TRUE" || text == "true") return 1;
    if (text == "FALSE" || text == "false") return 0;
    const std::size_t mark = text.rfind('#');  // 16#1F is how a program shows bits
    if (mark != std::string::npos) {
      if (!text.starts_with("16#")) return std::nullopt;
      return static_cast<double>(std::strtoull(text.c_str() + mark + 1, nullptr, 16));
    }
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    return end != text.c_str() && *end == 0 ? std::optional(number) : std::nullopt;
  }
  std::optional<double> read(can::Time now) {
    if (device_ != nullptr) {
      if (!device_->status().is_on) return std::nullopt;
      const auto bits = device_->device().node().dictionary().get<std::uint64_t>(entry_);
      return number_of(plant::show_value(entry_.description->type, bits));
    }
    if (!invariant().variable.empty()) {
      const auto value = plant_->program(plc_)->machine().read(invariant().variable);
      return value ? number_of(*value) : std::nullopt;
    }
    const auto word = peek(plant_->rack(plc_), address_, now);
    return word ? std::optional(static_cast<double>(*word)) : std::nullopt;
  }
  void check_changes(double value, can::Time now) {
    if (!invariant().changes) return;
    if (!last_ || *last_ != value) {
      last_ = value;
      changed_at_ = now;
      stands_ = false;
    } else if (now - changed_at_ > *invariant().changes && !std::exchange(stands_, true)) {
      fail(name_, "does not change",
           fmt::format("is {:.10g} for longer than {}", value, text::describe_duration(*invariant().changes)),
           now);
    }
  }
  [[nodiscard]] std::string range_text() const {
    const Invariant& wanted = invariant();
    if (!wanted.low) return fmt::format("{:.10g} or less", *wanted.high);
    if (!wanted.high) return fmt::format("{:.10g} or more", *wanted.low);
    return fmt::format("{:.10g} to {:.10g}", *wanted.low, *wanted.high);
  }

  plant::Plant* plant_ = nullptr;
  std::string name_;
  std::size_t plc_ = 0;
  plc::RackAddress address_{};
  plant::DeviceOnBus* device_ = nullptr;
  canopen::Entry entry_{};
  bool was_reported_ = false;
  std::optional<double> last_;
  can::Time changed_at_{};
  bool stands_ = false;
};

/// The text of a message that does not change from run to run.
std::string reason_of(const trace::Message& message) {
  std::string reason = service_text(message);
  if (!message.kind.empty() && !reason.contains(message.kind)) reason += fmt::format(" {}", message.kind);
  if (message.emcy_code) reason += fmt::format(" {:04X}H", *message.emcy_code);
  if (message.abort_code) reason += fmt::format(", abort {:08X}H", *message.abort_code);
  return reason;
}

std::string node_of(const trace::Message& message, std::string_view bus) {
  return message.node == 0 ? std::string(bus) : fmt::format("{} node {}", bus, node_text(message));
}

bool matches(const trace::FilterExpression& filter, const trace::Message& message, std::string_view bus) {
  return filter.wants(message, bus, message.time.time_since_epoch(),
                      [&] { return searched_text(message, bus); });
}

class FrameInvariant final : public InvariantCheck {
 public:
  using InvariantCheck::InvariantCheck;

  void receive(const trace::Message& message, std::string_view bus) override {
    if (!counts(message.time) || !matches(invariant().filter, message, bus)) return;
    std::string node = node_of(message, bus);
    std::string reason = reason_of(message);
    if (!reported_.insert(node + reason).second) return;
    const bool has_more = !message.text.empty() && message.text != reason;
    seen(std::move(node), reason, has_more ? fmt::format("{} {}", reason, message.text) : reason,
         message.time);
  }

 private:
  std::set<std::string> reported_;
};

/// Each frame of one kind is followed by one of another kind, within a time.
class ReactionInvariant final : public InvariantCheck {
 public:
  using InvariantCheck::InvariantCheck;
  static constexpr std::size_t most_waiting = 10'000;

  void receive(const trace::Message& message, std::string_view bus) override {
    if (message.is_transfer) return;
    if (matches(invariant().answer, message, bus) && !waiting_.empty()) {
      const can::Duration time = message.time - waiting_.front();
      waiting_.pop_front();
      result().reactions[invariant().name].add(time);
      if (time > *invariant().within) late(message.time);
    }
    if (counts(message.time) && matches(invariant().filter, message, bus) && waiting_.size() < most_waiting)
      waiting_.push_back(message.time);
  }
  void end(can::Time now) override {
    if (!waiting_.empty() && now - waiting_.front() > *invariant().within)
      late(waiting_.front() + *invariant().within);
  }

 private:
  void late(can::Time now) {
    if (std::exchange(was_reported_, true)) return;
    fail("", "reaction too late",
         fmt::format("no reaction within {}", text::describe_duration(*invariant().within)), now);
  }
  std::deque<can::Time> waiting_;
  bool was_reported_ = false;
};

class EventInvariant final : public InvariantCheck {
 public:
  using InvariantCheck::InvariantCheck;

  void on(const plant::Event& event) override {
    if (!counts(event.time) || plant::name_of(event) != invariant().event) return;
    text::TextOutput out;
    plant::JsonPrinter(out).on(event);
    if (!out.text().contains(invariant().text)) return;
    const auto line = text::parse_json(out.text());
    if (!line) return;
    std::string node;
    for (const std::string_view key : {"plc", "bus", "node", "name", "module", "lift", "source"}) {
      const auto member = line->find(key);
      if (member == line->end() || !member->is_primitive()) continue;
      node += fmt::format("{}{}", node.empty() ? "" : " ",
                          member->is_string() ? member->string() : member->dump());
    }
    std::string what;
    for (const std::string_view key : {"message", "what", "code", "state", "error", "step", "overview"}) {
      const auto member = line->find(key);
      if (member != line->end() && member->is_primitive() && what.empty())
        what = member->is_string() ? member->string() : member->dump();
    }
    std::string reason =
        fmt::format("{}{}{}", invariant().event, what.empty() ? "" : " ", without_numbers(what));
    if (!reported_.insert(node + reason).second) return;
    seen(std::move(node), std::move(reason), what, event.time);
  }

 private:
  std::set<std::string> reported_;
};

}  // namespace

void InvariantCheck::fail(std::string node, std::string reason, std::string detail, can::Time now,
                          std::string traceback) {
  if (++failures_ > most_failures) return;
  result_.failures.push_back({.invariant = invariant_.name,
                              .node = std::move(node),
                              .reason = std::move(reason),
                              .detail = std::move(detail),
                              .at = now,
                              .traceback = std::move(traceback)});
}

void InvariantCheck::reach() {
  if (!std::exchange(is_reached_, true)) result_.reached.push_back(invariant_.name);
}

void InvariantCheck::seen(std::string node, std::string reason, std::string detail, can::Time now) {
  if (invariant_.expectation == Expectation::sometimes) {
    reach();
  } else {
    fail(std::move(node), std::move(reason), std::move(detail), now);
  }
}

std::unique_ptr<InvariantCheck> make_check(const Invariant& invariant, const std::string& campaign_path,
                                           RunResult& result) {
  switch (invariant.kind) {
    case InvariantKind::operational: return std::make_unique<OperationalInvariant>(invariant, result);
    case InvariantKind::value: return std::make_unique<ValueInvariant>(invariant, result);
    case InvariantKind::frames: return std::make_unique<FrameInvariant>(invariant, result);
    case InvariantKind::event: return std::make_unique<EventInvariant>(invariant, result);
    case InvariantKind::reaction: return std::make_unique<ReactionInvariant>(invariant, result);
    case InvariantKind::python:
      return make_python_check(invariant, result, python_path(campaign_path, invariant));
  }
  return nullptr;
}

}  // namespace canopus::campaign
