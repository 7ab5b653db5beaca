#include "canopus/plc/cpu/device.hpp"

#include <algorithm>

namespace canopus::plc {

namespace {

constexpr std::array<DeviceInfo, device_count> infos = {{
    {"X", true, true},    {"Y", true, true},          {"M", true, false},   {"L", true, false},
    {"F", true, false},   {"V", true, false},         {"B", true, true},    {"SB", true, true},
    {"SM", true, false},  {"TS", true, false},        {"TC", true, false},  {"STS", true, false},
    {"STC", true, false}, {"CS", true, false},        {"CC", true, false},  {"D", false, false},
    {"W", false, true},   {"SW", false, true},        {"SD", false, false}, {"R", false, false},
    {"ZR", false, false}, {"Z", false, false},        {"TN", false, false}, {"STN", false, false},
    {"CN", false, false}, {"S", true, false},         {"HCS", true, false}, {"HCN", false, false},
    {"RD", false, false}, {"U3E0\\HG", false, false},
}};

constexpr std::array<FamilyInfo, family_count> families = {{
    {"Q", {"head", "a head I/O number is a multiple of 10H from 0 to 0FF0H", 0, 0xFF0, 16}, true, false},
    {"iQ-R", {"head", "a head I/O number is a multiple of 10H from 0 to 0FF0H", 0, 0xFF0, 16}, true, false},
    {"FX3",
     {"position", "special function blocks are number 0 to 7, from the main unit on", 0, 7},
     false,
     true},
    {"FX5", {"unit", "unit numbers are 1 to 16, from the CPU module on", 1, 16}, false, true},
    {"AS300", {"card", "function cards are in slot 1 or 2", 1, 2}, false, false},
}};

/// First special relay M and special register D of an FX3.
constexpr std::uint32_t first_special = 8000;
constexpr std::uint32_t end_of_specials = 8512;

constexpr std::uint32_t kilo = 1024;

// clang-format off
constexpr CpuModel model_r04 = {
    "R04CPU", 0x4800, true, false,
    {12 * kilo, 12 * kilo, 12 * kilo, 8 * kilo,  // X Y M L
     2 * kilo, 2 * kilo, 8 * kilo, 2 * kilo,     // F V B SB
     4096, kilo, kilo, 0,                        // SM TS TC STS
     0, 512, 512, 18 * kilo,                     // STC CS CC D
     8 * kilo, 2 * kilo, 4096, 32 * kilo,        // W SW SD R
     32 * kilo, 20, kilo, 0,                     // ZR Z TN STN
     512, 0, 0, 0,                               // CN S HCS HCN
     512 * kilo, 12 * kilo},                     // RD HG
    40 * kilo, 160 * kilo, 2 * kilo, CpuFamily::iqr};

constexpr CpuModel model_q03udv = {
    "Q03UDVCPU", 0x0366, false, true,
    {8 * kilo, 8 * kilo, 8 * kilo, 8 * kilo,     // X Y M L
     2 * kilo, 2 * kilo, 8 * kilo, 2 * kilo,     // F V B SB
     2048, 2 * kilo, 2 * kilo, 0,                // SM TS TC STS
     0, kilo, kilo, 12 * kilo,                   // STC CS CC D
     8 * kilo, 2 * kilo, 2048, 32 * kilo,        // W SW SD R
     32 * kilo, 20, 2 * kilo, 0,                 // ZR Z TN STN
     kilo, 0, 0, 0, 0},                          // CN S HCS HCN RD
    29 * kilo, 96 * kilo, 0, CpuFamily::q};

constexpr CpuModel model_fx3u = {
    "FX3U", 0x00F3, false, false,
    {248, 248, 7680, 0,        // X Y M L
     0, 0, 0, 0,               // F V B SB
     0, 512, 512, 0,           // SM TS TC STS
     0, 256, 256, 8000,        // STC CS CC D
     0, 0, 0, 32 * kilo,       // W SW SD R
     0, 0, 512, 0,             // ZR Z TN STN
     256, 4096, 0, 56, 0},     // CN S HCS HCN RD
    0, 0, 0, CpuFamily::fx3};

constexpr CpuModel model_fx5u = {
    "FX5U", 0, true, false,
    {kilo, kilo, 7680, 7680,   // X Y M L
     128, 0, 256, 512,         // F V B SB
     10000, 512, 512, 16,      // SM TS TC STS
     16, 256, 256, 8000,       // STC CS CC D
     512, 512, 12000, 32 * kilo,  // W SW SD R
     0, 20, 512, 16,           // ZR Z TN STN
     256, 4096, 0, 0, 0},      // CN S HCS HCN RD
    0, 0, 0, CpuFamily::fx5};

constexpr CpuModel model_as300 = {
    "AS300", 0, false, false,
    {kilo, kilo, 8192, 0,      // X Y M L
     0, 0, 0, 0,               // F V B SB
     2048, 512, 512, 0,        // SM TS TC STS
     0, 512, 512, 30000,       // STC CS CC D
     0, 0, 2048, 0,            // W SW SD (SR) R
     0, 0, 512, 0,             // ZR Z TN STN
     512, 2048, 256, 512, 0},  // CN S HCS HCN RD
    0, 0, 0, CpuFamily::as300};

constexpr std::array models = {&model_r04, &model_q03udv, &model_fx3u, &model_fx5u, &model_as300};
constexpr std::array<std::string_view, models.size()> model_names = {
    model_r04.name, model_q03udv.name, model_fx3u.name, model_fx5u.name, model_as300.name};
// clang-format on

}  // namespace

const DeviceInfo& device_info(Device device) noexcept { return infos[static_cast<std::size_t>(device)]; }

std::optional<Device> device_named(std::string_view name) noexcept {
  const auto* found = std::ranges::find(infos, name, &DeviceInfo::name);
  if (found == infos.end()) return std::nullopt;
  return static_cast<Device>(found - infos.begin());
}

const FamilyInfo& family_info(CpuFamily family) noexcept {
  return families[static_cast<std::size_t>(family)];
}

std::optional<CpuFamily> family_named(std::string_view name) noexcept {
  const auto* found = std::ranges::find(families, name, &FamilyInfo::name);
  if (found == families.end()) return std::nullopt;
  return static_cast<CpuFamily>(found - families.begin());
}

std::uint32_t CpuModel::end_of(Device device) const noexcept {
  const bool has_specials = family == CpuFamily::fx3 && (device == Device::m || device == Device::d);
  return has_specials ? end_of_specials : points_of(device);
}

bool CpuModel::has(Device device, std::uint32_t first, std::uint32_t count) const noexcept {
  const auto are_within = [&](std::uint32_t begin, std::uint32_t end) {
    return first >= begin && first < end && count <= end - first;
  };
  return are_within(0, points_of(device)) ||
         (end_of(device) != points_of(device) && are_within(first_special, end_of_specials));
}

Device CpuModel::special_relay() const noexcept { return family == CpuFamily::fx3 ? Device::m : Device::sm; }

Device CpuModel::special_register() const noexcept {
  return family == CpuFamily::fx3 ? Device::d : Device::sd;
}

unsigned CpuModel::number_base(Device device) const noexcept {
  const bool is_io = device == Device::x || device == Device::y;
  if (is_io && family_info(family).counts_octal) return 8;
  if (is_io && family == CpuFamily::as300) return 10;
  return device_info(device).hexadecimal ? 16 : 10;
}

std::string_view CpuModel::name_of(Device device) const noexcept {
  return family == CpuFamily::as300 && device == Device::sd ? "SR" : device_info(device).name;
}

const CpuModel& fx3u() noexcept { return model_fx3u; }
const CpuModel& fx5u() noexcept { return model_fx5u; }
const CpuModel& as300() noexcept { return model_as300; }

const CpuModel& default_model(CpuFamily family) noexcept {
  switch (family) {
    case CpuFamily::q: return model_q03udv;
    case CpuFamily::iqr: return model_r04;
    case CpuFamily::fx3: return model_fx3u;
    case CpuFamily::fx5: return model_fx5u;
    case CpuFamily::as300: break;
  }
  return model_as300;
}

std::span<const std::string_view> cpu_model_names() noexcept { return model_names; }

const CpuModel& r04cpu() noexcept { return model_r04; }
const CpuModel& q03udvcpu() noexcept { return model_q03udv; }

const CpuModel* cpu_model_named(std::string_view name) noexcept {
  for (const CpuModel* model : models)
    if (model->name == name) return model;
  return nullptr;
}

}  // namespace canopus::plc
