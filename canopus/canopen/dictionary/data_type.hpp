#pragma once
// Data types, access and object codes of the object dictionary [CiA 301 7.4.3, 7.4.7, 7.4.8].

#include <cstdint>

namespace canopus::canopen {

/// Index of a data type in the object dictionary, as EDS files and 1F81H-style tables name it.
enum class DataType : std::uint8_t {
  none = 0x00,
  boolean = 0x01,
  integer8 = 0x02,
  integer16 = 0x03,
  integer32 = 0x04,
  unsigned8 = 0x05,
  unsigned16 = 0x06,
  unsigned32 = 0x07,
  real32 = 0x08,
  visible_string = 0x09,
  octet_string = 0x0A,
  unicode_string = 0x0B,
  time_of_day = 0x0C,
  time_difference = 0x0D,
  domain = 0x0F,
  integer24 = 0x10,
  real64 = 0x11,
  integer40 = 0x12,
  integer48 = 0x13,
  integer56 = 0x14,
  integer64 = 0x15,
  unsigned24 = 0x16,
  unsigned40 = 0x18,
  unsigned48 = 0x19,
  unsigned56 = 0x1A,
  unsigned64 = 0x1B,
};

/// Length in bits as mapped into a PDO: 1 for BOOLEAN, 48 for the time types, 0 for types of variable length.
[[nodiscard]] constexpr unsigned bit_length(DataType type) noexcept {
  switch (type) {
    case DataType::boolean: return 1;
    case DataType::integer8:
    case DataType::unsigned8: return 8;
    case DataType::integer16:
    case DataType::unsigned16: return 16;
    case DataType::integer24:
    case DataType::unsigned24: return 24;
    case DataType::integer32:
    case DataType::unsigned32:
    case DataType::real32: return 32;
    case DataType::integer40:
    case DataType::unsigned40: return 40;
    case DataType::integer48:
    case DataType::unsigned48:
    case DataType::time_of_day:
    case DataType::time_difference: return 48;
    case DataType::integer56:
    case DataType::unsigned56: return 56;
    case DataType::integer64:
    case DataType::unsigned64:
    case DataType::real64: return 64;
    default: return 0;
  }
}

/// Length in bytes as an SDO carries it: 1 for BOOLEAN, 0 for types of variable length.
[[nodiscard]] constexpr unsigned byte_length(DataType type) noexcept { return (bit_length(type) + 7) / 8; }

[[nodiscard]] constexpr bool is_signed(DataType type) noexcept {
  switch (type) {
    case DataType::integer8:
    case DataType::integer16:
    case DataType::integer24:
    case DataType::integer32:
    case DataType::integer40:
    case DataType::integer48:
    case DataType::integer56:
    case DataType::integer64: return true;
    default: return false;
  }
}

/// Strings and domains: their values have no fixed length.
[[nodiscard]] constexpr bool is_variable_length(DataType type) noexcept {
  return type != DataType::none && bit_length(type) == 0;
}

/// Access as seen from the bus. rwr and rww are rw and say in which PDO the object may be mapped besides [CiA
/// 306].
enum class Access : std::uint8_t {
  read_only,          ///< ro
  write_only,         ///< wo
  read_write,         ///< rw
  read_write_input,   ///< rwr: process input, for TPDOs
  read_write_output,  ///< rww: process output, for RPDOs
  constant,           ///< const
};

[[nodiscard]] constexpr bool is_readable(Access access) noexcept { return access != Access::write_only; }
[[nodiscard]] constexpr bool is_writable(Access access) noexcept {
  return access != Access::read_only && access != Access::constant;
}

/// Kind of an object [CiA 301 7.4.3].
enum class ObjectCode : std::uint8_t {
  null = 0,
  domain = 2,
  type_definition = 5,
  structure_definition = 6,
  variable = 7,
  array = 8,
  record = 9,
};

}  // namespace canopus::canopen
