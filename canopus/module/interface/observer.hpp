#pragma once
// Who watches a module from outside: the live table, the JSON lines, a trace. Everything is reported as it
// happens, on the loop the module lives on; it returns nothing.

#include <cstdint>
#include <string_view>

#include "canopus/can/time.hpp"
#include "canopus/module/interface/module_types.hpp"

namespace canopus::manager {
struct BootRecord;
}

namespace canopus::module {

struct ModuleErrorRecord;
struct ModuleEventRecord;

class ModuleObserver {
 public:
  /// A signal changed. `number` is the offset from the head address.
  virtual void signal_changed(SignalKind /*kind*/, unsigned /*number*/, bool /*on*/, can::Time) {}
  /// The CPU's write reached the buffer memory (a refused one does not).
  virtual void buffer_written(std::uint32_t /*address*/, std::uint16_t /*value*/, can::Time) {}
  /// The module is the active NMT master, and the boot of this slave is at another step, or at another object
  /// of the same one (manager::explain() has the text).
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
