#pragma once
// The built-in PLC program, for a PLC that has none: it asks a communication module for a data exchange again
// and again, and after each start of the module writes words and takes it into Layer 2 online mode. What to
// set and what to wait for it takes from the module's ProgramInterface.

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopus/module/module.hpp"
#include "canopus/module/program_interface.hpp"

namespace canopus::plc {

class BuiltInProgram {
 public:
  struct Word {
    module::BufferAddress address = 0;
    std::uint16_t value = 0;
  };
  struct Task {
    std::optional<can::Duration> exchange{};  ///< how often to ask for a data exchange
    std::vector<Word> words{};                ///< written in this order after each start of the module
    bool online = false;                      ///< Layer 2 online after that
  };

  /// Module and interface must outlive the program.
  BuiltInProgram(module::Module& module, const module::ProgramInterface& interface, Task task);

  /// The module has supply: the program runs from now on.
  void powered(can::Time now);
  /// To be called whenever something may have happened to the module.
  void look(can::Time now);
  /// What is due; look() is to follow.
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept;

  /// To be told what the module's observer hears. True: it belongs to a data exchange of the program's own.
  bool signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now);
  [[nodiscard]] bool buffer_written(module::BufferAddress address) const noexcept;

 private:
  using Kind = module::ProgramRequest::Kind;

  [[nodiscard]] bool has_set_up() const noexcept { return task_.online || !task_.words.empty(); }
  [[nodiscard]] bool is_initializing(can::Time now);
  [[nodiscard]] bool may_exchange(can::Time now);
  [[nodiscard]] bool bits_are_set(const module::ProgramRequest& request, can::Time now);
  void request_exchange(can::Time now);
  void exchange_done(can::Time now);
  void set_online(bool on, can::Time now);
  void set_up(can::Time now);

  module::BufferMemoryAccess* words_;  // nullptr: the module has none; likewise
  module::SignalAccess* signals_;
  const module::ProgramInterface& interface_;
  Task task_;
  can::Duration interval_;               // of data exchanges
  can::Time next_request_ = can::never;  // or the end of one by signals
  can::Time next_scan_ = can::never;     // of a module that has no signal to say that it starts anew
  can::Time requested_at_{};
  bool is_on_ = false;
  bool was_ready_ = false;      // as set_up() saw it last
  bool is_requested_ = false;   // the answer to a request is awaited
  bool owns_signal_ = false;    // until X of the data exchange is OFF again
  bool is_requesting_ = false;  // the request's bits are being written
};

}  // namespace canopus::plc
