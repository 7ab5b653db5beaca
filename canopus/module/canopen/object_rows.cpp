#include "canopus/module/canopen/object_rows.hpp"

#include <algorithm>
#include <string>

#include "canopus/module/canopen/network_variables.hpp"

namespace canopus::module {

void add_rows(canopen::DictionaryBuilder& builder, std::span<const ObjectRow> rows) {
  using canopen::ObjectCode;
  for (const ObjectRow& row : rows) {
    const auto spec = [&](unsigned sub) {
      const std::uint64_t value = row.value + ((row.flags & ObjectRow::adds_sub_index) != 0 ? sub : 0U);
      return canopen::EntrySpec{
          .name = std::string(row.name),
          .type = row.type,
          .access = row.access,
          .value = row.text.empty() ? canopen::little_endian(value, canopen::byte_length(row.type))
                                    : canopen::text(row.text),
          .adds_node_id = (row.flags & ObjectRow::adds_node_id) != 0,
          .rpdo_mappable = (row.flags & ObjectRow::rpdo) != 0,
          .tpdo_mappable = (row.flags & ObjectRow::tpdo) != 0,
          .stored = (row.flags & ObjectRow::stored) != 0,
      };
    };
    for (unsigned index = row.first; index <= row.last; ++index) {
      const auto number = static_cast<std::uint16_t>(index);
      switch (row.kind) {
        case ObjectRow::Kind::variable: builder.variable(number, spec(0)); break;
        case ObjectRow::Kind::array:
          builder.uniform(number, ObjectCode::array, std::string(row.name), row.sub_last, spec(0));
          break;
        case ObjectRow::Kind::sub:
          if (!builder.contains(number)) builder.object(number, ObjectCode::record, std::string(row.name));
          for (unsigned sub = row.sub_first; sub <= row.sub_last; ++sub) {
            builder.sub(number, static_cast<std::uint8_t>(sub), spec(sub));
          }
          break;
      }
    }
  }
}

void add_network_variables(canopen::DictionaryBuilder& builder, std::size_t block_bytes,
                           const VariablesPerIndex& per_index) {
  for (const VariableArea& area : variable_areas) {
    const bool input = area.direction == VariableDirection::input;
    const canopen::EntrySpec spec{
        .name = std::string(area.name),
        .type = area.type,
        .access = input ? canopen::Access::read_only : canopen::Access::read_write,
        .rpdo_mappable = !input,
        .tpdo_mappable = input,
    };
    std::size_t left = area.size() == 0 ? 0 : block_bytes / area.size();
    for (std::uint16_t index = area.first_index; left > 0; ++index) {
      const std::size_t count = std::min(left, per_index.of_bytes(area.size()));
      builder.uniform(index, canopen::ObjectCode::array, std::string(area.name),
                      static_cast<std::uint8_t>(count), spec);
      left -= count;
    }
  }
}

void add_default_mappings(canopen::DictionaryBuilder& builder, unsigned pdos,
                          const VariablesPerIndex& per_index) {
  struct Mapping {
    std::uint16_t first;
    std::string_view name;
    VariableDirection direction;
  };
  constexpr unsigned words_per_pdo = 4;
  for (const Mapping& mapping : {Mapping{0x1600, "RPDO mapping", VariableDirection::output},
                                 Mapping{0x1A00, "TPDO mapping", VariableDirection::input}}) {
    const VariableArea& words = variable_area(canopen::DataType::unsigned16, mapping.direction);
    for (unsigned number = 0; number < words_per_pdo * pdos; ++number) {
      const auto index = static_cast<std::uint16_t>(mapping.first + number / words_per_pdo);
      const auto sub = static_cast<std::uint8_t>(number % words_per_pdo + 1);
      const ObjectRow row{.first = index,
                          .last = index,
                          .kind = ObjectRow::Kind::sub,
                          .sub_first = sub,
                          .sub_last = sub,
                          .name = mapping.name,
                          .access = canopen::Access::read_write,
                          .value = variable_mapping(words, number, per_index),
                          .flags = ObjectRow::stored};
      add_rows(builder, {&row, 1});
    }
  }
}

}  // namespace canopus::module
