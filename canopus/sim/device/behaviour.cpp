#include "canopus/sim/device/behaviour.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "canopus/eds/value.hpp"

namespace canopus::sim {
namespace {

using canopen::DataType;

constexpr std::pair<Behaviour::Kind, std::string_view> kind_names[] = {
    {Behaviour::Kind::constant, "constant"}, {Behaviour::Kind::sine, "sine"},
    {Behaviour::Kind::ramp, "ramp"},         {Behaviour::Kind::counter, "counter"},
    {Behaviour::Kind::noise, "noise"},       {Behaviour::Kind::echo, "echo"}};

/// A well mixed number for every input: Steele, Lea and Flood's splitmix64.
constexpr std::uint64_t mixed(std::uint64_t x) noexcept {
  x += 0x9E37'79B9'7F4A'7C15;
  x = (x ^ (x >> 30)) * 0xBF58'476D'1CE4'E5B9;
  x = (x ^ (x >> 27)) * 0x94D0'49BB'1331'11EB;
  return x ^ (x >> 31);
}

/// A whole number within low..high, which are the type's own bounds: no rounding beyond them.
template <typename T>
std::uint64_t whole(double value, std::uint64_t low, std::uint64_t high) noexcept {
  const auto lowest = static_cast<T>(low);
  const auto highest = static_cast<T>(high);
  if (!(value > static_cast<double>(lowest))) return low;
  if (!(value < static_cast<double>(highest))) return high;
  const auto cut = static_cast<T>(value);
  if (static_cast<double>(cut) == value) return static_cast<std::uint64_t>(cut);  // as counters have it
  return static_cast<std::uint64_t>(std::clamp(static_cast<T>(std::nearbyint(value)), lowest, highest));
}

/// Of a counter, until it begins again.
std::uint64_t steps_of(const Behaviour& behaviour) noexcept {
  const double steps = std::floor((behaviour.high - behaviour.low) / behaviour.step) + 1;
  if (!(behaviour.step > 0) || !(steps >= 1)) return 1;
  constexpr double exact = 1ULL << 53;  // below it, whole numbers are the same as doubles
  return steps < exact ? static_cast<std::uint64_t>(steps) : std::uint64_t{1} << 63;
}

can::Duration period_of(const Behaviour& behaviour) noexcept {
  return std::max(behaviour.period, can::Duration{1});
}

Phase phase_at(const Behaviour& behaviour, can::Time now) noexcept {
  const can::Duration period = period_of(behaviour);
  const can::Duration::rep number = now.time_since_epoch() / period;
  const std::uint64_t steps = steps_of(behaviour);
  return {.number = number,
          .into = now.time_since_epoch() - number * period,
          .steps = steps,
          .step = static_cast<std::uint64_t>(number) % steps};
}

double value_in(const Behaviour& behaviour, const Phase& phase) noexcept {
  const auto share = [&] {
    return static_cast<double>(phase.into.count()) / static_cast<double>(period_of(behaviour).count());
  };
  const double span = behaviour.high - behaviour.low;
  switch (behaviour.kind) {
    case Behaviour::Kind::constant: return behaviour.low;
    case Behaviour::Kind::sine:
      return behaviour.low + span * (0.5 + 0.5 * std::sin(2 * std::numbers::pi * share()));
    case Behaviour::Kind::ramp: return behaviour.low + span * share();
    case Behaviour::Kind::counter: {
      if (!(behaviour.step > 0)) return behaviour.low;
      return behaviour.low + static_cast<double>(phase.step) * behaviour.step;
    }
    case Behaviour::Kind::noise: {
      const std::uint64_t random = mixed(mixed(behaviour.seed) ^ static_cast<std::uint64_t>(phase.number));
      return behaviour.low + span * (static_cast<double>(random >> 11) / 0x1FFFFFFFFFFFFFp0);
    }
    case Behaviour::Kind::echo: return 0;
  }
  return 0;
}

can::Time change_after(const Behaviour& behaviour, DataType type, double value, can::Time now,
                       const Phase& phase) noexcept {
  using Kind = Behaviour::Kind;
  if (behaviour.kind == Kind::constant || behaviour.kind == Kind::echo) return can::never;
  const can::Duration period = period_of(behaviour);
  const can::Time next_period = can::later(now, period - phase.into);
  if (behaviour.kind == Kind::counter || behaviour.kind == Kind::noise) return next_period;
  const double span = behaviour.high - behaviour.low;
  if (!(span > 0)) return can::never;
  const can::Time soon = can::later(now, can::Duration{1});
  if (type == DataType::real32 || type == DataType::real64 || !std::isfinite(span)) return soon;
  // A whole number changes where the value passes the middle between two; how long that takes at least follows
  // from the steepest slope. What rounding does to the value is far below the part that is left out.
  const double way = 0.5 - std::abs(value - std::nearbyint(value));
  const double steepest = span * (behaviour.kind == Kind::sine ? std::numbers::pi : 1.0);
  const double safe_way = way * 0.99 - (std::abs(behaviour.low) + std::abs(behaviour.high)) * 1e-9;
  const double nanoseconds = safe_way / steepest * static_cast<double>(period.count());
  if (!(nanoseconds >= 1)) return soon;
  const bool is_long = nanoseconds >= static_cast<double>(period.count());
  const can::Time passed = is_long
                               ? can::later(now, period)
                               : can::later(now, can::Duration(static_cast<can::Duration::rep>(nanoseconds)));
  return behaviour.kind == Kind::ramp ? std::min(passed, next_period) : passed;  // a ramp falls at its end
}

}  // namespace

std::optional<Behaviour::Kind> behaviour_kind(std::string_view name) noexcept {
  for (const auto& [kind, known] : kind_names) {
    if (known == name) return kind;
  }
  return std::nullopt;
}

std::string_view name(Behaviour::Kind kind) noexcept {
  for (const auto& [known, word] : kind_names) {
    if (known == kind) return word;
  }
  return "unknown";
}

double value_at(const Behaviour& behaviour, can::Time now) noexcept {
  return value_in(behaviour, phase_at(behaviour, now));
}

can::Time next_change(const Behaviour& behaviour, DataType type, double value, can::Time now) noexcept {
  return change_after(behaviour, type, value, now, phase_at(behaviour, now));
}

Bounds bounds(DataType type, const canopen::Limits& limits) noexcept {
  if (type == DataType::real32 || type == DataType::real64) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    return {type, limits.low.value_or(std::bit_cast<std::uint64_t>(-infinite)),
            limits.high.value_or(std::bit_cast<std::uint64_t>(infinite))};
  }
  const eds::Range of_type = eds::range(type);
  return {type, limits.low.value_or(of_type.low), limits.high.value_or(of_type.high)};
}

