#pragma once
// The address map of Delta's AS300 PLCs: each device has fixed Modbus addresses. Rows of devices that a CPU does not have are
// left out.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "canopus/plc/modbus/settings.hpp"

namespace canopus::plc::modbus {

/// A run of points of one device. Words of X and Y have addresses of their own beside the bits.
struct DeviceAddresses {
  std::string_view device;  ///< as the AS300 calls it
  bool words = false;       ///< registers, else single bits
  std::uint16_t first = 0;  ///< Modbus address of point 0
  std::uint16_t count = 0;  ///< addresses
  bool inputs = false;      ///< read by functions 2 and 4, too, and not written
};

/// The addresses are not confirmed by a manual at hand.
[[nodiscard]] std::span<const DeviceAddresses> as300_addresses() noexcept;

/// Modbus address of a device's point, or of the word `number` of X, Y and word devices. Empty: the AS300 does not have
/// it.
[[nodiscard]] std::optional<std::uint16_t> as300_address(Device device, bool words,
                                                         std::uint32_t number) noexcept;

/// The map of all devices that `model` has, with at most as many points as it has. Coils and discrete inputs are
/// the same addresses (functions 1 and 2 read X, Y, M, SM, S, T, C, HC); input registers are X. A value of HC
/// (32 bits) has one address, and is two registers of a request.
[[nodiscard]] Map as300_map(const CpuModel& model);

/// 100 words and 1600 bits a request; no functions 22 and 43.
[[nodiscard]] Limits as300_limits() noexcept;

}  // namespace canopus::plc::modbus
