#pragma once
// The frames of the small services as text: NMT, EMCY, LSS, flying master, error frames.

#include <cstdint>
#include <string>
#include <string_view>

#include "canopus/can/frame.hpp"

namespace canopus::trace {

/// "start", "reset communication"; empty for a command that is none.
[[nodiscard]] std::string_view nmt_command_name(std::uint8_t command) noexcept;

/// "8130H life guard or heartbeat error; error register 11H: generic, communication; 00 00 00 00 00". `frame` has at
/// least 3 bytes.
[[nodiscard]] std::string emcy_text(const can::Frame& frame);
/// "life guard or heartbeat error": the code's words, or those of its class [CiA 301 7.2.7.1].
[[nodiscard]] std::string_view emcy_code_text(std::uint16_t code) noexcept;
/// "generic, communication"; "no error" for 0.
[[nodiscard]] std::string error_register_text(std::uint8_t error_register);

/// A frame of LSS.
struct LssText {
  std::string_view
      kind;  ///< the service: "switch state selective: vendor"; "unknown" for other command specifiers
  std::string text;  ///< service and fields
};
/// `from_master`: on 7E5H, else 7E4H.
[[nodiscard]] LssText lss_text(const can::Frame& frame, bool from_master);

/// Frames 071H to 076H of CiA 302-2: what the identifier means, empty for others.
[[nodiscard]] std::string_view flying_master_name(std::uint32_t identifier) noexcept;

/// A SocketCAN error frame: "no acknowledgement; bus error; controller: error passive (TEC 128, REC 0)".
[[nodiscard]] std::string error_frame_text(const can::Frame& frame);

}  // namespace canopus::trace
