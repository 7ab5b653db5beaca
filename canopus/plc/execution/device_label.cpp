#include "canopus/plc/execution/device_label.hpp"

#include <array>
#include <span>

#include "canopus/plc/execution/cpu_devices.hpp"
#include "canopus/program/data_type.hpp"

namespace canopus::plc {

namespace {

using program::Slot;

/// A label's device and how its value lies there.
struct Place {
  program::DevicePoint point{};
  program::DataType type{};
  std::size_t words = 0;  ///< 0: a bit
};

std::expected<Place, std::string> place_of(const Rack& rack, const DeviceLabel& label) {
  const auto wrong = [&](const std::string& what) {
    return std::unexpected("'" + label.name + "' at " + label.device + ": " + what);
  };
  const auto type = program::elementary_named(label.type);
  if (!type || program::info(*type).family == program::Family::string)
    return wrong("its type is " + label.type + "; expected an elementary one");
  const auto point = CpuDeviceNames(rack.model()).point(label.device);
  if (!point) return wrong(point.error());
  const unsigned bits = program::info(*type).bits;
  Place place{.point = *point, .type = {.base = *type, .name = label.type}, .words = bits / 16U};
  if (point->is_bit != (bits == 1) || bits == 8)
    return wrong("a value of type " + label.type + " does not lie there");
  return place;
}

}  // namespace

std::expected<std::string, std::string> read_label(Rack& rack, const DeviceLabel& label, can::Time now) {
  const auto place = place_of(rack, label);
  if (!place) return std::unexpected(place.error());
  CpuDevices devices(rack);
  devices.set_time(now);
  Slot value = 0;
  program::DeviceError error = program::DeviceError::none;
  if (place->words == 0) {
    std::uint32_t bit = 0;
    error = devices.read_bits(place->point, 1, bit);
    value = bit;
  } else {
    std::array<std::uint16_t, 4> words{};
    error = devices.read_words(place->point, std::span(words).first(place->words));
    for (std::size_t i = 0; i < place->words; ++i) value |= Slot{words[i]} << (16 * i);
    if (program::info(place->type.base).family == program::Family::signed_integer && place->words < 4) {
      const auto shift = static_cast<unsigned>(64 - 16 * place->words);
      value = static_cast<Slot>(static_cast<std::int64_t>(value << shift) >> shift);
    }
  }
  if (error != program::DeviceError::none)
    return std::unexpected("'" + label.name + "': " + label.device + " is not there");
  return program::value_text(place->type, &value);
}

std::expected<void, std::string> write_label(Rack& rack, const DeviceLabel& label, std::string_view value,
                                             can::Time now) {
  const auto place = place_of(rack, label);
  if (!place) return std::unexpected(place.error());
  Slot slot = 0;
  if (const auto wrong = program::parse_value(place->type, value, &slot)) return std::unexpected(*wrong);
  CpuDevices devices(rack);
  devices.set_time(now);
  program::DeviceError error = program::DeviceError::none;
  if (place->words == 0) {
    error = devices.write_bits(place->point, 1, static_cast<std::uint32_t>(slot));
  } else {
    std::array<std::uint16_t, 4> words{};
    for (std::size_t i = 0; i < place->words; ++i) words[i] = static_cast<std::uint16_t>(slot >> (16 * i));
    error = devices.write_words(place->point, std::span<const std::uint16_t>(words).first(place->words));
  }
  if (error != program::DeviceError::none)
    return std::unexpected("'" + label.name + "': " + label.device + " is not there");
  return {};
}

}  // namespace canopus::plc
