#pragma once
// Values that move by themselves in a simulated device: what stands for the machine around it.
//
// A value is a pure function of the time and the seed, so two runs with one seed are byte-identical, however
// often a device is looked at, and no state has to be saved.

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

/// The period of a behaviour that was looked at last: the same one, or the next one, is found without a division.
struct SampleCursor {
  can::Duration::rep number = 0;  ///< of the period
  std::uint64_t steps = 0;        ///< of a counter; 0: not worked out yet
  std::uint64_t step = 0;         ///< number, modulo steps
  /// A counter of whole numbers that all fit into the object: they are worked out as such.
  bool is_whole = false;
  std::int64_t whole_low = 0;
  std::int64_t whole_step = 0;

  void go_to_next_period() noexcept {
    ++number;
    step = step + 1 == steps ? 0 : step + 1;
  }
  /// Of a counter that is_whole, as the object's bit pattern.
  [[nodiscard]] std::uint64_t whole_value() const noexcept {
    return static_cast<std::uint64_t>(whole_low + static_cast<std::int64_t>(step) * whole_step);
  }
};

/// What an object can hold: bit patterns of its type, 64 bits wide, of a real as REAL64.
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

/// The value as fitted() gives it, and next_change().
struct Sample {
  std::uint64_t value = 0;
  can::Time next_change{};
};
/// sample_at() of any behaviour, at any moment.
[[nodiscard]] Sample sample_anywhere(const Behaviour& behaviour, const Bounds& bounds, can::Time now,
                                     SampleCursor& place) noexcept;
/// `place` is of this behaviour alone, at first as it is made.
[[nodiscard]] inline Sample sample_at(const Behaviour& behaviour, const Bounds& bounds, can::Time now,
                                      SampleCursor& place) noexcept {
  const can::Duration period = behaviour.period;
  can::Duration into = now.time_since_epoch() - place.number * period;
  const bool is_next = into >= period;
  if (is_next) into -= period;
  if (!place.is_whole || into < can::Duration{} || into >= period)
    return sample_anywhere(behaviour, bounds, now, place);
  if (is_next) place.go_to_next_period();
  return {place.whole_value(), can::later(now, period - into)};
}

}  // namespace canopus::sim
