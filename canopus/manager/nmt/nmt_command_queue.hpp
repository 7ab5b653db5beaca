#pragma once
// The NMT commands of a master, in the order in which they were given, no two within the NMT inhibit time
// [CiA 302-2 102AH, in 100 us].

#include <array>
#include <cstddef>
#include <cstdint>

#include "canopus/manager/nmt/master_context.hpp"

namespace canopus::manager {

class NmtCommandQueue {
 public:
  explicit NmtCommandQueue(MasterContext& master) : master_(master) {}

  /// Sends it now, or when it may go. node_id 0: to all. Lost when 256 wait.
  void push(canopen::NmtCommand command, std::uint8_t node_id, can::Time now);
  /// Sends what may go now; MasterContext::command_sent() for each.
  void flush(can::Time now);
  void clear() noexcept {
    first_ = count_ = 0;
    alarm_.cancel();
  }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  struct Command {
    canopen::NmtCommand command;
    std::uint8_t node_id;
  };
  static constexpr std::size_t capacity = 256;
  /// A full transmit queue is tried again after this.
  static constexpr can::Duration retry = std::chrono::milliseconds(1);

  MasterContext& master_;
  std::array<Command, capacity> commands_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  bool is_flushing_ = false;
  can::Time next_{};  // not before this
  can::Alarm alarm_;  // while commands wait
};

}  // namespace canopus::manager
