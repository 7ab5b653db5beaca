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

/// Adds the rows to the builder.
void add_rows(canopen::DictionaryBuilder& builder, std::span<const ObjectRow> rows);

/// Adds the network variables that fill a block of `block_bytes` each way.
void add_network_variables(canopen::DictionaryBuilder& builder, std::size_t block_bytes,
                           const VariablesPerIndex& per_index = {});

/// Adds the mappings 1600H on and 1A00H on: PDO n (from 0) has the unsigned 16-bit variables 4n .. 4n + 3.
void add_default_mappings(canopen::DictionaryBuilder& builder, unsigned pdos,
                          const VariablesPerIndex& per_index = {});

}  // namespace canopus::module
