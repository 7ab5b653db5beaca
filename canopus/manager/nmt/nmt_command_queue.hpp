#pragma once
// The NMT commands of a master, in the order in which they were given, no two within the NMT inhibit time
// [CiA 302-2 102AH, in 100 us]. Those of the start-up may have to wait longer, and do not hold up the others.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopus/manager/nmt/master_context.hpp"

namespace canopus::manager {

class NmtCommandQueue {
 public:
  explicit NmtCommandQueue(MasterContext& master) : master_(master) {}

  /// Sends it now, or when it may go. node_id 0: to all. Lost when 256 wait.
  void push(canopen::NmtCommand command, std::uint8_t node_id, can::Time now);
  /// One of the start-up: not before start_up_due().
  void push_of_start_up(canopen::NmtCommand command, std::uint8_t node_id, can::Time now);
  /// Starts of this node (0: of any) that wait are not sent.
  void withdraw_starts(std::uint8_t node_id);
  /// Commands of the start-up wait.
  [[nodiscard]] bool start_up_waits() const noexcept { return !of_start_up_.empty(); }
  /// When the next command of the start-up may go: MasterOptions::delay_before_each_command.
  [[nodiscard]] can::Time start_up_due() const;
  /// Sends what may go now; MasterContext::command_sent() for each.
  void flush(can::Time now);
  void clear() noexcept;
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  struct Command {
    canopen::NmtCommand command;
    std::uint8_t node_id;
  };
  static constexpr std::size_t capacity = 256;
  /// A full transmit queue is tried again after this.
  static constexpr can::Duration retry = std::chrono::milliseconds(1);

  bool send(const Command& command, can::Time now);
  void set_alarm() noexcept;

  MasterContext& master_;
  std::array<Command, capacity> commands_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  bool is_flushing_ = false;
  can::Time next_{};  // not before this
  can::Alarm alarm_;  // while commands wait
  std::vector<Command> of_start_up_;
  std::optional<can::Time> last_sent_;
};

}  // namespace canopus::manager
