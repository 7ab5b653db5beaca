#pragma once
// Watches the data exchange requests that a module gets, from any program, and reports stopped process data:
// a request that the module does not answer, because it was initializing when the request came [ME3CAN1-Q
// 3.5.5], or does not work. The only remedy is to take the request back and make it again.

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/program_interface.hpp"

namespace canopus::plc {

class ExchangeMonitor {
 public:
  /// A module answers within a millisecond or so.
  static constexpr can::Duration patience = std::chrono::seconds(1);

  /// `head`: the module's head address, for the signals' names. Module and interface must outlive the watch.
  ExchangeMonitor(module::Module& module, const module::ProgramInterface& interface, unsigned head)
      : words_(module.buffer_memory()), interface_(interface), head_(head) {}

  /// A signal change of the module. `by_program`: a request of the built-in PLC program, which repeats it
  /// after taking it back.
  void signal_changed(module::SignalKind kind, unsigned number, bool on, bool by_program, can::Time now);
  void buffer_written(module::BufferAddress address, std::uint16_t value, can::Time now);
  /// The supply went off, or the CPU stopped: no program makes requests.
  void forget() noexcept;

  /// Call it after each event that may have changed the module.
  void update(can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

  /// Something to report since the last call: one line for a person.
  [[nodiscard]] std::optional<std::string> next_report() { return std::exchange(report_, std::nullopt); }
  /// The present fault as a text for the user, once it was reported; empty: none.
  [[nodiscard]] std::string trouble(can::Time now) const;

 private:
  void requested(can::Time now);
  void answered(can::Time now);
  [[nodiscard]] bool is_initializing(can::Time now) const;
  [[nodiscard]] std::string described(can::Time now) const;

  module::BufferMemoryAccess* words_;
  const module::ProgramInterface& interface_;
  unsigned head_;
  can::Time since_{};  // of the first request that has no answer
  can::Alarm alarm_;
  bool is_open_ = false;
  bool has_initialized_ = false;  // when the request came, or was taken back
  bool was_taken_back_ = false;
  bool was_reported_ = false;
  std::optional<std::string> report_;
};

}  // namespace canopus::plc
