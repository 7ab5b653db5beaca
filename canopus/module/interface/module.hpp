#pragma once
// A soft module as the PLC sees it: its supply, what the CPU reports to it, and what a program reaches it by. The
// rack (room plc) talks to every module through this; what a word or a signal does is the module's own business.
//
// Not every module has everything. Buffer memory, signals and registers are interfaces of their own; a module
// without one of them answers nullptr. The answer holds for the module's life.

#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/can/controller.hpp"
#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/module_types.hpp"

namespace canopus::module {

class ModuleObserver;

/// Buffer memory as a program reaches it.
class BufferMemoryAccess {
 public:
  /// Words that FROM/TO and U\G may address: 0..buffer_memory_size()-1.
  [[nodiscard]] virtual BufferAddress buffer_memory_size() const noexcept = 0;
  /// What the word holds, without any effect: for displays, monitors and tools. `address` < buffer_memory_size().
  [[nodiscard]] virtual std::uint16_t peek(BufferAddress address, can::Time now) const = 0;
  /// FROM of the program. It may have effects: it is an access for the watchdog [FX3U-CAN 6.9], and there are words whose reading is
  /// a request. For the rack and the built-in program alone.
  [[nodiscard]] virtual std::uint16_t program_read(BufferAddress address, can::Time now) {
    return peek(address, now);
  }
  /// What TO writes. A write that the module refuses changes nothing but its error words; the PLC is not notified.
  virtual void write_word(BufferAddress address, std::uint16_t value, can::Time now) = 0;
  /// A FROM or TO of the program, or an access that stands for one, is over: so many words from `first` on. Modules
  /// that watch the program retrigger their watchdog [FX3U-CAN 6.9, FX2N-32CAN 4.2.5]; what others read for
  /// people is none.
  virtual void accessed(BufferAddress /*first*/, std::uint32_t /*words*/, can::Time /*now*/) {}

 protected:
  ~BufferMemoryAccess() = default;
};

/// X and Y signals, 0 <= number < points(), up to 32 each.
class SignalAccess {
 public:
  /// X signals, bit n = X(head+n).
  [[nodiscard]] virtual std::uint32_t inputs() const noexcept = 0;
  /// Y signals as the module sees them, bit n = Y(head+n).
  [[nodiscard]] virtual std::uint32_t outputs() const noexcept = 0;
  /// Sets one Y signal. Edges and levels act at once.
  virtual void set_output(unsigned signal, bool on, can::Time now) = 0;

 protected:
  ~SignalAccess() = default;
};

/// Kinds of registers of a CPU.
enum class RegisterKind : std::uint8_t {
  data,     ///< D
  special,  ///< SR
};
struct RegisterRange {
  RegisterKind kind = RegisterKind::data;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// Registers of the CPU that are the module's: a program that uses them reaches the module [AS-FCOPM 10.1.2].
class RegisterAccess {
 public:
  /// Which ones they are; they do not overlap.
  [[nodiscard]] virtual std::span<const RegisterRange> registers() const noexcept = 0;
  /// 0 for a register that is not the module's.
  [[nodiscard]] virtual std::uint16_t read_register(RegisterKind kind, std::uint32_t number,
                                                    can::Time now) = 0;
  virtual void write_register(RegisterKind kind, std::uint32_t number, std::uint16_t value,
                              can::Time now) = 0;

 protected:
  ~RegisterAccess() = default;
};

class Module : public can::Participant {
 public:
  /// "ME3CAN1-Q"
  [[nodiscard]] virtual std::string_view model() const noexcept = 0;
  /// X and Y points it occupies, from its head address on: 32 for the ME3CAN1-Q. A module may occupy points and
  /// have no signals.
  [[nodiscard]] virtual unsigned points() const noexcept = 0;
  /// Its line in the CPU's product list.
  [[nodiscard]] virtual ProductInformation product() const noexcept {
    return {.model = model(), .points = points()};
  }

  /// A program sees it in the status words, and in those of its slaves.
  [[nodiscard]] virtual StartUp start_up() const noexcept { return StartUp::none; }

  [[nodiscard]] virtual BufferMemoryAccess* buffer_memory() noexcept { return nullptr; }
  [[nodiscard]] virtual SignalAccess* signals() noexcept { return nullptr; }
  [[nodiscard]] virtual RegisterAccess* registers() noexcept { return nullptr; }

  /// The PLC's supply comes on: the module starts, with what its non-volatile memory holds.
  virtual void power_on(can::Time now) = 0;
  virtual void power_off(can::Time now) = 0;
  /// The CPU has an error that stops it; cpu_changed(CpuState::stop) follows if it was in RUN.
  virtual void cpu_failed(can::Time /*now*/) {}
  /// From now on, until the supply goes off, the module has this fault. Modules without supply have none.
  virtual void inject(ModuleFault /*fault*/, can::Time /*now*/) {}
  /// The CPU changed between RUN and STOP.
  virtual void cpu_changed(CpuState state, can::Time now) = 0;

  /// The receiver of reports of signals, writes and errors from now on; nullptr: none. It must outlive the module
  /// or be taken out.
  virtual void set_observer(ModuleObserver* observer) = 0;
};

}  // namespace canopus::module
