// A client of 1E frames, alone or beside 3E and 4E, that sends anything, in chunks of any size.

#include <memory>
#include <span>

#include "canopus/plc/melsec/session.hpp"

#include "memory_module.hpp"

using canopus::can::Time;
using canopus::fuzz::expect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace melsec = canopus::plc::melsec;
  if (size < 2) return 0;
  canopus::plc::CpuModel model = canopus::plc::r04cpu();
  if ((data[0] & 1U) != 0) model.name = "FX3U";  // other limits
  melsec::PortSettings settings{.takes_3e = (data[0] & 2U) != 0, .takes_1e = true};
  if ((data[0] & 4U) != 0)
    settings.code = (data[0] & 8U) != 0 ? melsec::DataCode::ascii : melsec::DataCode::binary;
  if ((data[0] & 16U) != 0) settings.write = canopus::plc::WritePermission::in_stop;

  canopus::can::Timeline timeline;
  canopus::fuzz::MemoryModule module;
  canopus::plc::Rack rack(timeline, model);
  timeline.add(module);
  expect(rack.insert(0x20, module));
  rack.power_on(Time{});
  auto session = std::make_unique<melsec::Session>(rack, std::move(settings));
  canopus::fuzz::converse(*session, {data + 2, size - 2}, 1U + data[1]);
  return 0;
}
