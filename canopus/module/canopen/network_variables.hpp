#pragma once
// Network variables of a programmable device [CiA 405]: areas of alike objects, n to an index (254, or what the
// device says), that show one block of process data as 8-, 16- and 32-bit values. Object number m of an area (0, 1,
// 2 ...) is index first + m / n, sub-index m % n + 1.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/module/interface/program_interface.hpp"

namespace canopus::module {

/// Which way a network variable goes, named as CiA 405 does: seen from the network.
enum class VariableDirection : std::uint8_t {
  input,   ///< PLC to network: mapped into TPDOs
  output,  ///< network to PLC: mapped into RPDOs
};

struct VariableArea {
  std::uint16_t first_index = 0;
  canopen::DataType type = canopen::DataType::none;
  VariableDirection direction = VariableDirection::input;
  std::string_view name{};

  [[nodiscard]] constexpr std::size_t size() const noexcept { return canopen::byte_length(type); }
};

inline constexpr std::array<VariableArea, 14> variable_areas{{
    {0xA000, canopen::DataType::integer8, VariableDirection::input, "Input network variable signed 8"},
    {0xA040, canopen::DataType::unsigned8, VariableDirection::input, "Input network variable unsigned 8"},
    {0xA0C0, canopen::DataType::integer16, VariableDirection::input, "Input network variable signed 16"},
    {0xA100, canopen::DataType::unsigned16, VariableDirection::input, "Input network variable unsigned 16"},
    {0xA1C0, canopen::DataType::integer32, VariableDirection::input, "Input network variable signed 32"},
    {0xA200, canopen::DataType::unsigned32, VariableDirection::input, "Input network variable unsigned 32"},
    {0xA240, canopen::DataType::real32, VariableDirection::input, "Input network variable float 32"},
    {0xA480, canopen::DataType::integer8, VariableDirection::output, "Output network variable signed 8"},
    {0xA4C0, canopen::DataType::unsigned8, VariableDirection::output, "Output network variable unsigned 8"},
    {0xA540, canopen::DataType::integer16, VariableDirection::output, "Output network variable signed 16"},
    {0xA580, canopen::DataType::unsigned16, VariableDirection::output, "Output network variable unsigned 16"},
    {0xA640, canopen::DataType::integer32, VariableDirection::output, "Output network variable signed 32"},
    {0xA680, canopen::DataType::unsigned32, VariableDirection::output, "Output network variable unsigned 32"},
    {0xA6C0, canopen::DataType::real32, VariableDirection::output, "Output network variable float 32"},
}};

/// The area of this type and direction; there must be one.
[[nodiscard]] constexpr const VariableArea& variable_area(canopen::DataType type,
                                                          VariableDirection direction) noexcept {
  std::size_t i = 0;
  while (variable_areas[i].type != type || variable_areas[i].direction != direction) ++i;
  return variable_areas[i];
}

/// Object number `number` of an area as a PDO mapping parameter names it.
[[nodiscard]] constexpr std::uint32_t variable_mapping(const VariableArea& area, std::size_t number,
                                                       const VariablesPerIndex& per_index = {}) noexcept {
  const std::size_t in_index = per_index.of_bytes(area.size());
  const auto index = static_cast<std::uint32_t>(area.first_index + number / in_index);
  const auto sub = static_cast<std::uint32_t>(number % in_index + 1);
  return index << 16U | sub << 8U | static_cast<std::uint32_t>(8 * area.size());
}

/// Where a network variable lies in the block of its direction.
struct VariablePlace {
  VariableDirection direction = VariableDirection::input;
  std::uint16_t offset = 0;  ///< bytes
  std::uint8_t size = 0;     ///< bytes
};

/// The place of an object within a block of `block_bytes`, if it is a network variable of that block.
[[nodiscard]] constexpr std::optional<VariablePlace> variable_place(
    std::uint16_t index, std::uint8_t sub, std::size_t block_bytes,
    const VariablesPerIndex& per_index = {}) noexcept {
  if (index < 0xA000 || index > 0xA6FF || sub == 0) return std::nullopt;
  for (const VariableArea& area : variable_areas) {
    if (index < area.first_index || index >= area.first_index + 0x40) continue;
    const std::size_t in_index = per_index.of_bytes(area.size());
    if (sub > in_index) return std::nullopt;
    const std::size_t number = (index - area.first_index) * in_index + sub - 1U;
    const std::size_t offset = number * area.size();
    if (offset + area.size() > block_bytes) return std::nullopt;
    return VariablePlace{area.direction, static_cast<std::uint16_t>(offset),
                         static_cast<std::uint8_t>(area.size())};
  }
  return std::nullopt;
}

}  // namespace canopus::module
