#pragma once

#include <chrono>

#include "canopus/can/time.hpp"

namespace canopus::plc::melsec {

/// Limits the attempts at the remote password of a port, across connections: all sessions of a port share one
/// guard.
class PasswordGuard {
 public:
  static constexpr unsigned most_tries = 5;
  static constexpr can::Duration lock_out = std::chrono::minutes(1);

  [[nodiscard]] bool is_locked_out(can::Time now) const noexcept { return now < locked_out_until_; }
  void failed(can::Time now) noexcept {
    if (++failures_ < most_tries) return;
    failures_ = 0;
    locked_out_until_ = can::later(now, lock_out);
  }
  void succeeded() noexcept { failures_ = 0; }

 private:
  unsigned failures_ = 0;
  can::Time locked_out_until_{};
};

}  // namespace canopus::plc::melsec
