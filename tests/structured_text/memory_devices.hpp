#pragma once
// Devices of a CPU that are plain memory: X Y M (bits, numbers in octal for X and Y as of an FX), D and Z (words), and one module, U0.

#include <array>
#include <string>
#include <vector>

#include "canopus/ascii/number.hpp"
#include "canopus/program/device_image.hpp"

namespace memory_devices {

using canopus::program::DeviceError;
using canopus::program::DevicePoint;

class MemoryDevices final : public canopus::program::DeviceImage, public canopus::program::DeviceNames {
 public:
  std::array<std::vector<std::uint16_t>, 5> memory{
      std::vector<std::uint16_t>(256), std::vector<std::uint16_t>(256), std::vector<std::uint16_t>(256),
      std::vector<std::uint16_t>(256), std::vector<std::uint16_t>(20)};
  std::vector<std::uint16_t> buffer = std::vector<std::uint16_t>(100);

  std::uint16_t& word(char device, std::size_t number) {
    return memory.at(std::string("XYMDZ").find(device)).at(number);
  }

  DeviceError read_words(const DevicePoint& first, std::span<std::uint16_t> words) override {
    const auto from = range(first, words.size());
    if (from.empty())
      return first.is_buffer && first.unit != 0 ? DeviceError::no_module : DeviceError::out_of_range;
    std::copy(from.begin(), from.end(), words.begin());
    return DeviceError::none;
  }
  DeviceError write_words(const DevicePoint& first, std::span<const std::uint16_t> words) override {
    const auto to = range(first, words.size());
    if (to.empty())
      return first.is_buffer && first.unit != 0 ? DeviceError::no_module : DeviceError::out_of_range;
    std::copy(words.begin(), words.end(), to.begin());
    return DeviceError::none;
  }
  DeviceError read_bits(const DevicePoint& first, unsigned count, std::uint32_t& bits) override {
    const auto from = range(first, count);
    if (from.empty()) return DeviceError::out_of_range;
    bits = 0;
    for (unsigned i = 0; i < count; ++i) bits |= std::uint32_t{from[i]} << i;
    return DeviceError::none;
  }
  DeviceError write_bits(const DevicePoint& first, unsigned count, std::uint32_t bits) override {
    const auto to = range(first, count);
    if (to.empty()) return DeviceError::out_of_range;
    for (unsigned i = 0; i < count; ++i) to[i] = bits >> i & 1U;
    return DeviceError::none;
  }

  [[nodiscard]] std::expected<DevicePoint, std::string> point(std::string_view name) const override {
    DevicePoint point;
    if (name.starts_with('U')) {
      const std::size_t slash = name.find("\\G");
      const auto unit = canopus::ascii::parse_number<std::uint16_t>(name.substr(1, slash - 1), 16);
      const auto number = slash == std::string_view::npos
                              ? std::nullopt
                              : canopus::ascii::parse_number<std::uint32_t>(name.substr(slash + 2));
      if (!unit || !number) return std::unexpected("expected buffer memory such as U0\\G25");
      point = {.unit = *unit, .number = *number, .is_buffer = true};
      return point;
    }
    const std::size_t device = std::string("XYMDZ").find(name.front());
    const auto number = canopus::ascii::parse_number<std::uint32_t>(name.substr(1), device < 2 ? 8 : 10);
    if (device == std::string::npos || !number) return std::unexpected("expected a device");
    point.device = static_cast<std::uint16_t>(device);
    point.number = *number;
    point.is_bit = device < 3;
    if (*number >= memory.at(device).size()) return std::unexpected("expected a smaller number");
    return point;
  }
  [[nodiscard]] bool looks_like_device(std::string_view name) const override {
    return name.size() > 1 && std::string("XYMDZ").contains(name.front()) &&
           name.find_first_not_of("0123456789", 1) == std::string_view::npos;
  }

 private:
  std::span<std::uint16_t> range(const DevicePoint& first, std::size_t count) {
    std::vector<std::uint16_t>& words = first.is_buffer ? buffer : memory.at(first.device);
    if ((first.is_buffer && first.unit != 0) || first.number + count > words.size()) return {};
    return std::span(words).subspan(first.number, count);
  }
};

}  // namespace memory_devices
