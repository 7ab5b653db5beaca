#pragma once
// What a module reports to its CPU: lines of the event history and of module diagnostics.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "canopus/can/time.hpp"

namespace canopus::module {

/// How bad an error is [RJ71CN91 5.1].
enum class ErrorClass : std::uint8_t { minor, moderate, major };
[[nodiscard]] constexpr std::string_view name(ErrorClass error_class) noexcept {
  switch (error_class) {
    case ErrorClass::minor: return "minor";
    case ErrorClass::moderate: return "moderate";
    case ErrorClass::major: return "major";
  }
  return "unknown";
}

/// One line of the CPU's event history.
struct ModuleEventRecord {
  can::Time at{};
  std::uint16_t code = 0;  ///< 00400H ...
  std::string_view overview{};
  std::optional<std::uint32_t> detail{};
};
/// One line of module diagnostics.
struct ModuleErrorRecord {
  struct Detail {
    std::string_view name{};  ///< empty: there is none
    std::uint32_t value = 0;
  };
  can::Time at{};
  std::uint16_t code = 0;
  ErrorClass error_class{};
  std::string_view overview{};
  std::array<Detail, 2> details{};
};

}  // namespace canopus::module
