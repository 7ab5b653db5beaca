#pragma once
// A module that a built-in PLC program drives, unlike any of the five, and what the program did to it.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/can/timeline.hpp"
#include "canopus/plc/program/built_in_program.hpp"

#include "plc/fake_module.hpp"

namespace canopus::plc {

using module::ProgramInterface;
using module::ProgramRequest;
using ::testing::ElementsAre;
using testing::FakeModule;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

// Signals and words unlike those of any module.
inline constexpr unsigned ready = 9;
inline constexpr unsigned exchange = 5;
inline constexpr unsigned online = 7;
inline constexpr module::BufferAddress exchange_word = 41;
inline constexpr module::BufferAddress status_word = 43;
inline constexpr std::uint16_t initializing = 0x0200;

inline constexpr ProgramInterface signals{
    .exchange = {.kind = ProgramRequest::Kind::signal, .signal = exchange},
    .online = {.kind = ProgramRequest::Kind::signal, .signal = online},
    .ready = ready,
    .status = status_word,
    .initializing = initializing,
};
inline constexpr ProgramInterface bits{
    .exchange = {.kind = ProgramRequest::Kind::bits, .word = exchange_word, .bits = 0x0004},
    .online = {.kind = ProgramRequest::Kind::bits, .word = status_word, .bits = 0x0010},
    .status = status_word,
    .initializing = initializing,
};
inline constexpr ProgramInterface write_only{
    .exchange = {.kind = ProgramRequest::Kind::write, .word = exchange_word, .bits = 0x0001},
};

/// Takes `answer_time` for a data exchange, and notes what the program does: "12ms Y5 on".
class AnsweringModule final : public FakeModule {
 public:
  explicit AnsweringModule(const ProgramInterface& interface) : interface_(interface) {
    alarm().add_part(answer_at);
    alarm().add_part(starts_at);
  }

  void set_output(unsigned signal, bool on, can::Time now) override {
    FakeModule::set_output(signal, on, now);
    note(now, "Y" + std::to_string(signal) + (on ? " on" : " off"));
    if (program != nullptr && program->signal_changed(module::SignalKind::output, signal, on, now)) ++own;
    if (signal != interface_.exchange.signal) return;
    if (on) answer_at = now + answer_time;
    if (!on) set_input(signal, false, now);
  }
  void write_word(module::BufferAddress address, std::uint16_t value, can::Time now) override {
    if (program != nullptr && program->buffer_written(address)) ++own;
    note(now, std::to_string(address) + "=" + std::to_string(value));
    words[address] = static_cast<std::uint16_t>(address == status_word ? words[address] | value : value);
    if (address == interface_.exchange.word) answer_at = now + answer_time;
  }
  [[nodiscard]] std::uint16_t program_read(module::BufferAddress address, can::Time now) override {
    if ((words[status_word] & initializing) != 0 && address != status_word) ++wrong_reads;
    return FakeModule::program_read(address, now);
  }
  void tick(can::Time now) override {
    if (answer_at <= now) {
      answer_at = can::never;
      if (interface_.exchange.kind == ProgramRequest::Kind::signal) set_input(exchange, true, now);
      if (interface_.exchange.kind == ProgramRequest::Kind::bits) words[exchange_word] = 0;
    }
    if (starts_at <= now) {
      starts_at = can::never;
      start(now);
    }
  }

  /// Initializes until `end`.
  void initialize(can::Time now, can::Time end) {
    words[status_word] = initializing;
    if (interface_.ready) set_input(*interface_.ready, false, now);
    starts_at = end;
  }
  void start(can::Time now) {
    words[status_word] = 0;
    if (interface_.ready) set_input(*interface_.ready, true, now);
  }
  std::vector<std::string> drain_notes() { return std::exchange(notes_, {}); }

  BuiltInProgram* program = nullptr;
  can::Duration answer_time = 3ms;
  can::Alarm answer_at;
  can::Alarm starts_at;
  int own = 0;
  int wrong_reads = 0;  // of a module that initializes: its status is all there is

 private:
  void set_input(unsigned signal, bool on, can::Time now) {
    if ((x >> signal & 1U) == (on ? 1U : 0U)) return;
    x ^= 1U << signal;
    if (program != nullptr && program->signal_changed(module::SignalKind::input, signal, on, now)) ++own;
  }
  void note(can::Time now, const std::string& what) {
    notes_.push_back(std::to_string(now.time_since_epoch() / 1ms) + "ms " + what);
  }
  const ProgramInterface& interface_;
  std::vector<std::string> notes_;
};

/// The module in its slot, started at 0 and with supply, the program running.
class Slot final : public can::Participant, public RackListener {
 public:
  Slot(const ProgramInterface& interface, BuiltInProgram::Task task)
      : rack(timeline), module(interface), program(rack, head, module, interface, std::move(task)) {
    module.program = &program;
    alarm().add_part(module.alarm());
    alarm().add_part(program.alarm());
    timeline.add(*this);
    rack.insert(head, module);
    rack.add_listener(*this);
  }
  void power(can::Duration initialization = {}) {
    module.initialize(timeline.now(), timeline.now() + initialization);
    rack.power_on(timeline.now());
  }
  void supply_changed(bool on, can::Time now) override {
    program.supply_changed(on, now);
    program.update(now);
  }
  void cpu_changed(module::CpuState state, can::Time now) override {
    program.cpu_changed(state, now);
    program.update(now);
  }
  void cpu_paused(bool paused, can::Time now) override {
    program.cpu_paused(paused, now);
    program.update(now);
  }
  void run_until(can::Duration end) { timeline.run_until(can::Time{} + end); }
  std::vector<std::string> notes_until(can::Duration end) {
    run_until(end);
    return module.drain_notes();
  }

  void receive(const can::Frame&, can::Time) override {}
  void tick(can::Time now) override {
    if (module.deadline() <= now) module.tick(now);
    program.tick(now);
    program.update(now);
  }

  static constexpr std::uint16_t head = 0x20;
  can::Timeline timeline;
  Rack rack;
  AnsweringModule module;
  BuiltInProgram program;
};

}  // namespace canopus::plc
