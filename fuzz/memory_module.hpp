#pragma once
// A module of 3000 words that remember, for servers of a rack: a write beyond them is a write beyond this object.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>

#include "canopus/can/timeline.hpp"
#include "canopus/module/interface/module.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::fuzz {

class MemoryModule final : public module::Module,
                           public module::BufferMemoryAccess,
                           public module::SignalAccess {
 public:
  [[nodiscard]] std::string_view model() const noexcept override { return "MEMORY"; }
  [[nodiscard]] unsigned points() const noexcept override { return 32; }
  [[nodiscard]] module::BufferMemoryAccess* buffer_memory() noexcept override { return this; }
  [[nodiscard]] module::SignalAccess* signals() noexcept override { return this; }
  [[nodiscard]] module::BufferAddress buffer_memory_size() const noexcept override { return 3000; }
  [[nodiscard]] std::uint16_t peek(module::BufferAddress address, can::Time /*now*/) const override {
    return words_.at(address);
  }
  void write_word(module::BufferAddress address, std::uint16_t value, can::Time /*now*/) override {
    words_.at(address) = value;
  }
  [[nodiscard]] std::uint32_t inputs() const noexcept override { return outputs_; }
  [[nodiscard]] std::uint32_t outputs() const noexcept override { return outputs_; }
  void set_output(unsigned signal, bool on, can::Time /*now*/) override {
    if (signal >= 32) std::abort();
    outputs_ = on ? outputs_ | 1U << signal : outputs_ & ~(1U << signal);
  }
  void power_on(can::Time /*now*/) override { outputs_ = 0; }
  void power_off(can::Time /*now*/) override {}
  void cpu_changed(module::CpuState /*state*/, can::Time /*now*/) override {}
  void set_observer(module::ModuleObserver* /*observer*/) override {}
  void receive(const can::Frame& /*frame*/, can::Time /*now*/) override {}
  void tick(can::Time /*now*/) override {}

 private:
  std::array<std::uint16_t, 3000> words_{};
  std::uint32_t outputs_ = 0;
};

inline void expect(bool held) {
  if (!held) std::abort();
}

/// Gives a session the stream in chunks, and takes its replies as a slow client does: a part, and now and then nothing.
template <typename Session>
void converse(Session& session, std::span<const std::uint8_t> stream, std::size_t chunk) {
  const can::Time now{};
  while (!stream.empty() && !session.over()) {
    const auto space = session.space();
    expect(!space.empty() || !session.output().empty());
    const std::size_t count = std::min({chunk, stream.size(), space.size()});
    std::memcpy(space.data(), stream.data(), count);
    session.received(count);
    stream = stream.subspan(count);
    const bool has_room = session.output().empty();
    const bool has_request = session.has_request();
    const bool has_answered = session.process(now) != 0;
    expect(has_request || (!has_answered && !session.over()));
    expect(!has_request || !has_room || has_answered || session.over());
    expect(session.output().size() <= 65536);
    if (const std::size_t waiting = session.output().size(); waiting != 0)
      session.sent(count % 3 == 0 ? waiting : (waiting + 1) / 2);
    chunk = chunk % 977 + 3;
    if (count == 0) session.sent(session.output().size());
  }
  session.sent(session.output().size());
  while (session.process(now) != 0) session.sent(session.output().size());
  expect(session.over() || !session.space().empty());
}

}  // namespace canopus::fuzz
