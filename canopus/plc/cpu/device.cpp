#include "canopus/plc/cpu/device.hpp"

#include <algorithm>

namespace canopus::plc {

namespace {

constexpr std::array<DeviceInfo, device_count> infos = {{
    {"X", true, true},    {"Y", true, true},   {"M", true, false},   {"L", true, false},
    {"F", true, false},   {"V", true, false},  {"B", true, true},    {"SB", true, true},
    {"SM", true, false},  {"TS", true, false}, {"TC", true, false},  {"STS", true, false},
    {"STC", true, false}, {"CS", true, false}, {"CC", true, false},  {"D", false, false},
    {"W", false, true},   {"SW", false, true}, {"SD", false, false}, {"R", false, false},
    {"ZR", false, false}, {"Z", false, false}, {"TN", false, false}, {"STN", false, false},
    {"CN", false, false},
}};

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
     512},                                       // CN
    40 * kilo, 160 * kilo, 2 * kilo};

constexpr CpuModel model_q03udv = {
    "Q03UDVCPU", 0x0366, false, true,
    {8 * kilo, 8 * kilo, 8 * kilo, 8 * kilo,     // X Y M L
     2 * kilo, 2 * kilo, 8 * kilo, 2 * kilo,     // F V B SB
     2048, 2 * kilo, 2 * kilo, 0,                // SM TS TC STS
     0, kilo, kilo, 12 * kilo,                   // STC CS CC D
     8 * kilo, 2 * kilo, 2048, 32 * kilo,        // W SW SD R
     32 * kilo, 20, 2 * kilo, 0,                 // ZR Z TN STN
     kilo},                                      // CN
    29 * kilo, 96 * kilo, 0};
// clang-format on

}  // namespace

const DeviceInfo& device_info(Device device) noexcept { return infos[static_cast<std::size_t>(device)]; }

std::optional<Device> device_named(std::string_view name) noexcept {
  const auto* found = std::ranges::find(infos, name, &DeviceInfo::name);
  if (found == infos.end()) return std::nullopt;
  return static_cast<Device>(found - infos.begin());
}

const CpuModel& r04cpu() noexcept { return model_r04; }
const CpuModel& q03udvcpu() noexcept { return model_q03udv; }

const CpuModel* cpu_model_named(std::string_view name) noexcept {
  for (const CpuModel* model : {&model_r04, &model_q03udv})
    if (model->name == name) return model;
  return nullptr;
}

}  // namespace canopus::plc
