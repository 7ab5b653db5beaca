#pragma once
// Node guarding, master side, of one slave [CiA 301 node guarding; ME3CAN1-Q 4.6.7]: a remote frame
// 700H + node-ID every guard time, answered by one byte: toggle bit 7 and the slave's state. The slave is
// lost when it was not heard for its life time (guard time x retry factor).
//
// Decides only; the remote frames are sent by its owner.

#include <algorithm>
#include <cstdint>

#include "canopus/can/time.hpp"

namespace canopus::manager {

class NodeGuarding {
 public:
  struct Due {
    bool request = false;  ///< a remote frame is to be sent now
    bool missed = false;   ///< the previous one was not answered
    bool lost = false;     ///< and by this, the life time is over
  };
  struct Answer {
    bool accepted = false;  ///< false: wrong toggle bit, the answer does not count
    bool resolved = false;  ///< the slave was lost before
  };

  /// Begins; the first remote frame is due at once. retry_factor >= 1, guard_time > 0.
  void start(can::Duration guard_time, unsigned retry_factor, can::Time now) noexcept;
  /// The toggle bit is remembered: the slave goes on with it when guarding starts again.
  void stop() noexcept;
  /// Nothing is known of the slave.
  void forget() noexcept { *this = NodeGuarding{}; }
  /// The slave was reset: its silence is no news until it answers, and its toggle bit begins anew.
  void expect_silence() noexcept;
  /// The slave's boot-up message: the toggle bit of its next answer is 0.
  void boot_up() noexcept;

  Due tick(can::Time now) noexcept;
  /// Also while not running: an answer to a single remote frame moves the toggle bit on.
  Answer answer(std::uint8_t byte, can::Time now) noexcept;

  [[nodiscard]] bool running() const noexcept { return running_; }
  /// Running, and answers are coming.
  [[nodiscard]] bool alive() const noexcept { return running_ && answered_ && !lost_; }
  [[nodiscard]] can::Time deadline() const noexcept { return std::min(next_request_, life_end_); }

 private:
  bool running_ = false;
  bool awaiting_ = false;
  bool answered_ = false;
  bool lost_ = false;
  bool silence_expected_ = false;
  bool toggle_known_ = false;
  bool toggle_ = false;
  unsigned retry_factor_ = 0;
  can::Duration guard_time_{};
  can::Time requested_{};
  can::Time next_request_ = can::never;
  can::Time life_end_ = can::never;
};

}  // namespace canopus::manager
