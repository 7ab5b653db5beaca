#include "canopus/canopen/dictionary/abort_code.hpp"

namespace canopus::canopen {

std::string_view describe(AbortCode code) noexcept {
  switch (code) {
    case AbortCode::none: return "no error";
    case AbortCode::toggle_bit: return "toggle bit not alternated";
    case AbortCode::timed_out: return "SDO protocol timed out";
    case AbortCode::command_specifier: return "command specifier invalid or unknown";
    case AbortCode::block_size: return "invalid block size";
    case AbortCode::sequence_number: return "invalid sequence number";
    case AbortCode::crc: return "CRC error";
    case AbortCode::out_of_memory: return "out of memory";
    case AbortCode::unsupported_access: return "unsupported access to an object";
    case AbortCode::read_of_write_only: return "read of a write-only object";
    case AbortCode::write_of_read_only: return "write of a read-only object";
    case AbortCode::no_object: return "object does not exist";
    case AbortCode::not_mappable: return "object cannot be mapped to the PDO";
    case AbortCode::mapping_length: return "mapped objects exceed the PDO length";
    case AbortCode::parameter_incompatible: return "general parameter incompatibility";
    case AbortCode::internal_incompatible: return "general internal incompatibility";
    case AbortCode::hardware_error: return "access failed due to a hardware error";
    case AbortCode::length_mismatch: return "data type or length does not match";
    case AbortCode::length_too_high: return "length too high";
    case AbortCode::length_too_low: return "length too low";
    case AbortCode::no_sub_index: return "sub-index does not exist";
    case AbortCode::invalid_value: return "invalid value";
    case AbortCode::value_too_high: return "value too high";
    case AbortCode::value_too_low: return "value too low";
    case AbortCode::maximum_below_minimum: return "maximum is less than minimum";
    case AbortCode::no_sdo_connection: return "resource not available: SDO connection";
    case AbortCode::general: return "general error";
    case AbortCode::cannot_store: return "data cannot be transferred or stored";
    case AbortCode::local_control: return "data cannot be transferred or stored because of local control";
    case AbortCode::device_state: return "data cannot be transferred or stored because of the device state";
    case AbortCode::no_dictionary: return "no object dictionary present";
    case AbortCode::no_data: return "no data available";
  }
  switch (static_cast<std::uint32_t>(code)) {
    case 0x50000000: return "time-out or no identifier for SDO";
    case 0x60600000: return "buffer too small for the received SDO data";
    default: return "unknown abort code";
  }
}

}  // namespace canopus::canopen
