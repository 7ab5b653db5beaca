#include "canopus/plc/cpu/device_points.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace canopus::plc {

namespace {

constexpr std::uint32_t most_file_registers_named_r = 32768;

std::uint32_t& points_of(CpuModel& model, Device device) {
  return model.points[static_cast<std::size_t>(device)];
}

/// Devices whose points a project sets, by one name.
struct Setting {
  enum class Kind : std::uint8_t { bits, words, timers, file_registers };
  std::string_view name;
  Kind kind;
  std::array<Device, 3> devices;  // the same one again where there are fewer
};
using Kind = Setting::Kind;
constexpr std::array settings = {
    Setting{"M", Kind::bits, {Device::m, Device::m, Device::m}},
    Setting{"L", Kind::bits, {Device::l, Device::l, Device::l}},
    Setting{"F", Kind::bits, {Device::f, Device::f, Device::f}},
    Setting{"V", Kind::bits, {Device::v, Device::v, Device::v}},
    Setting{"B", Kind::bits, {Device::b, Device::b, Device::b}},
    Setting{"SB", Kind::bits, {Device::sb, Device::sb, Device::sb}},
    Setting{"T", Kind::timers, {Device::ts, Device::tc, Device::tn}},
    Setting{"ST", Kind::timers, {Device::sts, Device::stc, Device::stn}},
    Setting{"C", Kind::timers, {Device::cs, Device::cc, Device::cn}},
    Setting{"D", Kind::words, {Device::d, Device::d, Device::d}},
    Setting{"W", Kind::words, {Device::w, Device::w, Device::w}},
    Setting{"SW", Kind::words, {Device::sw, Device::sw, Device::sw}},
    Setting{"ZR", Kind::file_registers, {Device::zr, Device::zr, Device::r}},
};

const Setting* setting_named(std::string_view name) noexcept {
  const auto* found = std::ranges::find(settings, name, &Setting::name);
  return found == settings.end() ? nullptr : found;
}

/// A value, and a contact and a coil of one bit each.
constexpr std::uint32_t words_of_timers(std::uint32_t points) { return (points * 18 + 15) / 16; }

/// Points that can be set are a multiple of this.
std::uint32_t unit_of(const CpuModel& model, Kind kind) noexcept {
  if (kind == Kind::file_registers) return 1024;
  if (!model.iqr) return 16;
  switch (kind) {
    case Kind::bits: return 64;
    case Kind::timers: return 32;
    default: return 4;
  }
}

std::uint32_t most_of(const CpuModel& model, const Setting& setting) noexcept {
  constexpr std::uint32_t most_by_name = 32 * 1024;
  constexpr std::uint32_t most_relays_of_q = 60 * 1024;  // M, B
  const std::string_view name = setting.name;
  std::uint32_t most = model.device_words;
  switch (setting.kind) {
    case Kind::file_registers: return model.most_file_registers;
    case Kind::words: break;
    case Kind::bits: most *= 16; break;
    case Kind::timers: most = most * 16 / 18; break;
  }
  if (model.iqr && (name == "L" || name == "F" || name == "V")) most = std::min(most, most_by_name);
  if (!model.iqr) most = std::min(most, name == "M" || name == "B" ? most_relays_of_q : most_by_name);
  const std::uint32_t unit = unit_of(model, setting.kind);
  return most / unit * unit;
}

struct PointsRegister {
  std::uint16_t number;
  Device device;
  bool is_double = false;
};
// The registers of devices that this CPU has not read 0: S, and of the iQ-R series long timers and the like.
constexpr std::array registers_iqr = {
    PointsRegister{260, Device::x, true},   PointsRegister{262, Device::y, true},
    PointsRegister{264, Device::m, true},   PointsRegister{266, Device::b, true},
    PointsRegister{268, Device::sb, true},  PointsRegister{270, Device::f, true},
    PointsRegister{272, Device::v, true},   PointsRegister{274, Device::l, true},
    PointsRegister{280, Device::d, true},   PointsRegister{282, Device::w, true},
    PointsRegister{284, Device::sw, true},  PointsRegister{288, Device::tn, true},
    PointsRegister{290, Device::stn, true}, PointsRegister{292, Device::cn, true},
    PointsRegister{300, Device::z},         PointsRegister{306, Device::zr, true},
    PointsRegister{308, Device::rd, true},
};
constexpr std::array registers_q = {
    PointsRegister{286, Device::m, true},  PointsRegister{288, Device::b, true},
    PointsRegister{290, Device::x},        PointsRegister{291, Device::y},
    PointsRegister{292, Device::m},        PointsRegister{293, Device::l},
    PointsRegister{294, Device::b},        PointsRegister{295, Device::f},
    PointsRegister{296, Device::sb},       PointsRegister{297, Device::v},
    PointsRegister{299, Device::tn},       PointsRegister{300, Device::stn},
    PointsRegister{301, Device::cn},       PointsRegister{302, Device::d},
    PointsRegister{303, Device::w},        PointsRegister{304, Device::sw},
    PointsRegister{306, Device::zr, true}, PointsRegister{308, Device::d, true},
    PointsRegister{310, Device::w, true},
};

}  // namespace

