#include "canopus/campaign/plant_run.hpp"

#include <algorithm>
#include <chrono>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/campaign/chosen_rules.hpp"
#include "canopus/campaign/invariant_checks.hpp"
#include "canopus/campaign/plant_access.hpp"
#include "canopus/campaign/random_stream.hpp"
#include "canopus/can/error_frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/initial_nodes.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plant/slave_boot.hpp"
#include "canopus/plc/execution/program_execution.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/text/table_reader.hpp"
#include "canopus/trace/decode/decoder.hpp"

namespace canopus::campaign {
namespace {

/// What a rule does to a plant while it runs, and no plant file has a key for.
struct PlantAction {
  can::Time at{};
  std::function<void(plant::Plant& plant, can::Time now)> carry_out{};
};

using Result = std::expected<void, std::string>;

/// When it begins, and when it ends.
struct Span {
  can::Time begin{};
  std::optional<can::Time> end{};
};

Span read_span(text::TableReader& table) {
  Span span{.begin = can::Time{} + table.parsed("at", text::parse_duration, true).value_or(can::Duration{})};
  if (const auto length = table.parsed("for", text::parse_duration))
    span.end = can::later(span.begin, *length);
  return span;
}

module::CpuState state_of(const plant::Plant& plant, std::size_t plc) {
  return plant.plc_section(plc).run ? module::CpuState::run : module::CpuState::stop;
}

Result cut_power(const ChosenRule& chosen, const Span& span, plant::Plant& plant,
                 std::vector<PlantAction>& actions) {
  const Target& target = chosen.rule->target;
  if (!target.device.empty()) {
    const FoundNumber device = find_device(plant, target.device);
    if (!device) return std::unexpected(device.error());
    actions.push_back(
        {span.begin, [number = *device](plant::Plant& of, can::Time) { of.device(number).unplug(); }});
    if (span.end) {
      actions.push_back({*span.end, [number = *device](plant::Plant& of, can::Time now) {
                           of.device(number).plug_in(now);
                         }});
    }
    return {};
  }
  const FoundNumber plc = find_plc(plant, target.plc);
  if (!plc) return std::unexpected(plc.error());
  actions.push_back(
      {span.begin, [number = *plc](plant::Plant& of, can::Time now) { of.rack(number).power_off(now); }});
  if (span.end) {
    actions.push_back({*span.end, [number = *plc](plant::Plant& of, can::Time now) {
                         of.rack(number).power_on(now, state_of(of, number));
                       }});
  }
  return {};
}

Result stop_cpu(const ChosenRule& chosen, const Span& span, plant::Plant& plant,
                std::vector<PlantAction>& actions) {
  const FoundNumber plc = find_plc(plant, chosen.rule->target.plc);
  if (!plc) return std::unexpected(plc.error());
  const auto set = [number = *plc](module::CpuState state) {
    return [number, state](plant::Plant& of, can::Time now) { of.rack(number).set_cpu_state(state, now); };
  };
  actions.push_back({span.begin, set(module::CpuState::stop)});
  if (span.end) actions.push_back({*span.end, set(module::CpuState::run)});
  return {};
}

Result write_variable(std::size_t plc, const std::string& variable, const std::string& value, can::Time at,
                      plant::Plant& plant, std::vector<PlantAction>& actions) {
  if (plant.program(plc) == nullptr) return std::unexpected("variable: the PLC has no program");
  program::Machine& machine = plant.program(plc)->machine();
  const auto before = machine.read(variable);
  if (!before) return std::unexpected("variable: " + before.error());
  const auto written = machine.write(variable, value);
  if (!written) return std::unexpected("value: " + written.error());
  if (const auto restored = machine.write(variable, *before); !restored) machine.cold_start();
  actions.push_back({at, [plc, variable, value](plant::Plant& of, can::Time) {
                       (void)of.program(plc)->machine().write(variable, value);
                     }});
  return {};
}

Result write_at(std::size_t plc, const std::string& word, std::int64_t value, can::Time at,
                plant::Plant& plant, std::vector<PlantAction>& actions) {
  const auto address = find_word(plant.rack(plc), word);
  if (!address) return std::unexpected(address.error());
  if (value < -32768 || value > 65535) return std::unexpected("value: expected -32768 to 65535");
  actions.push_back({at, [plc, address = *address, value](plant::Plant& of, can::Time now) {
                       write_word(of.rack(plc), address, static_cast<std::uint16_t>(value), now);
                     }});
  return {};
}

Result write(const ChosenRule& chosen, text::TableReader& table, plant::Plant& plant,
             std::vector<PlantAction>& actions) {
  const can::Time at = can::Time{} + table.parsed("at", text::parse_duration, true).value_or(can::Duration{});
  const auto word = table.text("word");
  const auto variable = table.text("variable");
  const toml::node* const value = table.find("value");
  if (word.has_value() == variable.has_value())
    return std::unexpected("expected word or variable, one of them");
  if (value == nullptr) return std::unexpected("value is missing");
  const FoundNumber plc = find_plc(plant, chosen.rule->target.plc);
  if (!plc) return std::unexpected(plc.error());
  if (variable) {
    const std::string text = value->is_string() ? value->as_string()->get() : text::describe_found(*value);
    return write_variable(*plc, *variable, text, at, plant, actions);
  }
  const auto number = value->is_boolean() ? std::optional<std::int64_t>(value->as_boolean()->get() ? 1 : 0)
                                          : value->value_exact<std::int64_t>();
  if (!number) return std::unexpected("value: expected a whole number, true or false");
  return write_at(*plc, *word, *number, at, plant, actions);
}

/// Adds the actions of a power cut, of a CPU's STOP, or of a write; of other rules none. The error is a sentence.
Result add_actions(const ChosenRule& chosen, plant::Plant& plant, std::vector<PlantAction>& actions) {
  const RuleKind kind = chosen.rule->kind;
  if (kind != RuleKind::power_cut && kind != RuleKind::cpu_stop && kind != RuleKind::write) return {};
  std::vector<text::FileError> errors;
  text::TableReader table(chosen.values, std::string(key_of(kind)), errors);
  Result result;
  if (kind == RuleKind::write) {
    result = write(chosen, table, plant, actions);
  } else {
    const Span span = read_span(table);
    result = kind == RuleKind::power_cut ? cut_power(chosen, span, plant, actions)
                                         : stop_cpu(chosen, span, plant, actions);
  }
  table.finish();
  if (!errors.empty()) return std::unexpected(errors.front().message);
  return result;
}

using Checks = std::vector<std::unique_ptr<InvariantCheck>>;

/// The frames of a bus: counted, decoded for the invariants that want them, and recorded.
class BusWatch final : public can::BusObserver {
 public:
  BusWatch(can::Bus& bus, std::uint16_t number, trace::Decoder* decoder, const Checks& checks,
           RunResult& result, Checksum& checksum, RunRecord* record)
      : bus_(bus),
        number_(number),
        decoder_(decoder),
        checks_(checks),
        result_(result),
        checksum_(checksum),
        record_(record) {
    bus.add_observer(*this);
  }
  void frame_completed(const can::Frame& frame, can::Time /*start*/, can::Time end) override {
    ++result_.frames;
    checksum_.add_number(static_cast<std::uint64_t>(end.time_since_epoch().count()));
    checksum_.add_number(std::uint64_t{frame.identifier} << 8U | frame.dlc |
                         std::uint64_t{frame.extended} << 5U | std::uint64_t{frame.remote} << 4U |
                         std::uint64_t{number_} << 40U);
    for (std::size_t i = 0; i < frame.length(); ++i) checksum_.add_number(frame.data[i]);
    decode({.time = end, .channel = number_, .frame = frame});
  }
  void errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) override {
    if (reports.front().first)
      keep({.time = now,
            .channel = number_,
            .error_frame = true,
            .frame = can::error_frame(can::recorded_of(reports))});
  }

