#pragma once
// Who watches a module from outside: the live table, the JSON lines, a trace. Everything is reported as it
// happens, on the loop the module lives on; nothing is asked back.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "canopus/can/time.hpp"
#include "canopus/manager/boot/boot_record.hpp"

namespace canopus::module {

/// Direction of a signal, as the CPU names it.
enum class SignalKind : std::uint8_t {
  input,   ///< X: module to CPU
  output,  ///< Y: CPU to module
};

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

class ModuleObserver {
 public:
  /// A signal changed. `number` is the offset from the head address.
  virtual void signal_changed(SignalKind /*kind*/, unsigned /*number*/, bool /*on*/, can::Time) {}
  /// The CPU's write reached the buffer memory (a refused one does not).
  virtual void buffer_written(std::uint32_t /*address*/, std::uint16_t /*value*/, can::Time) {}
  /// The module is the active NMT master, and the boot of this slave is at another step, or at another object
  /// of the same one (manager::explain() says it in words).
  virtual void slave_boot_went_on(std::uint8_t /*node_id*/, const manager::BootRecord&, can::Time) {}
  /// The module found something wrong: one line for a person ("G24 = 300: not a baud rate").
  virtual void error_raised(std::string_view /*what*/, can::Time) {}
  /// The module reported an event to the CPU's event history.
  virtual void event_logged(const ModuleEventRecord&) {}
  /// Module diagnostics show this error from now on.
  virtual void module_error(const ModuleErrorRecord&) {}

 protected:
  ~ModuleObserver() = default;
};

}  // namespace canopus::module
