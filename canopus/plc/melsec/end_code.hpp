#pragma once
// End codes of the MELSEC communication protocol: the codes of a CPU module's reply other than 0000H. The
// names are ours, numbers and meanings are from the manuals [SH-080811 5.1.4, SH-080931]. docs/mc-protocol.md
// lists those that a real CPU returned, and the cases.

#include <cstdint>
#include <string>
#include <string_view>

namespace canopus::plc::melsec {

enum class EndCode : std::uint16_t {
  completed = 0x0000,
  online_change_disabled = 0x0055,
  not_while_running = 0x4013,
  no_such_device = 0x4030,
  device_out_of_range = 0x4031,
  beyond_buffer_memory = 0x4041,
  no_module = 0x4043,
  wrong_request_data = 0x4080,
  remote_request_refused = 0x408B,
  not_convertible = 0xC050,
  bit_points = 0xC051,
  word_points = 0xC052,
  random_bit_points = 0xC053,
  random_word_points = 0xC054,
  text_length = 0xC058,
  unknown_command = 0xC059,
  device_not_accessible = 0xC05B,
  wrong_contents = 0xC05C,
  nothing_registered = 0xC05D,
  other_target = 0xC05F,
  wrong_bit_data = 0xC060,
  data_length = 0xC061,
  no_device_extension = 0xC070,
  wrong_password_q = 0xC200,
  port_locked = 0xC201,
  wrong_password_iqr = 0xC810,
  password_locked_out = 0xC816,
};

/// The meaning of an end code, in a few words; for any number, known or not.
[[nodiscard]] std::string_view end_code_text(std::uint16_t code) noexcept;
/// The same for 1E frames: "58H: ...", "5BH 10H: ..."; `abnormal_code` counts behind 5BH alone.
[[nodiscard]] std::string describe_end_code_1e(std::uint8_t end_code, std::uint8_t abnormal_code);

}  // namespace canopus::plc::melsec