 private:
  void keep(const trace::TraceRecord& record) {
    if (record_ != nullptr && record_->frames.size() < RunRecord::most_frames)
      record_->frames.push_back({bus_.name(), record});
  }
  void decode(const trace::TraceRecord& record) {
    keep(record);
    if (decoder_ == nullptr) return;
    decoder_->receive(record, bus_.name(), [&](const trace::Message& message) {
      for (const auto& check : checks_) check->receive(message, bus_.name());
    });
  }

  can::Bus& bus_;
  std::uint16_t number_;
  trace::Decoder* decoder_;
  const Checks& checks_;
  RunResult& result_;
  Checksum& checksum_;
  RunRecord* record_;
};

class Run final : private plant::PlantObserver {
 public:
  Run(const Campaign& campaign, const RunPlan& plan, RunRecord* record)
      : campaign_(campaign), plan_(plan), record_(record), printer_(events_) {
    result_.variant = plan.variant;
    result_.seed = plan.seed;
    for (const Invariant& invariant : campaign.file.invariants)
      checks_.push_back(make_check(invariant, campaign.file.path, result_));
  }

  std::expected<void, text::FileError> build();
  RunResult carry_out(const std::string& until);

 private:
  void on(const plant::Event& event) override {
    for (const auto& check : checks_) check->on(event);
    if (record_ == nullptr) return;
    printer_.on(event);
    keep_last_events();
  }
  void keep_last_events();
  void watch_buses();
  void sample();
  [[nodiscard]] bool has(const std::string& fingerprint) const {
    return std::ranges::any_of(result_.failures, [&](const InvariantFailure& failure) {
      return failure.fingerprint() == fingerprint;
    });
  }

