#pragma once
// SDO abort codes [CiA 301 7.2.4.3.17] and the two local ones of the Mitsubishi modules [ME3CAN1-Q 8.2.3].

#include <cstdint>
#include <string_view>

namespace canopus::canopen {

enum class AbortCode : std::uint32_t {
  none = 0,
  toggle_bit = 0x05030000,
  timed_out = 0x05040000,
  command_specifier = 0x05040001,
  block_size = 0x05040002,
  sequence_number = 0x05040003,
  crc = 0x05040004,
  out_of_memory = 0x05040005,
  unsupported_access = 0x06010000,
  read_of_write_only = 0x06010001,
  write_of_read_only = 0x06010002,
  no_object = 0x06020000,
  not_mappable = 0x06040041,
  mapping_length = 0x06040042,
  parameter_incompatible = 0x06040043,
  internal_incompatible = 0x06040047,
  hardware_error = 0x06060000,
  length_mismatch = 0x06070010,
  length_too_high = 0x06070012,
  length_too_low = 0x06070013,
  no_sub_index = 0x06090011,
  invalid_value = 0x06090030,
  value_too_high = 0x06090031,
  value_too_low = 0x06090032,
  maximum_below_minimum = 0x06090036,
  no_sdo_connection = 0x060A0023,
  general = 0x08000000,
  cannot_store = 0x08000020,
  local_control = 0x08000021,
  device_state = 0x08000022,
  no_dictionary = 0x08000023,
  no_data = 0x08000024,
};

/// What the code means, in a few words: "object does not exist". "unknown abort code" for one that is not
/// listed.
[[nodiscard]] std::string_view describe(AbortCode code) noexcept;

}  // namespace canopus::canopen
