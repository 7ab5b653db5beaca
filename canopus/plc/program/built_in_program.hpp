#pragma once
// The built-in PLC program: runs in a CPU that has no other. It requests data exchanges of a communication
// module cyclically, and after each start of the module writes words and takes it into Layer 2 online mode.
// The module's ProgramInterface defines the signals to set and to wait for. The program runs while the CPU is
// in RUN, and sets Y in the CPU's memory, visible to all clients.
//
// With `recover` it does what a manual demands of a program [ME3CAN1-Q 3.3.2, 3.5.5, 4.7, 4.8.8]:
// - A module that initializes takes no requests, and one that was made meanwhile is never answered. So it
//   monitors G25.7 continuously, takes its request back, and repeats it afterwards. Also when an answer does
//   not come within answer_time.
// - The CPU's STOP takes the module out of Operational, and RUN does not bring it back. So after RUN the
//   active NMT master's program requests the start of its own node: 05H to 1F82H.
// Without it, as in many real programs, it does neither: process data may stop until a client restarts them.

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/program_interface.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc {

class BuiltInProgram {
 public:
  /// An answer that has not come by then does not come any more.
  static constexpr can::Duration answer_time = std::chrono::milliseconds(500);

  struct Word {
    module::BufferAddress address = 0;
    std::uint16_t value = 0;
  };
  struct Task {
    std::optional<can::Duration> exchange{};  ///< how often to ask for a data exchange
    /// Written in this order after each start of the module; a command that a word executes ends before the next one.
    std::vector<Word> words{};
    bool online = false;  ///< Layer 2 online after that
    bool recover = true;
  };

  /// For the module at this head address of the rack, inserted now or later. Rack, module and interface must
  /// outlive the program.
  BuiltInProgram(Rack& rack, std::uint16_t head, module::Module& module,
                 const module::ProgramInterface& interface, Task task);

  /// The supply came: the program begins, if the CPU is in RUN. Or it went.
  void supply_changed(bool on, can::Time now);
  /// STOP: the program stops; RUN: it continues.
  void cpu_changed(module::CpuState state, can::Time now);
  /// PAUSE: the program stops, Y keep their state; afterwards it continues at the same point.
  void cpu_paused(bool paused, can::Time now);
  /// Call it after each event that may have changed the module.
  void update(can::Time now);
  /// Executes what is due. The caller calls update() next.
  void tick(can::Time now);
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

  /// Called for each signal change that the module's observer gets. True: it belongs to a data exchange of
  /// the program itself.
  bool signal_changed(module::SignalKind kind, unsigned number, bool on, can::Time now);
  [[nodiscard]] bool buffer_written(module::BufferAddress address) const noexcept;

 private:
  using Kind = module::ProgramRequest::Kind;
  enum class Exchange : std::uint8_t {
    idle,       ///< until next_request_
    requested,  ///< until the answer
    answered,   ///< the signal's request goes OFF at next_request_
  };
  /// Start of the own node, after STOP and RUN.
  enum class NodeStart : std::uint8_t { none, wanted, requested };

  [[nodiscard]] bool has_set_up() const noexcept { return task_.online || !task_.words.empty(); }
  [[nodiscard]] bool is_initializing(can::Time now);
  [[nodiscard]] bool is_ready(can::Time now);
  [[nodiscard]] bool may_exchange(can::Time now);
  [[nodiscard]] bool bits_are_set(const module::ProgramRequest& request, can::Time now);
  void begin(can::Time now);
  void set_output(unsigned signal, bool on, can::Time now);
  void request_exchange(can::Time now);
  void exchange_done(can::Time now);
  void withdraw_exchange(can::Time now);
  void set_online(bool on, can::Time now);
  void set_up(can::Time now);
  void scan(can::Time now);
  void start_own_node(can::Time now);
  void end_node_start(NodeStart next, can::Time now);

  Rack& rack_;
  std::uint16_t head_;
  module::Module& module_;
  module::BufferMemoryAccess* words_;  // nullptr: the module has none; likewise
  module::SignalAccess* signals_;
  const module::ProgramInterface& interface_;
  Task task_;
  can::Duration interval_;   // of data exchanges
  can::Alarm alarm_;         // of the three
  can::Alarm next_request_;  // or the end of one by signals
  can::Alarm answer_due_;
  can::Alarm next_scan_;  // for what no signal shows
  can::Time requested_at_{};
  can::Time node_start_due_ = can::never;
  std::size_t next_word_ = 0;  // of the task, while is_setting_up_
  Exchange exchange_ = Exchange::idle;
  NodeStart node_start_ = NodeStart::none;
  bool is_running_ = false;
  bool was_ready_ = false;  // as set_up() saw it last
  bool is_setting_up_ = false;
  bool owns_signal_ = false;  // until X of the data exchange is OFF again
  bool is_writing_ = false;   // the request's bits
};

}  // namespace canopus::plc
