#pragma once
// A module of 32 points and plain memory that notes what the rack tells it.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/observer.hpp"

namespace canopus::plc::testing {

class FakeModule : public module::Module, public module::BufferMemoryAccess, public module::SignalAccess {
 public:
  explicit FakeModule(unsigned points = 32, module::BufferAddress size = 65536)
      : points_(points), size_(size) {}

  [[nodiscard]] std::string_view model() const noexcept override { return "FAKE"; }
  [[nodiscard]] unsigned points() const noexcept override { return points_; }
  [[nodiscard]] module::BufferMemoryAccess* buffer_memory() noexcept override { return this; }
  [[nodiscard]] module::SignalAccess* signals() noexcept override { return this; }
  [[nodiscard]] module::BufferAddress buffer_memory_size() const noexcept override { return size_; }
  [[nodiscard]] std::uint16_t program_read(module::BufferAddress address, can::Time now) override {
    last_time = now;
    ++reads;
    return peek(address, now);
  }
  [[nodiscard]] std::uint16_t peek(module::BufferAddress address, can::Time) const override {
    const auto found = words.find(address);
    return found == words.end() ? std::uint16_t{0} : found->second;
  }
  void write_word(module::BufferAddress address, std::uint16_t value, can::Time now) override {
    last_time = now;
    writes.emplace_back(address, value);
    if (!read_only.contains(address)) words[address] = value;
    if (wakes_after_write) alarm() = now + std::chrono::milliseconds(1);
  }
  [[nodiscard]] std::uint32_t inputs() const noexcept override { return x; }
  [[nodiscard]] std::uint32_t outputs() const noexcept override { return y; }
  void set_output(unsigned signal, bool on, can::Time now) override {
    last_time = now;
    y = on ? y | 1U << signal : y & ~(1U << signal);
    edges.emplace_back(signal, on);
  }
  void power_on(can::Time /*now*/) override { ++power_ons; }
  void power_off(can::Time /*now*/) override { ++power_offs; }
  void cpu_changed(module::CpuState state, can::Time /*now*/) override { states.push_back(state); }

  void set_observer(module::ModuleObserver* /*observer*/) override {}

  void receive(const can::Frame& /*frame*/, can::Time /*now*/) override {}
  void tick(can::Time now) override {
    ticks.push_back(now);
    alarm().cancel();
  }

  std::map<module::BufferAddress, std::uint16_t> words;
  std::set<module::BufferAddress> read_only;  ///< a write changes nothing, as the modules' manuals say
  std::vector<std::pair<module::BufferAddress, std::uint16_t>> writes;
  std::vector<std::pair<unsigned, bool>> edges;
  std::vector<module::CpuState> states;
  std::vector<can::Time> ticks;
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  int reads = 0;
  int power_ons = 0;
  int power_offs = 0;
  bool wakes_after_write = false;
  can::Time last_time{};

 private:
  unsigned points_;
  module::BufferAddress size_;
};

}  // namespace canopus::plc::testing
