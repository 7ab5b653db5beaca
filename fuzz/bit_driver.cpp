// Raw bits of the bit driver, timed and triggered, against nodes that send. The run ends, and once the bits are over and
// nobody has anything left to send, the bus is idle and carries a frame again.

#include <string>

#include "canopus/sim/bus/bus.hpp"

#include "input.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;
using fuzz::expect;
using fuzz::Input;

struct Node final : can::Listener {
  explicit Node(can::Port& the_port) : port(the_port) {}
  void receive(const can::Frame& frame, can::Time) override { last = frame; }
  can::Port& port;
  can::Frame last;
};

sim::Fault driver(Input& input) {
  sim::Fault fault{.kind = sim::FaultKind::drive};
  fault.from = can::Time(input.byte() * 5us);
  fault.bit_time = (1 + input.byte()) * 20ns;
  if (input.flag()) {
    fault.field =
        static_cast<can::FrameField>(1 + input.choice(static_cast<unsigned>(can::FrameField::intermission)));
    fault.bit = input.choice(160);
    fault.count = input.choice(8);
  }
  for (unsigned levels = 1 + input.choice(64); levels > 0; --levels) {
    fault.levels.insert(fault.levels.end(), 1 + input.choice(8),
                        static_cast<sim::DrivenLevel>(input.choice(3)));
  }
  return fault;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  (void)sim::parse_levels({reinterpret_cast<const char*>(data), size});
  can::Timeline timeline;
  sim::Bus bus("bus", 1'000'000, timeline);
  Node a(bus.add_port("a"));
  Node b(bus.add_port("b"));
  Node c(bus.add_port("c"));  // acknowledges
  std::vector<sim::Fault> faults;
  for (unsigned count = 1 + input.choice(3); count > 0; --count) faults.push_back(driver(input));
  expect(bus.set_faults(faults, 1).has_value());
  a.port.connect(a);
  b.port.connect(b);
  c.port.connect(c);
  for (unsigned count = input.choice(6); count > 0; --count) {
    // Never the same identifier from both: two that send one and the same frame do so for ever.
    const bool is_a = input.flag();
    const std::uint8_t identifier = input.byte();
    const std::uint8_t data = input.byte();
    (void)(is_a ? a : b).port.send(can::data_frame(2U * identifier + (is_a ? 1 : 0), {data, data}));
  }
  timeline.run_until(can::Time(500ms));
  expect(bus.set_faults({}, 1).has_value());
  timeline.run_until(can::Time(1s));
  const can::Frame frame = can::data_frame(0x7A5, {1, 2, 3});
  expect(a.port.send(frame));
  timeline.run_until(can::Time(1s) + 5ms);
  expect(b.last == frame && c.last == frame);
  return 0;
}
