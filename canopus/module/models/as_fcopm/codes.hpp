#pragma once
// Codes that the registers show [AS-FCOPM 10.4.1, 10.5.1].

#include <cstdint>

namespace canopus::module::as_fcopm {

/// Low byte of D24000.
enum class Status : std::uint8_t {
  no_request = 0x00,
  success = 0x01,
  transmitting = 0x02,
  time_out = 0x03,
  illegal_command = 0x04,
  illegal_length = 0x05,
  illegal_response_length = 0x06,
  busy = 0x07,
  illegal_type = 0x08,
  wrong_node = 0x09,
  error_message = 0x0A,
};

/// SR830-893, as master.
enum class NodeCode : std::uint8_t {
  none = 0,
  emergency = 0xE0,
  pdo_length = 0xE1,
  pdo_missing = 0xE2,
  auto_sdo = 0xE3,
  pdo_parameter = 0xE4,
  key_parameter = 0xE5,
  not_there = 0xE6,
  error_control = 0xE7,
  same_node_id = 0xE8,
};

/// SR825.
enum class OwnCode : std::uint8_t {
  none = 0,
  initializing = 0xA0,         ///< slave
  pre_operational = 0xA1,      ///< slave
  slave_downloading = 0xA3,    ///< slave
  heartbeat_time_out = 0xB0,   ///< slave
  pdo_length = 0xB1,           ///< slave
  not_in_node_list = 0xF1,     ///< master
  downloading = 0xF2,          ///< master
  plc_error = 0xF3,            ///< master
  bus_off = 0xF4,              ///< both
  wrong_setting = 0xF5,        ///< master
  memory_error = 0xF8,         ///< master
  send_buffer_full = 0xFB,     ///< both
  receive_buffer_full = 0xFC,  ///< both
};

}  // namespace canopus::module::as_fcopm
