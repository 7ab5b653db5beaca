#pragma once
// A communication module unlike any there is: no signals, requests as bits of words, few words, two bit
// rates. Notes the settings it gets.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/module/interface/observer.hpp"
#include "canopus/module/interface/program_interface.hpp"

namespace canopus::support {

class FakeCommunicationModule final : public module::CommunicationModule,
                                      public module::BufferMemoryAccess,
                                      public module::SignalAccess {
 public:
  static constexpr module::BufferAddress exchange_word = 41;
  static constexpr module::BufferAddress status_word = 43;
  static constexpr std::array bit_rates{module::BusLength{500, 100}, module::BusLength{20, 2500}};
  static constexpr module::DataSheet data_sheet{.model = "FAKE", .bus_lengths = bit_rates};

  module::ProgramInterface asked{
      .exchange = {.kind = module::ProgramRequest::Kind::bits, .word = exchange_word, .bits = 1},
      .status = status_word,
      .initializing = 0x0080,
      .process_data = {.receive_first = 500, .transmit_first = 600, .words = 8, .pdos = 2}};
  std::map<module::BufferAddress, std::uint16_t> words;
  std::vector<std::string> presets;
  module::ModuleObserver* observer = nullptr;

  bool preset_word(module::BufferAddress address, std::uint16_t value) override {
    presets.push_back(fmt::format("G{} = {}", address, value));
    return true;
  }
  bool preset_bit_rate(std::uint32_t bit_rate) override {
    presets.push_back(fmt::format("{} bit/s", bit_rate));
    return bit_rate == 500'000 || bit_rate == 20'000;
  }
  bool preset_node_id(std::uint8_t node_id) override {
    presets.push_back(fmt::format("node {}", node_id));
    return node_id < 100;
  }
  canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                   std::span<const std::uint8_t> value) override {
    std::uint32_t number = 0;
    for (std::size_t i = value.size(); i-- > 0;) number = number << 8U | value[i];
    presets.push_back(fmt::format("{:04X}:{:02X} = {:X}", index, sub, number));
    return canopen::AbortCode::none;
  }
  [[nodiscard]] bool takes_word(module::BufferAddress, std::uint16_t) const override { return true; }
  [[nodiscard]] const module::ProgramInterface& program_interface() const noexcept override { return asked; }
  [[nodiscard]] const canopen::Node& node() const noexcept override { return node_; }
  [[nodiscard]] std::uint64_t change_count() const noexcept override { return 0; }
  [[nodiscard]] std::vector<module::Led> leds(can::Time) const override { return {}; }
  [[nodiscard]] std::uint32_t flash_writes() const noexcept override { return 0; }

  [[nodiscard]] std::string_view model() const noexcept override { return data_sheet.model; }
  [[nodiscard]] unsigned points() const noexcept override { return 0; }
  [[nodiscard]] module::BufferMemoryAccess* buffer_memory() noexcept override { return this; }
  [[nodiscard]] module::SignalAccess* signals() noexcept override { return this; }
  [[nodiscard]] module::BufferAddress buffer_memory_size() const noexcept override { return 700; }
  [[nodiscard]] std::uint16_t peek(module::BufferAddress address, can::Time) const override {
    const auto word = words.find(address);
    return word == words.end() ? std::uint16_t{0} : word->second;
  }
  void write_word(module::BufferAddress address, std::uint16_t value, can::Time now) override {
    words[address] = value;
    if (observer != nullptr) observer->buffer_written(address, value, now);
    if (address == exchange_word) alarm() = now + std::chrono::milliseconds(2);
  }
  [[nodiscard]] std::uint32_t inputs() const noexcept override { return 0; }
  [[nodiscard]] std::uint32_t outputs() const noexcept override { return 0; }
  void set_output(unsigned signal, bool, can::Time) override {
    presets.push_back(fmt::format("Y{}", signal));
  }
  void power_on(can::Time) override {}
  void power_off(can::Time) override {}
  void cpu_changed(module::CpuState, can::Time) override {}
  void set_observer(module::ModuleObserver* who) override { observer = who; }

  void receive(const can::Frame&, can::Time) override {}
  void tick(can::Time) override {
    alarm().cancel();
    words[exchange_word] = 0;
  }

 private:
  struct NoBus final : can::Sink {
    bool send(const can::Frame&) override { return true; }
  } bus_;
  canopen::Node node_{canopen::DictionaryBuilder{}
                          .variable(0x1000, {.name = "Device type", .access = canopen::Access::read_only})
                          .build(),
                      1, bus_};
};

}  // namespace canopus::support