bool has_settable_points(std::string_view device) noexcept { return setting_named(device) != nullptr; }

std::expected<void, std::string> set_device_points(CpuModel& model, std::string_view device,
                                                   std::int64_t points) {
  const Setting* const setting = setting_named(device);
  if (model.device_words == 0) {
    return std::unexpected("expected none: the devices of an " + std::string(model.name) + " are fixed");
  }
  if (setting == nullptr) {
    return std::unexpected(
        "expected a device whose points can be set: M, L, F, V, B, SB, T, ST, C, D, W, SW, ZR");
  }
  const std::uint32_t most = most_of(model, *setting);
  const std::uint32_t unit = unit_of(model, setting->kind);
  if (points < 0 || points > most || points % unit != 0) {
    return std::unexpected("expected 0 to " + std::to_string(most) + " points (" + std::string(model.name) +
                           "), a multiple of " + std::to_string(unit));
  }
  const auto count = static_cast<std::uint32_t>(points);
  for (const Device each : setting->devices) points_of(model, each) = count;
  std::uint32_t& named_r = points_of(model, Device::r);
  named_r = std::min(named_r, most_file_registers_named_r);
  return {};
}

std::expected<void, std::string> check_device_points(const CpuModel& model) {
  std::uint32_t words = (model.points_of(Device::x) + model.points_of(Device::y)) / 16;
  for (const Setting& setting : settings) {
    const std::uint32_t points = model.points_of(setting.devices[2]);
    switch (setting.kind) {
      case Kind::bits: words += points / 16; break;
      case Kind::words: words += points; break;
      case Kind::timers: words += words_of_timers(points); break;
      case Kind::file_registers: break;
    }
  }
  if (words <= model.device_words || model.device_words == 0) return {};
  return std::unexpected("with those that are not set here they need " + std::to_string(words) +
                         " words; expected at most " + std::to_string(model.device_words) + " (" +
                         std::string(model.name) + ", ZR not counted)");
}

std::optional<std::uint16_t> device_points_register(const CpuModel& model, std::uint32_t number) noexcept {
  if (model.family != CpuFamily::q && model.family != CpuFamily::iqr) return std::nullopt;
  if (number < (model.iqr ? 260U : 286U) || number > (model.iqr ? 309U : 311U)) return std::nullopt;
  const std::span<const PointsRegister> registers = model.iqr ? std::span<const PointsRegister>(registers_iqr)
                                                              : std::span<const PointsRegister>(registers_q);
  for (const PointsRegister& entry : registers) {
    const std::uint32_t points = model.points_of(entry.device);
    if (entry.is_double) {
      if (number == entry.number) return static_cast<std::uint16_t>(points);
      if (number == entry.number + 1U) return static_cast<std::uint16_t>(points >> 16U);
    } else if (number == entry.number) {
      return static_cast<std::uint16_t>(std::min(points, 32768U));  // more show in the double word
    }
  }
  return std::uint16_t{0};
}

}  // namespace canopus::plc
