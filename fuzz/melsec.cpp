// A client of the MELSEC protocol that sends anything, in chunks of any size, and takes its replies as it
// likes: the session neither crashes nor outgrows its buffers, and never gets stuck.

#include <memory>
#include <span>

#include "canopus/plc/melsec/session.hpp"

#include "memory_module.hpp"

using canopus::can::Time;
using canopus::fuzz::expect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const bool iqr = (data[0] & 1U) != 0;

  canopus::can::Timeline timeline;
  canopus::fuzz::MemoryModule module;
  canopus::plc::Rack rack(timeline, iqr ? canopus::plc::r04cpu() : canopus::plc::q03udvcpu());
  timeline.add(module);
  expect(rack.insert(0x20, module));
  rack.power_on(Time{});
  auto session = std::make_unique<canopus::plc::melsec::Session>(rack);
  canopus::fuzz::converse(*session, {data + 2, size - 2}, 1U + data[1]);
  return 0;
}
