// A module of your own in a PLC's rack, in virtual time: a counter of what the nodes of a bus send. A PLC program reads it
// as any other module, here by FROM and TO, in a plant by the MC protocol.
//
//   cpp_module ../devices/io-block.eds
//
//   X0         module READY
//   Y0         rising edge: all counters to 0
//   G0         node to look at, 1 to 127
//   G1, G2     frames with this node-ID in their identifier: low word, high word
//   G3         age of its last frame in 10 ms; FFFFH: none, or older than that can say

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "canopus/can/timeline.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/observer.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/device/device.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;

class FrameCounter final : public module::Module,
                           private module::BufferMemoryAccess,
                           private module::SignalAccess {
 public:
  // module::Module: what the rack asks it, and tells it.
  [[nodiscard]] std::string_view model() const noexcept override { return "FRAME-COUNTER"; }
  [[nodiscard]] unsigned points() const noexcept override { return 16; }
  [[nodiscard]] BufferMemoryAccess* buffer_memory() noexcept override { return this; }
  [[nodiscard]] SignalAccess* signals() noexcept override { return this; }
  void power_on(can::Time) override {
    clear();
    node_ = 1;
    ready_ = true;
  }
  void power_off(can::Time) override {
    ready_ = false;
    outputs_ = 0;
  }
  void cpu_changed(module::CpuState, can::Time) override {}
  void set_observer(module::ModuleObserver*) override {}

  // can::Participant: what the bus tells it.
  void receive(const can::Frame& frame, can::Time now) override {
    if (!ready_ || frame.extended) return;
    Count& count = counts_[frame.identifier & 0x7F];
    ++count.frames;
    count.last = now;
  }
  void tick(can::Time) override {}

 private:
  struct Count {
    std::uint32_t frames = 0;
    can::Time last = can::never;
  };

  // module::BufferMemoryAccess
  [[nodiscard]] module::BufferAddress buffer_memory_size() const noexcept override { return 4; }
  [[nodiscard]] std::uint16_t peek(module::BufferAddress address, can::Time now) const override {
    const Count& count = counts_[node_];
    switch (address) {
      case 0: return node_;
      case 1: return static_cast<std::uint16_t>(count.frames & 0xFFFF);
      case 2: return static_cast<std::uint16_t>(count.frames >> 16);
      default: break;
    }
    if (count.last == can::never) return 0xFFFF;
    return static_cast<std::uint16_t>(std::min<std::int64_t>((now - count.last) / 10ms, 0xFFFF));
  }
  void write_word(module::BufferAddress address, std::uint16_t value, can::Time) override {
    if (address == 0 && value >= 1 && value <= 127) node_ = value;  // anything else changes nothing
  }

  // module::SignalAccess
  [[nodiscard]] std::uint32_t inputs() const noexcept override { return ready_ ? 1 : 0; }
  [[nodiscard]] std::uint32_t outputs() const noexcept override { return outputs_; }
  void set_output(unsigned signal, bool on, can::Time) override {
    if (signal == 0 && on && (outputs_ & 1) == 0) clear();
    const std::uint32_t bit = 1U << signal;
    outputs_ = on ? outputs_ | bit : outputs_ & ~bit;
  }

  void clear() { counts_.fill({}); }

  std::array<Count, 128> counts_{};
  std::uint16_t node_ = 1;
  std::uint32_t outputs_ = 0;
  bool ready_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s EDS-FILE\n", argv[0]), 2;
  std::ifstream stream(argv[1], std::ios::binary);
  const auto read = eds::read_device_file(std::string(std::istreambuf_iterator<char>(stream), {}));
  if (!read.file) {
    std::fprintf(stderr, "%s: %s\n", argv[1],
                 read.problems.empty() ? "cannot be read" : read.problems.front().message.c_str());
    return 1;
  }
  can::Timeline timeline;
  sim::Bus bus("line1", 125'000, timeline);
  can::Port& module_port = bus.add_port("module");
  can::Port& device_port = bus.add_port("device");

  sim::Device device(read.file, 5, device_port);
  timeline.add(device, "device");
  device_port.connect(device);
  FrameCounter counter;
  timeline.add(counter, "module");
  module_port.connect(counter);

  plc::Rack rack(timeline, plc::q03udvcpu());
  constexpr std::uint16_t head_address = 0x20;  // X20, Y20; U2\G
  if (!rack.insert(head_address, counter)) return std::fprintf(stderr, "no place for it\n"), 1;
  rack.power_on(timeline.now());
  device.power_on(timeline.now());
  // A heartbeat every 100 ms from now on, as if a master had written it.
  const std::array<std::uint8_t, 2> heartbeat_time{100, 0};
  if (device.node().dictionary().write(0x1017, 0, heartbeat_time, timeline.now()) != canopen::AbortCode::none)
    return 1;

  const std::array<std::uint16_t, 1> node{5};
  const auto write = [&] { return rack.write_buffer(head_address, 0, node, timeline.now()).has_value(); };
  const auto print = [&](const char* when) {
    std::array<std::uint16_t, 4> words{};
    if (!rack.read_buffer(head_address, 0, words, timeline.now())) return false;
    const unsigned frames = static_cast<unsigned>(words[2]) << 16 | words[1];
    std::printf("%9.6f  node %u, %s: %u frames, the last one %u ms ago\n", can::seconds(timeline.now()),
                static_cast<unsigned>(words[0]), when, frames, 10U * words[3]);
    return true;
  };
  if (!write()) return 1;
  timeline.run_until(can::Time{} + 1050ms);
  if (!print("after a second")) return 1;
  const std::array<std::uint8_t, 1> on{1};
  if (!rack.write_bits(plc::Device::y, head_address, on, timeline.now())) return 1;
  timeline.run_until(timeline.now() + 500ms);
  if (!print("half a second after Y20")) return 1;
  device.power_off();
  timeline.run_until(timeline.now() + 2s);
  return print("two seconds after it was switched off") ? 0 : 1;
}