  const Campaign& campaign_;
  const RunPlan& plan_;
  RunRecord* record_;
  text::TextOutput events_;
  plant::JsonPrinter printer_;
  RunResult result_;
  Checks checks_;
  Checksum checksum_;
  std::unique_ptr<trace::Decoder> decoder_;
  std::unique_ptr<plant::Plant> plant_;
  std::vector<std::unique_ptr<BusWatch>> buses_;
  std::vector<PlantAction> actions_;
};

/// The newest events are enough: a plant that reports without end does not fill the memory.
void Run::keep_last_events() {
  constexpr std::size_t most = std::size_t{4} << 20U;
  if (events_.text().size() < most) return;
  const std::string& all = events_.text();
  record_->events = all.substr(all.find('\n', all.size() - most / 2) + 1);
  events_.clear();
}

std::expected<void, text::FileError> Run::build() {
  const auto wrong = [](text::Place place, std::string message) {
    return std::unexpected(text::FileError{place, std::move(message)});
  };
  const PlantTemplate& base = campaign_.plants[plan_.variant];
  auto table = base.with(plan_.rules, plan_.without_devices);
  if (!table) return wrong({}, table.error());
  plant::PlantReading reading = plant::read_plant(text_of(*table), base.path());
  if (!reading.errors.empty()) return wrong({}, reading.errors.front().message);
  auto plant = plant::Plant::build(std::move(reading.plant), *this, plan_.seed);
  if (!plant) return wrong({}, plant.error().front().message);
  plant_ = std::move(*plant);
  for (const auto& check : checks_) {
    const std::string problem = check->attach(*plant_);
    if (problem.empty()) continue;
    return wrong(place_of_key_in(problem, check->invariant().places, check->invariant().place),
                 fmt::format("invariant \"{}\": {}", check->invariant().name, problem));
  }
  for (const ChosenRule& chosen : plan_.rules) {
    if (const auto added = add_actions(chosen, *plant_, actions_); !added)
      return wrong(place_of_key_in(added.error(), chosen.rule->places, chosen.rule->place),
                   fmt::format("rule \"{}\": {}", chosen.rule->name, added.error()));
  }
  std::ranges::stable_sort(actions_, {}, &PlantAction::at);
  watch_buses();
  return {};
}

void Run::watch_buses() {
  const bool decodes = std::ranges::any_of(campaign_.file.invariants, [](const Invariant& invariant) {
    return invariant.kind == InvariantKind::frames || invariant.kind == InvariantKind::reaction ||
           invariant.has_filter;
  });
  if (decodes || record_ != nullptr) {
    trace::Names names;
    for (plant::InitialPlantNode& node : plant::initial_nodes(*plant_)) {
      names.add(trace::describe_node(std::move(node.bus), node.node_id, std::move(node.name),
                                     std::move(node.objects)));
    }
    if (record_ != nullptr) record_->names = names;
    decoder_ = std::make_unique<trace::Decoder>(std::move(names), trace::DecoderOptions{.frames = true});
  }
  for (std::size_t i = 0; i < plant_->bus_count(); ++i) {
    buses_.push_back(std::make_unique<BusWatch>(plant_->bus(i), static_cast<std::uint16_t>(i), decoder_.get(),
                                                checks_, result_, checksum_, record_));
  }
}

void Run::sample() {
  const can::Time now = plant_->timeline().now();
  const std::vector<plant::NodeStatus> nodes = plant_->nodes();
  if (!result_.boot && std::ranges::all_of(nodes, plant::in_operation)) result_.boot = now.time_since_epoch();
  for (const auto& check : checks_) check->sample(nodes, now);
}

RunResult Run::carry_out(const std::string& until) {
  can::Timeline& timeline = plant_->timeline();
  plant_->power_on();
  const can::Time end = can::Time{} + plan_.duration;
  can::Time next_sample = can::Time{} + campaign_.file.sample_interval;
  auto action = actions_.begin();
  while (timeline.now() < end && !plant_->has_stalled()) {
    can::Time next = std::min(next_sample, end);
    if (action != actions_.end()) next = std::min(next, action->at);
    timeline.run_until(next);
    for (; action != actions_.end() && action->at <= next; ++action) action->carry_out(*plant_, next);
    if (next != next_sample) continue;
    next_sample += campaign_.file.sample_interval;
    sample();
    if (!until.empty() && has(until)) break;
  }
  if (decoder_) {
    decoder_->finish([&](const trace::Message& message) {
      const std::string& bus = plant_->bus(message.channel).name();
      for (const auto& check : checks_) check->receive(message, bus);
    });
  }
  for (const auto& check : checks_) check->end(timeline.now());
  if (record_ != nullptr) {
    record_->events += events_.text();
    for (const plant::SlaveBoot& boot : plant_->boots()) {
      std::string trouble = plant::describe_trouble(boot, timeline.now());
      if (!trouble.empty()) record_->boots.push_back(std::move(trouble));
    }
  }
  std::ranges::stable_sort(result_.failures, {}, &InvariantFailure::at);
  result_.checksum = checksum_.value();
  buses_.clear();
  return std::move(result_);
}

}  // namespace

RunPlan plan_of(const Campaign& campaign, std::size_t variant, std::uint64_t seed) {
  return {.variant = variant,
          .seed = seed,
          .rules = choose_rules(campaign.file, seed),
          .duration = campaign.file.duration};
}

std::expected<RunResult, text::FileError> run(const Campaign& campaign, const RunPlan& plan,
                                              const std::string& until, RunRecord* record) {
  Run run(campaign, plan, record);
  if (auto built = run.build(); !built) return std::unexpected(std::move(built.error()));
  return run.carry_out(until);
}

RunResult run_or_fail(const Campaign& campaign, const RunPlan& plan) {
  auto result = run(campaign, plan);
  if (result) return std::move(*result);
  return {.variant = plan.variant,
          .seed = plan.seed,
          .failures = {{.invariant = "plant file",
                        .reason = without_numbers(result.error().message),
                        .detail = result.error().message}}};
}

}  // namespace canopus::campaign
