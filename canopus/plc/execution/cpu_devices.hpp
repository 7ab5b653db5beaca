#pragma once
// The devices of a rack's CPU and the buffer memory of its modules, as a PLC program names and reaches them.

#include <array>

#include "canopus/plc/rack/rack.hpp"
#include "canopus/program/device_image.hpp"

namespace canopus::plc {

/// Names of a CPU's devices: "X10", "D100", "U0\G25", with the number bases of its family.
class CpuDeviceNames final : public program::DeviceNames {
 public:
  /// `model` must outlive it.
  explicit CpuDeviceNames(const CpuModel& model) : model_(model) {}

  [[nodiscard]] std::expected<program::DevicePoint, std::string> point(std::string_view name) const override;
  [[nodiscard]] bool looks_like_device(std::string_view name) const override;

 private:
  const CpuModel& model_;
};

/// A program's access to a rack. X and Y are those of the scan, a module's buffer memory is that of the moment: as FROM and TO
/// have it. The index registers of an FX3 are a program's alone: no client reaches them.
class CpuDevices final : public program::DeviceImage {
 public:
  explicit CpuDevices(Rack& rack) : rack_(rack) {}
  void set_time(can::Time now) noexcept { now_ = now; }

  program::DeviceError read_words(const program::DevicePoint& first, std::span<std::uint16_t> words) override;
  program::DeviceError write_words(const program::DevicePoint& first,
                                   std::span<const std::uint16_t> words) override;
  program::DeviceError read_bits(const program::DevicePoint& first, unsigned count,
                                 std::uint32_t& bits) override;
  program::DeviceError write_bits(const program::DevicePoint& first, unsigned count,
                                  std::uint32_t bits) override;
  [[nodiscard]] std::uint16_t* words_in_memory(const program::DevicePoint& first, unsigned count) override;
  [[nodiscard]] std::uint8_t* bit_in_memory(const program::DevicePoint& point) override;
  /// The rack was switched on: its modules may be others.
  void supply_came_on() noexcept { memory_layout_changed(); }
  program::DeviceError refresh(const program::DevicePoint& first, std::uint32_t count) override;
  void set_clock(std::chrono::local_seconds clock) override { rack_.set_clock(clock, now_); }

 private:
  Rack& rack_;
  can::Time now_{};
  std::array<std::uint16_t, 8> fx3_index_registers_{};
};

}  // namespace canopus::plc
