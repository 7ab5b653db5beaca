#pragma once
// A soft module as the PLC sees it: buffer memory words, X and Y signals, and what the CPU tells it. The rack
// (room plc) talks to every module through this; what a word or a signal does is the module's own business.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/module/data_sheet.hpp"
#include "canopus/module/observer.hpp"

namespace canopus::manager {
class NmtMaster;
}

namespace canopus::module {

/// Buffer memory address, 0..65535, in words.
using BufferAddress = std::uint32_t;

/// CPU operating state as a module sees it.
enum class CpuState : std::uint8_t { stop, run };

/// A fault that a test or a plant file gives a module.
enum class ModuleFault : std::uint8_t {
  hardware_error,  ///< the module finds its hardware faulty
  watchdog_error,  ///< its firmware hangs: it does nothing any more
};

class Module : public can::Participant {
 public:
  /// "ME3CAN1-Q"
  [[nodiscard]] virtual std::string_view model() const noexcept = 0;
  /// X and Y points it occupies, from its head address on: 32 for the ME3CAN1-Q; 0 for modules without
  /// signals.
  [[nodiscard]] virtual unsigned points() const noexcept = 0;
  /// Its line in the CPU's product list.
  [[nodiscard]] virtual ProductInformation product() const noexcept {
    return {.model = model(), .points = points()};
  }
  /// Words of buffer memory that FROM/TO and U\G may address: 0..buffer_memory_size()-1.
  [[nodiscard]] virtual BufferAddress buffer_memory_size() const noexcept = 0;

  /// What FROM reads. `address` < buffer_memory_size().
  [[nodiscard]] virtual std::uint16_t read_word(BufferAddress address, can::Time now) = 0;
  /// What TO writes. A write that the module refuses changes nothing but its error words; the PLC does not
  /// hear of it.
  virtual void write_word(BufferAddress address, std::uint16_t value, can::Time now) = 0;

  /// X signals, bit n = X(head+n).
  [[nodiscard]] virtual std::uint32_t inputs() const noexcept = 0;
  /// Y signals as the module sees them, bit n = Y(head+n).
  [[nodiscard]] virtual std::uint32_t outputs() const noexcept = 0;
  /// Sets one Y signal, 0 <= signal < points(). Edges and levels act at once.
  virtual void set_output(unsigned signal, bool on, can::Time now) = 0;

  /// The PLC's supply comes on: the module starts as from the shelf, with what its non-volatile memory holds.
  virtual void power_on(can::Time now) = 0;
  virtual void power_off(can::Time now) = 0;
  /// The CPU has an error that stops it; cpu_changed(CpuState::stop) follows if it was in RUN.
  virtual void cpu_failed(can::Time /*now*/) {}
  /// From now on, until the supply goes off, the module has this fault. Modules without supply have none.
  virtual void inject(ModuleFault /*fault*/, can::Time /*now*/) {}
  /// The CPU changed between RUN and STOP.
  virtual void cpu_changed(CpuState state, can::Time now) = 0;

  /// The NMT master inside, to look at: active or not, and why a slave is stuck (boot_record()). nullptr:
  /// none.
  [[nodiscard]] virtual const manager::NmtMaster* master() const noexcept { return nullptr; }

  /// Who is told of signals, writes and errors from now on; nullptr = nobody. It must outlive the module or
  /// be taken out.
  virtual void set_observer(ModuleObserver* observer) = 0;
};

/// Where a module keeps what must survive power-off. Named blobs, written whole; a write is done or not done,
/// never half (room store implements it; tests use memory).
class NonVolatileMemory {
 public:
  virtual ~NonVolatileMemory() = default;
  /// Content of `name`. Empty optional: never written. A damaged content is reported once as such.
  struct Content {
    enum class State : std::uint8_t { missing, good, damaged } state = State::missing;
    std::vector<std::uint8_t> bytes;
  };
  [[nodiscard]] virtual Content read(std::string_view name) = 0;
  /// False when the medium failed; the old content is still there then.
  virtual bool write(std::string_view name, std::span<const std::uint8_t> bytes) = 0;
  virtual bool erase(std::string_view name) = 0;
};

}  // namespace canopus::module
