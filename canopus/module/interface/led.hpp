#pragma once
// LEDs of a module as readable state: what pattern each shows, and whether it is lit at a moment [CiA 303-3].

#include <cstdint>
#include <string_view>

#include "canopus/can/time.hpp"

namespace canopus::module {

enum class LedPattern : std::uint8_t {
  off,
  on,
  flickering,    ///< 50 ms on, 50 ms off
  blinking,      ///< 200 ms on, 200 ms off
  single_flash,  ///< 200 ms on, 1000 ms off
  double_flash,  ///< 200 ms on, 200 ms off, 200 ms on, 1000 ms off
};

struct Led {
  std::string_view name{};  ///< as printed on the module
  LedPattern pattern = LedPattern::off;
  bool opposite = false;  ///< dark when the pattern is lit: two LEDs that alternate
  bool error = false;     ///< lit, it shows an error
};

[[nodiscard]] constexpr std::string_view name(LedPattern pattern) noexcept {
  switch (pattern) {
    case LedPattern::off: return "off";
    case LedPattern::on: return "on";
    case LedPattern::flickering: return "flickering";
    case LedPattern::blinking: return "blinking";
    case LedPattern::single_flash: return "single flash";
    case LedPattern::double_flash: return "double flash";
  }
  return "unknown";
}

/// All LEDs run on one time base, so that patterns begin together.
[[nodiscard]] constexpr bool is_lit(LedPattern pattern, can::Time now) noexcept {
  const auto within = [&](std::int64_t period) {
    return std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % period;
  };
  switch (pattern) {
    case LedPattern::off: return false;
    case LedPattern::on: return true;
    case LedPattern::flickering: return within(100) < 50;
    case LedPattern::blinking: return within(400) < 200;
    case LedPattern::single_flash: return within(1200) < 200;
    case LedPattern::double_flash: {
      const auto moment = within(1600);
      return moment < 200 || (moment >= 400 && moment < 600);
    }
  }
  return false;
}

[[nodiscard]] constexpr bool is_lit(const Led& led, can::Time now) noexcept {
  return is_lit(led.pattern, now) != led.opposite;
}

}  // namespace canopus::module
