// A client of Modbus TCP that sends anything, in chunks of any size, and takes its replies as it likes: the session
// neither crashes nor outgrows its buffers, and never gets stuck.

#include <memory>
#include <span>

#include "canopus/plc/modbus/as300_map.hpp"
#include "canopus/plc/modbus/session.hpp"

#include "memory_module.hpp"

using canopus::can::Time;
using canopus::fuzz::expect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace modbus = canopus::plc::modbus;
  using modbus::Table;
  if (size < 2) return 0;
  const std::size_t chunk = 1U + data[1];
  const std::span<const std::uint8_t> stream(data + 2, size - 2);

  canopus::can::Timeline timeline;
  canopus::fuzz::MemoryModule module;
  canopus::plc::Rack rack(timeline);
  timeline.add(module);
  expect(rack.insert(0x20, module));
  rack.power_on(Time{});
  modbus::Settings settings;
  switch (data[0] % 3) {
    case 0: settings.map = modbus::default_map(rack.model()); break;
    case 1:
      settings.map = modbus::as300_map(rack.model());
      settings.limits = modbus::as300_limits();
      settings.unit = 1;
      break;
    default:
      using canopus::plc::Device;
      (void)settings.map.add(Table::coils, {0, 100, {true, Device::d, 0x20, 2990}, false});
      (void)settings.map.add(Table::coils, {100, 100, {false, Device::y, 0, 0x10}, false});
      (void)settings.map.add(Table::discrete_inputs, {3, 200, {false, Device::d, 0, 18420}, false});
      (void)settings.map.add(Table::holding_registers, {0, 100, {false, Device::m, 0, 7}, false});
      (void)settings.map.add(Table::holding_registers, {100, 60000, {true, Device::d, 0x20, 2900}, false});
      (void)settings.map.add(Table::input_registers, {0, 65536, {false, Device::zr, 0, 0}, false});
      settings.identification.objects = {
          "a", "b", "c", "", std::string(200, 'x'), "d", std::string(400, 'y')};
  }
  if (data[0] >= 128) settings.framing = modbus::Framing::rtu;
  auto session = std::make_unique<modbus::Session>(rack, settings, settings.write);
  canopus::fuzz::converse(*session, stream, chunk);
  return 0;
}
