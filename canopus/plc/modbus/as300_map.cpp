#include "canopus/plc/modbus/as300_map.hpp"

#include <algorithm>
#include <array>
#include <optional>

namespace canopus::plc::modbus {

namespace {

// clang-format off
constexpr std::array table = {
    //               device  words  first   count  inputs
    DeviceAddresses{"X",     false, 0x6000,  1024, true},   // X0.0 to X63.15
    DeviceAddresses{"X",     true,  0x8000,    64, true},   // X0 to X63
    DeviceAddresses{"Y",     false, 0xA000,  1024, false},  // Y0.0 to Y63.15
    DeviceAddresses{"Y",     true,  0xA000,    64, false},  // Y0 to Y63
    DeviceAddresses{"M",     false, 0x0000,  8192, false},
    DeviceAddresses{"SM",    false, 0x4000,  4096, false},
    DeviceAddresses{"S",     false, 0x5000,  2048, false},
    DeviceAddresses{"T",     false, 0xE000,   512, false},  // contacts
    DeviceAddresses{"T",     true,  0xE000,   512, false},  // current values
    DeviceAddresses{"C",     false, 0xF000,   512, false},
    DeviceAddresses{"C",     true,  0xF000,   512, false},
    DeviceAddresses{"HC",    false, 0xFC00,   256, false},
    DeviceAddresses{"HC",    true,  0xFC00,   256, false},  // current values of 32 bits
    DeviceAddresses{"D",     true,  0x0000, 30000, false},
    DeviceAddresses{"SR",    true,  0xC000,  2048, false},
};
// clang-format on

/// The device of an AS300 device name: timers and counters are a contact and a value each.
std::optional<Device> device_of(const DeviceAddresses& row) {
  if (row.device == "T") return row.words ? Device::tn : Device::ts;
  if (row.device == "C") return row.words ? Device::cn : Device::cs;
  if (row.device == "HC") return row.words ? Device::hcn : Device::hcs;
  if (row.device == "SR") return Device::sd;
  return device_named(row.device);
}

}  // namespace

std::span<const DeviceAddresses> as300_addresses() noexcept { return table; }

std::optional<std::uint16_t> as300_address(Device device, bool words, std::uint32_t number) noexcept {
  for (const DeviceAddresses& row : table)
    if (row.words == words && device_of(row) == device && number < row.count)
      return static_cast<std::uint16_t>(row.first + number);
  return std::nullopt;
}

Map as300_map(const CpuModel& model) {
  Map map;
  for (const DeviceAddresses& row : table) {
    const auto device = device_of(row);
    if (!device) continue;
    const std::uint32_t points = model.points_of(*device);
    const bool words_of_bits = row.words && device_info(*device).is_bit;
    const bool double_words = *device == Device::hcn;
    const std::uint32_t there = words_of_bits ? points / 16 : double_words ? points / 2 : points;
    const std::uint32_t count = std::min<std::uint32_t>(row.count, there);
    if (count == 0) continue;
    const Range range{row.first, count, {false, *device, 0, 0}, row.inputs, double_words};
    if (!row.words) {
      (void)map.add(Table::coils, range);
      (void)map.add(Table::discrete_inputs, range);
    } else {
      (void)map.add(Table::holding_registers, range);
      if (row.inputs) (void)map.add(Table::input_registers, range);
    }
  }
  return map;
}

Limits as300_limits() noexcept {
  return {.read_bits = 1600,
          .write_bits = 1600,
          .read_words = 100,
          .write_words = 100,
          .read_words_of_23 = 100,
          .write_words_of_23 = 100,
          .mask_write = false,
          .identification = false};
}

}  // namespace canopus::plc::modbus