std::uint64_t fitted(double value, const Bounds& bounds) noexcept {
  const DataType type = bounds.type;
  if (std::isnan(value)) value = 0;
  if (type == DataType::boolean) return value >= 0.5 ? 1 : 0;
  if (type == DataType::real32 || type == DataType::real64) {
    value = std::max(value, std::bit_cast<double>(bounds.low));
    value = std::min(value, std::bit_cast<double>(bounds.high));
    if (type == DataType::real64) return std::bit_cast<std::uint64_t>(value);
    return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  }
  return canopen::is_signed(type) ? whole<std::int64_t>(value, bounds.low, bounds.high)
                                  : whole<std::uint64_t>(value, bounds.low, bounds.high);
}

ValueGenerator::ValueGenerator(const Behaviour& behaviour, const Bounds& bounds) noexcept
    : period_(period_of(behaviour)), behaviour_(behaviour), bounds_(bounds) {
  phase_.steps = steps_of(behaviour);
  find_whole_numbers();
}

void ValueGenerator::find_whole_numbers() noexcept {
  using enum DataType;
  if (behaviour_.kind != Behaviour::Kind::counter || !(behaviour_.step > 0)) return;
  if (bounds_.type == boolean || bounds_.type == real32 || bounds_.type == real64) return;
  constexpr double exact = 1ULL << 53;
  const auto is_whole = [](double number) {
    return std::abs(number) < exact && std::trunc(number) == number;
  };
  const double last = behaviour_.low + static_cast<double>(phase_.steps - 1) * behaviour_.step;
  if (!is_whole(behaviour_.low) || !is_whole(behaviour_.step) || !is_whole(last)) return;
  const auto is_held = [this](double number) {
    const std::uint64_t bits = fitted(number, bounds_);
    return number == (canopen::is_signed(bounds_.type) ? static_cast<double>(static_cast<std::int64_t>(bits))
                                                       : static_cast<double>(bits));
  };
  if (!is_held(behaviour_.low) || !is_held(last)) return;
  counts_whole_numbers_ = true;
  first_ = static_cast<std::int64_t>(behaviour_.low);
  step_ = static_cast<std::int64_t>(behaviour_.step);
}

Sample ValueGenerator::at_any_phase(can::Time now) noexcept {
  phase_.into = now.time_since_epoch() - phase_.number * period_;
  if (phase_.into >= period_ && phase_.into - period_ < period_) {
    enter_next_period();
    phase_.into -= period_;
  } else if (phase_.into < can::Duration{} || phase_.into >= period_) {
    phase_.number = now.time_since_epoch() / period_;
    phase_.into = now.time_since_epoch() - phase_.number * period_;
    phase_.step = static_cast<std::uint64_t>(phase_.number) % phase_.steps;
  }
  if (counts_whole_numbers_) return {whole_value(), can::later(now, period_ - phase_.into)};
  const double value = value_in(behaviour_, phase_);
  return {fitted(value, bounds_), change_after(behaviour_, bounds_.type, value, now, phase_)};
}

}  // namespace canopus::sim
