#pragma once
// Generated values of a simulated device, in place of the machine around it.
//
// A value is a pure function of the time and the seed, so two runs with one seed are byte-identical,
// independent of how often a device is sampled, and no state has to be saved.

#include <cstdint>
#include <optional>
#include <string_view>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::sim {

/// One moving value, named by its object.
struct Behaviour {
  enum class Kind : std::uint8_t {
    constant,  ///< `low`, always
    sine,      ///< from low to high and back in one period, starting at the middle, rising
    ramp,      ///< from low to high in one period, then low again
    counter,   ///< low, low + step, ... up to high, then low again; one step per period
    noise,     ///< evenly spread over low..high, a new value every period
    echo,      ///< what the source object holds (times 1; `low`..`high` do not apply)
  };
  Kind kind = Kind::constant;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  double low = 0;                                  ///< in the object's own units
  double high = 0;                                 ///< in the object's own units, >= low
  can::Duration period = std::chrono::seconds(1);  ///< > 0
  double step = 1;                                 ///< counter
  std::uint64_t seed = 0;                          ///< noise
  std::uint16_t source_index = 0;                  ///< echo
  std::uint8_t source_sub = 0;                     ///< echo
};

/// The kind of this name ("sine"), or nothing.
[[nodiscard]] std::optional<Behaviour::Kind> behaviour_kind(std::string_view name) noexcept;
[[nodiscard]] std::string_view name(Behaviour::Kind kind) noexcept;

/// The value at this moment, before it is fitted into an object's type. 0 for echo.
[[nodiscard]] double value_at(const Behaviour& behaviour, can::Time now) noexcept;

/// The first moment after `now` at which the value, fitted into this type, may be another one than at `now`, where
/// it is `value`, not yet fitted. Perhaps too early, never too late; can::never: it stays, or it is an echo.
[[nodiscard]] can::Time next_change(const Behaviour& behaviour, canopen::DataType type, double value,
                                    can::Time now) noexcept;

/// The range of an object: bit patterns of its type, 64 bits wide, of a real as REAL64.
struct Bounds {
  canopen::DataType type = canopen::DataType::unsigned8;
  std::uint64_t low = 0;
  std::uint64_t high = 0;
};
/// Of a type, and of the object's limits within it.
[[nodiscard]] Bounds bounds(canopen::DataType type, const canopen::Limits& limits) noexcept;

/// `value`, rounded and limited to what the object can hold, as the type's bit pattern.
[[nodiscard]] std::uint64_t fitted(double value, const Bounds& bounds) noexcept;
[[nodiscard]] inline std::uint64_t fitted(double value, canopen::DataType type,
                                          const canopen::Limits& limits) noexcept {
  return fitted(value, bounds(type, limits));
}

/// A fitted value, and the moment of next_change().
struct Sample {
  std::uint64_t value = 0;
  can::Time next_change{};
};

/// The phase of a behaviour at a moment.
struct Phase {
  can::Duration::rep number = 0;  ///< of the period, from 0
  can::Duration into{};           ///< since the period began
  std::uint64_t steps = 1;        ///< of a counter, until it begins again
  std::uint64_t step = 0;         ///< number, modulo steps
};

/// The values of one behaviour in one object. The result depends on the behaviour, the object and the moment alone; what the
/// generator keeps is the period of the last moment, as the same one, or the next one, is found without a division.
class ValueGenerator {
 public:
  ValueGenerator(const Behaviour& behaviour, const Bounds& bounds) noexcept;

  [[nodiscard]] const Behaviour& behaviour() const noexcept { return behaviour_; }
  /// Its value, fitted into the object, and next_change().
  [[nodiscard]] Sample at(can::Time now) noexcept {
    can::Duration into = now.time_since_epoch() - phase_.number * period_;
    const bool is_next = into >= period_;
    if (is_next) into -= period_;
    if (!counts_whole_numbers_ || into < can::Duration{} || into >= period_) return at_any_phase(now);
    if (is_next) enter_next_period();
    return {whole_value(), can::later(now, period_ - into)};
  }

 private:
  [[nodiscard]] Sample at_any_phase(can::Time now) noexcept;
  void enter_next_period() noexcept {
    ++phase_.number;
    phase_.step = phase_.step + 1 == phase_.steps ? 0 : phase_.step + 1;
  }
  void find_whole_numbers() noexcept;
  [[nodiscard]] std::uint64_t whole_value() const noexcept {
    return static_cast<std::uint64_t>(first_ + static_cast<std::int64_t>(phase_.step) * step_);
  }

  can::Duration period_;
  Phase phase_{};
  // A counter of whole numbers that the object can hold without exception.
  bool counts_whole_numbers_ = false;
  std::int64_t first_ = 0;
  std::int64_t step_ = 0;
  Behaviour behaviour_;
  Bounds bounds_;
};

}  // namespace canopus::sim
