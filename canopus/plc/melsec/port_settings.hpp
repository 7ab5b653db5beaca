#pragma once
// The protocol settings of a port of an Ethernet module ("open settings"): its frames and data code, the
// write permission of its clients, and its remote password.

#include <cstdint>
#include <optional>
#include <string>

#include "canopus/plc/melsec/data_code.hpp"
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

}  // namespace canopus::plc::melsec
