#pragma once
// Object dictionaries of modules as constexpr rows that read like the manual's tables; build() makes the
// description.

#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/module/interface/program_interface.hpp"

namespace canopus::module {

/// Object dictionary row: indexes first..last that are alike, one sub-index or a run of them.
struct ObjectRow {
  enum class Kind : std::uint8_t {
    variable,  ///< sub-index 00H alone
    array,     ///< sub-indexes 01H..sub_last all alike, described once
    sub,       ///< sub-indexes sub_first..sub_last of a record
  };
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  Kind kind = Kind::variable;
  std::uint8_t sub_first = 0;
  std::uint8_t sub_last = 0;
  std::string_view name{};
  canopen::DataType type = canopen::DataType::unsigned32;
  canopen::Access access = canopen::Access::read_only;
  std::uint64_t value = 0;
  /// Flags, or-ed.
  enum Flag : std::uint8_t {
    plain = 0,
    stored = 1,          ///< saved by 1010H
    adds_node_id = 2,    ///< default + node-ID
    adds_sub_index = 4,  ///< default + sub-index
    rpdo = 8,            ///< may be mapped into an RPDO
    tpdo = 16,           ///< may be mapped into a TPDO
  };
  unsigned flags = plain;
  std::string_view text{};  ///< default of a string
};

/// The short names of the columns, for `using namespace object_row` in a table's source file.
namespace object_row {
using enum ObjectRow::Kind;
using enum ObjectRow::Flag;
inline constexpr auto u8 = canopen::DataType::unsigned8;
inline constexpr auto u16 = canopen::DataType::unsigned16;
inline constexpr auto u32 = canopen::DataType::unsigned32;
inline constexpr auto u48 = canopen::DataType::unsigned48;
inline constexpr auto i8 = canopen::DataType::integer8;
inline constexpr auto i16 = canopen::DataType::integer16;
inline constexpr auto i32 = canopen::DataType::integer32;
inline constexpr auto string = canopen::DataType::visible_string;
inline constexpr auto domain = canopen::DataType::domain;
inline constexpr auto ro = canopen::Access::read_only;
inline constexpr auto rw = canopen::Access::read_write;
inline constexpr auto wo = canopen::Access::write_only;
}  // namespace object_row

/// Adds the rows to the builder.
void add_rows(canopen::DictionaryBuilder& builder, std::span<const ObjectRow> rows);

/// Adds the network variables that fill a block of `block_bytes` each way.
void add_network_variables(canopen::DictionaryBuilder& builder, std::size_t block_bytes,
                           const VariablesPerIndex& per_index = {});

/// Adds the mappings 1600H on and 1A00H on: PDO n (from 0) has the unsigned 16-bit variables 4n .. 4n + 3.
void add_default_mappings(canopen::DictionaryBuilder& builder, unsigned pdos,
                          const VariablesPerIndex& per_index = {});

}  // namespace canopus::module
