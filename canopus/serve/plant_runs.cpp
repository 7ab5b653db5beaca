#include "canopus/serve/plant_runs.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/client/plc_point.hpp"

namespace canopus::serve {
namespace {

constexpr std::string_view expected_form = "expected for example \"X1\", \"D100 >= 5\" or \"U0\\G601 == 5\"";

std::string why_refused(plc::AccessError error, const plc::melsec::Target& target, unsigned io_base) {
  const std::string address = client::plc_address(target, 0, io_base);
  switch (error) {
    case plc::AccessError::no_device: return fmt::format("the CPU has no {}", address);
    case plc::AccessError::no_module:
      return fmt::format("{}: there is no module at this head address, or it has no supply", address);
    case plc::AccessError::beyond_buffer:
      return fmt::format("{} is beyond the module's buffer memory", address);
    case plc::AccessError::wrong_unit:
    case plc::AccessError::out_of_range: break;
  }
  return fmt::format("{} is beyond the CPU's last one", address);
}

}  // namespace

std::expected<PlcCondition, std::string> PlcCondition::parse(std::string_view text, const plc::Rack& rack) {
  // The longer ones first: "<=" begins with "<".
  static constexpr std::array<std::pair<std::string_view, Comparison>, 6> comparisons{{
      {"==", Comparison::equal},
      {"!=", Comparison::not_equal},
      {"<=", Comparison::less_or_equal},
      {">=", Comparison::greater_or_equal},
      {"<", Comparison::less},
      {">", Comparison::greater},
  }};
  PlcCondition condition;
  const std::size_t at = text.find_first_of("=!<>");
  const unsigned io_base = rack.model().number_base(plc::Device::x);
  const auto address = client::parse_plc_address(ascii::trim(text.substr(0, at)), io_base);
  if (!address) return std::unexpected(address.error());
  condition.target_ = *address;
  condition.is_bit_ = !address->is_buffer && plc::device_info(address->device).is_bit;
  const auto known = address->is_buffer ? rack.check_buffer(address->head_address, address->number, 1)
                                        : rack.check(address->device, address->number, 1);
  if (!known) return std::unexpected(why_refused(known.error(), *address, io_base));
  if (at == std::string_view::npos) {
    if (condition.is_bit_) return condition;
    return std::unexpected(
        fmt::format("\"{}\" is a word and needs a comparison; {}", ascii::trim(text), expected_form));
  }
  const auto* found = std::ranges::find_if(
      comparisons, [&](const auto& each) { return text.substr(at).starts_with(each.first); });
  if (found == comparisons.end()) {
    return std::unexpected(fmt::format("\"{}\" has none of == != < <= > >=; {}", text, expected_form));
  }
  condition.comparison_ = found->second;
  const std::string_view constant = ascii::trim(text.substr(at + found->first.size()));
  if (condition.is_bit_) {
    const auto bit = client::parse_plc_bit(constant);
    if (!bit) return std::unexpected(bit.error());
    condition.constant_ = *bit ? 1 : 0;
    return condition;
  }
  const auto word = client::parse_plc_word(constant);
  if (!word) return std::unexpected(word.error());
  condition.is_signed_ = constant.starts_with('-');
  condition.constant_ = condition.is_signed_ ? static_cast<std::int16_t>(*word) : std::int32_t{*word};
  return condition;
}

bool PlcCondition::holds(plc::Rack& rack, can::Time now) const {
  std::int32_t value = 0;
  if (is_bit_) {
    std::uint8_t bit = 0;
    if (!rack.read_bits(target_.device, target_.number, {&bit, 1}, now)) return false;
    value = bit;
  } else {
    std::uint16_t word = 0;
    const auto read = target_.is_buffer
                          ? rack.read_buffer(target_.head_address, target_.number, {&word, 1}, now)
                          : rack.read_words(target_.device, target_.number, {&word, 1}, now);
    if (!read) return false;
    value = is_signed_ ? static_cast<std::int16_t>(word) : std::int32_t{word};
  }
  switch (comparison_) {
    case Comparison::equal: return value == constant_;
    case Comparison::not_equal: return value != constant_;
    case Comparison::less_or_equal: return value <= constant_;
    case Comparison::greater_or_equal: return value >= constant_;
    case Comparison::less: return value < constant_;
    case Comparison::greater: return value > constant_;
  }
  return false;
}

PlantRuns::PlantRuns(plant::Plant& plant, Order order, std::function<void()> over)
    : plant_(plant), order_(order), over_(std::move(over)) {
  plant.timeline().add(*this, "clients that wait");
}

plc::Rack* PlantRuns::rack(const Run& run) const {
  return run.goal.plc ? &plant_.rack(*run.goal.plc) : nullptr;
}

PlantRuns::Number PlantRuns::start(Goal goal, Done done) {
  Run& run = runs_.emplace_back();
  alarm().add_part(run.due);
  run.number = ++last_number_;
  run.goal = std::move(goal);
  run.done = std::move(done);
  begin_next();
  return run.number;
}

void PlantRuns::cancel(Number number) {
  std::erase_if(runs_, [number](const Run& run) { return run.number == number; });
  begin_next();
}

bool PlantRuns::wants_time() const noexcept {
  return std::ranges::any_of(runs_, [](const Run& run) { return run.has_begun && !run.is_over; });
}

void PlantRuns::report() {
  while (true) {
    const auto run = std::ranges::find_if(runs_, &Run::is_over);
    if (run == runs_.end()) break;
    const Done done = std::move(run->done);
    const Outcome outcome = run->outcome;
    runs_.erase(run);
    done(outcome);
  }
  begin_next();
}

void PlantRuns::end_all() {
  for (Run& run : runs_) {
    if (run.is_over) continue;
    run.outcome.plant_ended = true;
    finish(run, plant_.timeline().now());
  }
}

void PlantRuns::begin_next() {
  const can::Time now = plant_.timeline().now();
  for (Run& run : runs_) {
    if (!run.has_begun) begin(run, now);
    if (order_ == Order::in_turn) break;
  }
}

void PlantRuns::begin(Run& run, can::Time now) {
  run.has_begun = true;
  if (const plc::Rack* of = rack(run)) {
    run.scans_before = of->scan().ended(now);
    if (run.goal.scans) run.end = of->scan().end_of(*run.goal.scans, now);
  }
  if (run.goal.duration) run.end = std::min(run.end, can::later(now, *run.goal.duration));
  evaluate(run, now);
}

void PlantRuns::evaluate(Run& run, can::Time now) {
  plc::Rack* const of = rack(run);
  can::Time next = run.end;
  if (run.goal.until && of != nullptr) {
    run.outcome.is_met = run.goal.until->holds(*of, now);
    next = std::min(run.end, of->scan().end_of(1, now));
  }
  run.due = next;
  if (run.outcome.is_met || now >= run.end) finish(run, now);
}

void PlantRuns::finish(Run& run, can::Time now) {
  if (const plc::Rack* of = rack(run); of != nullptr && run.has_begun) {
    const std::uint64_t ended = of->scan().ended(now);
    run.outcome.scans = ended - std::min(ended, run.scans_before);  // fewer after a new start of the CPU
  }
  run.is_over = true;
  run.due = can::never;
  over_();
}

void PlantRuns::tick(can::Time now) {
  for (Run& run : runs_) {
    if (run.has_begun && !run.is_over && run.due <= now) evaluate(run, now);
  }
}

}  // namespace canopus::serve
