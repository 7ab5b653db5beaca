#include "canopus/sim/device/script.hpp"

#include <algorithm>
#include <bit>

#include "canopus/eds/value.hpp"

namespace canopus::sim {

namespace {

/// A value of this type as eds::less compares it.
std::uint64_t comparable(canopen::DataType type, std::uint64_t bits) noexcept {
  if (type == canopen::DataType::real32) {
    const auto value = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    return std::bit_cast<std::uint64_t>(value);
  }
  if (!canopen::is_signed(type)) return bits;
  const unsigned unused = 64U - canopen::bit_length(type);
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(bits << unused) >> unused);
}

}  // namespace

std::string_view name(Comparison comparison) noexcept {
  switch (comparison) {
    case Comparison::equal: return "==";
    case Comparison::not_equal: return "!=";
    case Comparison::less: return "<";
    case Comparison::less_or_equal: return "<=";
    case Comparison::greater: return ">";
    case Comparison::greater_or_equal: return ">=";
  }
  return "?";
}

bool Condition::holds(const canopen::ObjectDictionary& dictionary) const noexcept {
  const canopen::DataType type = entry.description->type;
  const std::uint64_t now = comparable(type, dictionary.get<std::uint64_t>(entry));
  const std::uint64_t limit = comparable(type, value);
  const bool is_less = eds::less(type, now, limit);
  const bool is_greater = eds::less(type, limit, now);
  switch (comparison) {
    case Comparison::equal: return !is_less && !is_greater;
    case Comparison::not_equal: return is_less || is_greater;
    case Comparison::less: return is_less;
    case Comparison::less_or_equal: return !is_greater;
    case Comparison::greater: return is_greater;
    case Comparison::greater_or_equal: return !is_less;
  }
  return false;
}

void Script::add(const ScriptStep& step) {
  const std::size_t number = states_.size();
  states_.push_back({.step = step});
  if (step.when) {
    conditional_.push_back(number);
    return;
  }
  const auto place = std::ranges::upper_bound(timed_, step.at, {},
                                              [this](std::size_t other) { return states_[other].step.at; });
  timed_.insert(place, number);
  set_alarm();
}

const ScriptStep* Script::next_due(can::Time now) {
  if (alarm_ > now) return nullptr;
  const ScriptStep& step = states_[timed_[next_timed_++]].step;
  set_alarm();
  return &step;
}

void Script::restart() noexcept {
  for (State& state : states_) state.held = false;
}

void Script::begin_evaluation() noexcept {
  for (State& state : states_) state.returned = false;
}

const ScriptStep* Script::next_true(const canopen::ObjectDictionary& dictionary) {
  for (const std::size_t number : conditional_) {
    State& state = states_[number];
    const bool held = state.held;
    state.held = state.step.when->holds(dictionary);
    if (!state.held || held || state.returned) continue;
    state.returned = true;
    return &state.step;
  }
  return nullptr;
}

}  // namespace canopus::sim
