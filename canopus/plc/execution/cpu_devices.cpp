#include "canopus/plc/execution/cpu_devices.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "canopus/ascii/words.hpp"
#include "canopus/plc/rack/rack_address.hpp"

namespace canopus::plc {

namespace {

using program::DeviceError;
using program::DevicePoint;

DeviceError error_of(const Rack::Access& access) {
  if (access) return DeviceError::none;
  return access.error() == AccessError::no_module ? DeviceError::no_module : DeviceError::out_of_range;
}

std::uint16_t head_of(const DevicePoint& point) { return static_cast<std::uint16_t>(16U * point.unit); }

/// The index registers Z0 to Z7 of an FX3, which the table of its devices for clients does not have.
std::optional<DevicePoint> fx3_index_register(const CpuModel& model, std::string_view name) {
  if (model.family != CpuFamily::fx3 || name.size() != 2 || name[0] != 'Z' || name[1] < '0' || name[1] > '7')
    return std::nullopt;
  return DevicePoint{.device = static_cast<std::uint16_t>(Device::z),
                     .number = static_cast<std::uint32_t>(name[1] - '0')};
}

bool is_fx3_index_register(const CpuModel& model, const DevicePoint& point) {
  return model.family == CpuFamily::fx3 && !point.is_buffer &&
         point.device == static_cast<std::uint16_t>(Device::z);
}

}  // namespace

std::expected<DevicePoint, std::string> CpuDeviceNames::point(std::string_view name) const {
  if (const auto register_of_fx3 = fx3_index_register(model_, name)) return *register_of_fx3;
  std::string text(name);
  if (model_.family == CpuFamily::as300 && text.starts_with("SR")) text[1] = 'D';
  const auto address = parse_rack_address(text, model_.number_base(Device::x));
  if (!address) return std::unexpected("expected a device of the " + std::string(model_.name));
  if (address->is_buffer)
    return DevicePoint{.unit = static_cast<std::uint16_t>(address->head_address / 16U),
                       .number = address->number,
                       .is_buffer = true};
  if (!model_.has(address->device, address->number, 1))
    return std::unexpected("the " + std::string(model_.name) + " has no such device");
  return DevicePoint{.device = static_cast<std::uint16_t>(address->device),
                     .number = address->number,
                     .is_bit = device_info(address->device).is_bit};
}

// Of B, W, SB and SW the first digit is to be one of 0 to 9: BAD is no device.
bool CpuDeviceNames::looks_like_device(std::string_view name) const {
  if (fx3_index_register(model_, name)) return true;
  const std::size_t digit = name.find_first_of("0123456789");
  if (digit == std::string_view::npos || digit == 0) return false;
  std::string text(name);
  if (model_.family == CpuFamily::as300 && text.starts_with("SR")) text[1] = 'D';
  const std::string_view letters = std::string_view(text).substr(0, digit);
  const bool is_x_or_y = letters.size() > 1 && (letters[0] == 'X' || letters[0] == 'Y');  // XA0
  const auto address = parse_rack_address(text, model_.number_base(Device::x));
  return address && model_.points_of(address->device) != 0 &&
         (is_x_or_y || device_named(letters).has_value());
}

DeviceError CpuDevices::read_words(const DevicePoint& first, std::span<std::uint16_t> words) {
  if (first.is_buffer) return error_of(rack_.read_buffer(head_of(first), first.number, words, now_));
  if (is_fx3_index_register(rack_.model(), first)) {
    if (first.number + words.size() > fx3_index_registers_.size()) return DeviceError::out_of_range;
    std::ranges::copy_n(fx3_index_registers_.begin() + first.number, std::ssize(words), words.begin());
    return DeviceError::none;
  }
  return error_of(rack_.read_words(static_cast<Device>(first.device), first.number, words, now_));
}

DeviceError CpuDevices::write_words(const DevicePoint& first, std::span<const std::uint16_t> words) {
  if (first.is_buffer) return error_of(rack_.write_buffer(head_of(first), first.number, words, now_));
  if (is_fx3_index_register(rack_.model(), first)) {
    if (first.number + words.size() > fx3_index_registers_.size()) return DeviceError::out_of_range;
    std::ranges::copy(words, fx3_index_registers_.begin() + first.number);
    return DeviceError::none;
  }
  return error_of(rack_.write_words(static_cast<Device>(first.device), first.number, words, now_));
}

std::uint16_t* CpuDevices::words_in_memory(const DevicePoint& first, unsigned count) {
  if (first.is_buffer) return nullptr;
  if (!is_fx3_index_register(rack_.model(), first))
    return rack_.words_in_memory(static_cast<Device>(first.device), first.number, count);
  return first.number + count > fx3_index_registers_.size() ? nullptr : &fx3_index_registers_[first.number];
}

std::uint8_t* CpuDevices::bit_in_memory(const DevicePoint& point) {
  return point.is_buffer ? nullptr : rack_.bit_in_memory(static_cast<Device>(point.device), point.number);
}

DeviceError CpuDevices::read_bits(const DevicePoint& first, unsigned count, std::uint32_t& bits) {
  std::array<std::uint8_t, 32> each{};
  const Rack::Access access =
      rack_.read_bits(static_cast<Device>(first.device), first.number, std::span(each).first(count), now_);
  bits = 0;
  for (unsigned i = 0; i < count; ++i) bits |= std::uint32_t{each[i]} << i;
  return error_of(access);
}

DeviceError CpuDevices::refresh(const DevicePoint& first, std::uint32_t count) {
  return error_of(rack_.refresh(static_cast<Device>(first.device), first.number, count, now_));
}

DeviceError CpuDevices::write_bits(const DevicePoint& first, unsigned count, std::uint32_t bits) {
  std::array<std::uint8_t, 32> each{};
  for (unsigned i = 0; i < count; ++i) each[i] = bits >> i & 1U;
  return error_of(rack_.write_bits(static_cast<Device>(first.device), first.number,
                                   std::span<const std::uint8_t>(each).first(count), now_));
}

}  // namespace canopus::plc
