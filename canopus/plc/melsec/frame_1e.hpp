#pragma once
// A-compatible 1E frames: no length field, so the command determines the length of a request.
//
//   request  subheader 1 | PC number 1 (FF) | monitoring timer 2 | ...
//   reply    subheader + 80H 1 | end code 1 | data, or behind end code 5BH: abnormal code 1 | 00
//
// In ASCII each byte is two hexadecimal characters, high digit first. [FX3U-ENET 9.1, SH-080008 18]

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/plc/cpu/device.hpp"
#include "canopus/plc/melsec/field.hpp"

namespace canopus::plc::melsec {

enum class Command1e : std::uint8_t {
  read_bits = 0x00,
  read_words = 0x01,
  write_bits = 0x02,
  write_words = 0x03,
  test_bits = 0x04,   ///< random write
  test_words = 0x05,  ///< random write
  register_bits = 0x06,
  register_words = 0x07,
  monitor_bits = 0x08,
  monitor_words = 0x09,
  read_buffer = 0x0E,
  write_buffer = 0x0F,
  remote_run = 0x13,
  remote_stop = 0x14,
  read_model = 0x15,
  loopback = 0x16,
};

/// End codes of 1E replies. [FX3U-ENET 11.4.2, SH-080811 5.1.4]
enum class EndCode1e : std::uint8_t {
  completed = 0x00,
  unknown_subheader = 0x50,
  not_convertible = 0x54,  ///< ASCII that is no number
  online_change_disabled = 0x55,
  wrong_device = 0x56,
  points = 0x57,  ///< too many points, beyond the last device, the length does not fit, nothing to monitor
  head_device =
      0x58,  ///< first device beyond the last one, word device in bits, bits not from a multiple of 16
  cpu_refuses = 0x5B,  ///< an abnormal code gives the reason
};

/// Behind end code 5BH. 12H is not confirmed by a manual at hand.
enum class AbnormalCode : std::uint8_t {
  none = 0x00,
  pc_number = 0x10,
  special_function_module = 0x12,  ///< no module with this number
  remote_request = 0x18,           ///< remote RUN or STOP is not possible
};

/// A device's name as two characters, the first in the high byte: "D " is 4420H. Empty: 1E frames have none.
/// [FX3U-ENET 9.3.1, SH-080008 18.2]
[[nodiscard]] std::optional<std::uint16_t> device_code_1e(Device device) noexcept;
/// The device with this name.
[[nodiscard]] std::optional<Device> device_of_1e(std::uint16_t code) noexcept;

/// Largest subheader that any module takes; larger ones are no request.
inline constexpr std::uint8_t last_subheader_1e = 0x3C;

struct Request1e {
  enum class State : std::uint8_t {
    incomplete,
    complete,
    unknown,      ///< an unknown subheader: the length of the request is undefined
    not_a_number  ///< ASCII that is none, where the length depends on it
  } state = State::incomplete;
  std::uint8_t subheader = 0;
  std::size_t size = 0;  ///< bytes or characters, when complete
};

/// An FX3 has 32-bit counters from this one on: their current values are four bytes a point.
inline constexpr std::uint32_t first_wide_counter = 200;

/// Finds out how long the request at the beginning of `bytes` is. `wide_counters`: those of an FX3.
[[nodiscard]] Request1e read_request_1e(std::span<const std::uint8_t> bytes, DataCode code,
                                        bool wide_counters = false) noexcept;

}  // namespace canopus::plc::melsec
