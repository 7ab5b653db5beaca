// Any text as a plant file: every mistake has a message and a place inside the text, and what is read without
// a mistake is within its ranges.

#include "canopus/plant/file/plant_file.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "input.hpp"

namespace {
constexpr std::uint8_t no_node_id = 0xFF;
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace canopus;
  using fuzz::expect;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
  const plant::PlantReading reading = plant::read_plant(text, "plant.toml");
  for (const text::FileError& error : reading.errors) {
    expect(!error.message.empty() && error.place.line <= lines);
    expect(text::describe(error, "plant.toml").starts_with("plant.toml:"));
  }
  if (!reading.errors.empty()) return 0;
  const plant::PlantFile& plant = reading.plant;
  for (const plant::BusSection& bus : plant.buses) {
    expect(!bus.name.empty() && bus.bit_rate >= 10'000 && bus.bit_rate <= 1'000'000);
    for (const plant::FaultSection& section : bus.faults) {
      expect(section.fault.delay >= can::Duration{} && section.fault.interval >= can::Duration{});
      const can::Frame& frame = section.fault.frame;
      expect(std::ranges::all_of(frame.data.begin() + static_cast<std::ptrdiff_t>(frame.length()),
                                 frame.data.end(), [](std::uint8_t byte) { return byte == 0; }));
      expect(section.fault.probability >= 0 && section.fault.probability <= 1);
    }
  }
  const auto has_bus = [&plant](const std::string& name) {
    return std::ranges::any_of(plant.buses, [&name](const auto& bus) { return bus.name == name; });
  };
  for (const plant::DeviceSection& device : plant.devices) {
    expect(has_bus(device.bus) && (device.node <= 127 || device.node == no_node_id));
    expect(device.start >= can::Duration{});
    for (const plant::BehaviourSection& behaviour : device.behaviours) {
      expect(!behaviour.period || *behaviour.period > can::Duration{});
      expect(!behaviour.low || std::isfinite(*behaviour.low));
      expect(!behaviour.high || std::isfinite(*behaviour.high));
      expect(!behaviour.step || std::isfinite(*behaviour.step));
    }
  }
  for (const plant::PlcSection& plc : plant.plcs) {
    for (const plant::ModuleSection& module : plc.modules) {
      expect(has_bus(module.bus) && module.node <= 127);
      expect(!module.exchange || *module.exchange > can::Duration{});
      for (const plant::SlaveSection& slave : module.slaves) expect(slave.node >= 1 && slave.node <= 127);
    }
  }
  return 0;
}
