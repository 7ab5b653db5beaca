// A client of the MELSEC protocol that sends anything, in chunks of any size, and takes its replies as it
// likes: the session neither crashes nor outgrows its buffers, and never gets stuck.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>

#include "canopus/can/timeline.hpp"
#include "canopus/module/interface/module.hpp"
#include "canopus/plc/melsec/session.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace {

using canopus::can::Time;

/// 3000 words that remember, so that a write beyond them is a write beyond this object.
class Memory final : public canopus::module::Module,
                     public canopus::module::BufferMemoryAccess,
                     public canopus::module::SignalAccess {
 public:
  [[nodiscard]] std::string_view model() const noexcept override { return "MEMORY"; }
  [[nodiscard]] unsigned points() const noexcept override { return 32; }
  [[nodiscard]] canopus::module::BufferMemoryAccess* buffer_memory() noexcept override { return this; }
  [[nodiscard]] canopus::module::SignalAccess* signals() noexcept override { return this; }
  [[nodiscard]] canopus::module::BufferAddress buffer_memory_size() const noexcept override { return 3000; }
  [[nodiscard]] std::uint16_t read_word(canopus::module::BufferAddress address, Time /*now*/) override {
    return words_.at(address);
  }
  void write_word(canopus::module::BufferAddress address, std::uint16_t value, Time /*now*/) override {
    words_.at(address) = value;
  }
  [[nodiscard]] std::uint32_t inputs() const noexcept override { return outputs_; }
  [[nodiscard]] std::uint32_t outputs() const noexcept override { return outputs_; }
  void set_output(unsigned signal, bool on, Time /*now*/) override {
    if (signal >= 32) std::abort();
    outputs_ = on ? outputs_ | 1U << signal : outputs_ & ~(1U << signal);
  }
  void power_on(Time /*now*/) override { outputs_ = 0; }
  void power_off(Time /*now*/) override {}
  void cpu_changed(canopus::module::CpuState /*state*/, Time /*now*/) override {}
  void set_observer(canopus::module::ModuleObserver* /*observer*/) override {}
  void receive(const canopus::can::Frame& /*frame*/, Time /*now*/) override {}
  void tick(Time /*now*/) override {}
  [[nodiscard]] Time deadline() const noexcept override { return canopus::can::never; }

 private:
  std::array<std::uint16_t, 3000> words_{};
  std::uint32_t outputs_ = 0;
};

void expect(bool held) {
  if (!held) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const bool iqr = (data[0] & 1U) != 0;
  std::size_t chunk = 1U + data[1];
  std::span<const std::uint8_t> stream(data + 2, size - 2);

  canopus::can::Timeline timeline;
  Memory module;
  canopus::plc::Rack rack(timeline, iqr ? canopus::plc::r04cpu() : canopus::plc::q03udvcpu());
  expect(rack.insert(0x20, module, timeline.add(module)));
  rack.power_on(Time{});
  auto session = std::make_unique<canopus::plc::melsec::Session>(rack);
  const Time now{};

  while (!stream.empty() && !session->over()) {
    const auto space = session->space();
    expect(!space.empty() || !session->output().empty());
    const std::size_t count = std::min({chunk, stream.size(), space.size()});
    std::memcpy(space.data(), stream.data(), count);
    session->received(count);
    stream = stream.subspan(count);
    (void)session->process(now);
    expect(session->output().size() <= 65536);
    // A slow client takes a part, and now and then nothing.
    if (const std::size_t waiting = session->output().size(); waiting != 0)
      session->sent(count % 3 == 0 ? waiting : (waiting + 1) / 2);
    chunk = chunk % 977 + 3;
    if (count == 0) session->sent(session->output().size());
  }
  session->sent(session->output().size());
  while (session->process(now) != 0) session->sent(session->output().size());
  expect(session->over() || !session->space().empty());
  return 0;
}
