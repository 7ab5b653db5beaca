#pragma once
// The scenario language: what a PLC program, the bus and time do to a module, step by step, and what must be
// seen after each step. It reads like spec/<module>/scenarios.md:
//
//   Scenario s;                                  // a module on a bus of its own, off
//   s.power_on();                                // and initialized
//   s.write(21, 100);                            // G21=100
//   s.expect(29, 0x0040).expect_x(0x0F, true);   // G29 -> 0040H, X0F -> 1
//   s.rx(0x000, {0x01, 0x01});                   // another node sends
//   s.tx(0x181, {0x11, 0x11});                   // the next frame the module has sent
//   s.cif({0x0004, 0, 0x1000, 0});               // command words, Y17, X17
//
// A step that fails says where in the test, at what time, and in which step; the scenario goes on. Frames are
// taken in the order they were sent; a frame sent but not taken is reported at the end unless ignore_tx()
// said it does not matter.

#include <cstdint>
#include <deque>
#include <initializer_list>
#include <map>
#include <optional>
#include <source_location>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopus/can/controller.hpp"
#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/non_volatile_memory.hpp"

namespace canopus::scenario {

using namespace std::chrono_literals;
using Where = std::source_location;
using Words = std::vector<std::uint16_t>;
using Bytes = std::vector<std::uint8_t>;

/// Non-volatile memory in RAM. It outlives the modules that use it.
class RamMemory final : public module::NonVolatileMemory {
 public:
  Content read(std::string_view name) override;
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override;
  bool erase(std::string_view name) override;

  std::map<std::string, Content, std::less<>> blobs;
  bool writable = true;
  unsigned writes = 0;
};

/// A controller whose bus is always free: a frame is on the wire the moment it is sent.
class FreeBus final : public can::Controller {
 public:
  bool send(const can::Frame& frame) override;
  std::uint16_t transmit_error_counter() const override { return transmit_errors; }
  std::uint16_t receive_error_counter() const override { return receive_errors; }
  can::ErrorState error_state() const override;
  std::uint32_t bit_rate() const override { return rate; }
  void restart(std::uint32_t bit_rate) override;
  std::uint32_t transmit_overflows() const override { return overflows; }
  bool has_room() const override { return accepts; }
  std::uint32_t receive_overflows() const override { return lost; }

  std::uint16_t transmit_errors = 0;
  std::uint16_t receive_errors = 0;
  std::uint32_t rate = 0;
  std::uint32_t overflows = 0;
  std::uint32_t lost = 0;              // received frames
  bool accepts = true;                 // false: every send() overflows
  bool completes = true;               // false: frames wait for an acknowledgement for ever
  std::deque<can::Frame> sent;         // not yet looked at by the test
  std::vector<can::Frame> completing;  // transmitted() not yet told
};

/// The scenario of one module of any kind. Signal numbers are offsets from the head address.
class ModuleScenario {
 public:
  ModuleScenario(module::Module& module, FreeBus& bus)
      : module_(&module), words_(module.buffer_memory()), signals_(module.signals()), bus_(&bus) {}
  virtual ~ModuleScenario();
  ModuleScenario(const ModuleScenario&) = delete;
  ModuleScenario& operator=(const ModuleScenario&) = delete;

  // --- the PLC program
  ModuleScenario& write(module::BufferAddress address, std::uint16_t value);
  /// Consecutive words.
  ModuleScenario& write(module::BufferAddress first, const Words& values);
  ModuleScenario& y(unsigned number, bool on);
  [[nodiscard]] std::uint16_t read(module::BufferAddress address) {
    return words_->program_read(address, now_);
  }
  [[nodiscard]] bool x(unsigned number) const { return (signals_->inputs() >> number & 1U) != 0; }

  ModuleScenario& expect(module::BufferAddress address, std::uint16_t value, Where where = Where::current());
  /// Consecutive words.
  ModuleScenario& expect(module::BufferAddress first, const Words& values, Where where = Where::current());
  ModuleScenario& expect_bit(module::BufferAddress address, unsigned bit, bool on,
                             Where where = Where::current());
  ModuleScenario& expect_x(unsigned number, bool on, Where where = Where::current());
  /// Lets time pass until the signal is as wanted.
  ModuleScenario& wait_x(unsigned number, bool on, can::Duration at_most = 20s,
                         Where where = Where::current());
  /// Lets time pass until the bit is as wanted.
  ModuleScenario& wait_bit(module::BufferAddress address, unsigned bit, bool on, can::Duration at_most = 20s,
                           Where where = Where::current());

  // --- the bus
  /// Another node sends.
  ModuleScenario& rx(std::uint32_t identifier, const Bytes& bytes = {});
  ModuleScenario& rx_remote(std::uint32_t identifier, std::uint8_t dlc = 0);
  /// Any frame, with a 29-bit identifier for one.
  ModuleScenario& rx(const can::Frame& frame);
  /// The next frame the module has sent and nobody has looked at.
  ModuleScenario& tx(std::uint32_t identifier, const Bytes& bytes = {}, Where where = Where::current());
  ModuleScenario& tx(const can::Frame& frame, Where where = Where::current());
  ModuleScenario& tx_remote(std::uint32_t identifier, Where where = Where::current());
  /// Lets time pass until the module sends, then as tx().
  ModuleScenario& wait_tx(std::uint32_t identifier, const Bytes& bytes = {}, can::Duration at_most = 20s,
                          Where where = Where::current());
  /// The module has sent nothing more.
  ModuleScenario& no_tx(Where where = Where::current());
  /// Frames sent so far do not matter.
  ModuleScenario& ignore_tx();
  /// The controller's counters are these now.
  ModuleScenario& error_counters(std::uint16_t transmit, std::uint16_t receive);

  // --- time, supply, CPU
  ModuleScenario& advance(can::Duration duration);
  [[nodiscard]] can::Time now() const { return now_; }
  ModuleScenario& supply_on();
  ModuleScenario& supply_off();
  ModuleScenario& cpu(module::CpuState state);

 protected:
  void failed(const Where& where, const std::string& what) const;

  module::Module* module_;
  module::BufferMemoryAccess* words_;  // nullptr: the module has none; likewise
  module::SignalAccess* signals_;
  FreeBus* bus_;
  can::Time now_{};

 private:
  void settle();
  void step_to(can::Time end);
  template <typename Condition>
  bool run_until(Condition condition, can::Duration at_most);
  void expect_frame(const can::Frame& expected, const Where& where);

  unsigned steps_ = 0;
};

/// Text of a frame: "181 [11 22]", "701 RTR".
[[nodiscard]] std::string text(const can::Frame& frame);

}  // namespace canopus::scenario
