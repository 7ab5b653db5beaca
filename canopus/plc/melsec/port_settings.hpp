#pragma once
// What a port of an Ethernet module is set to, as far as the protocol goes ("open settings"): which frames and which
// data code it takes, what its clients may write, and its remote password.

#include <cstdint>
#include <optional>
#include <string>

#include "canopus/can/time.hpp"
#include "canopus/plc/melsec/field.hpp"
#include "canopus/plc/rack/write_permission.hpp"

namespace canopus::plc::melsec {

struct PortSettings {
  bool takes_3e = true;            ///< 3E and 4E frames
  bool takes_1e = false;           ///< A-compatible 1E frames
  std::optional<DataCode> code{};  ///< none: that of a connection's or datagram's first byte
  WritePermission write = WritePermission::always;
  /// Without it every request but 1630 and 1631 is refused until 1630 brought it. Empty: none.
  std::string remote_password{};
  bool remote_reset = false;  ///< 1006 is allowed, a parameter of the CPU
};

/// Who guesses the remote password of a port has few tries, whatever connections they use: all sessions of a
/// port share one.
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
