#pragma once
// FX3U-CAN and other modules on one simulated bus, each in a rack of its own.

#include <list>
#include <memory>
#include <string>

#include "canopus/can/timeline.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/module/engine/module_engine.hpp"
#include "canopus/module/models/fx3u_can/fx3u_can.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "scenarios/scenario.hpp"

namespace canopus::scenario {

class BlockNetwork {
 public:
  struct Member {
    sim::Port* port = nullptr;
    RamMemory memory;
    std::unique_ptr<module::ModuleEngine> module;
  };

  /// `bit_rate`: of the bus, and of every module.
  explicit BlockNetwork(std::uint32_t bit_rate = 500'000)
      : bus("field", bit_rate, timeline), bit_rate_(bit_rate) {}

  template <typename Model = module::fx3u_can::Fx3uCan>
  Member& add(std::uint8_t node_id) {
    Member& member = members.emplace_back();
    member.port = &bus.add_port("node " + std::to_string(node_id));
    member.module = std::make_unique<Model>(*member.port, member.memory);
    member.module->preset_node_id(node_id);
    member.module->preset_bit_rate(bit_rate_);
    timeline.add(*member.module);
    member.port->connect(*member.module);
    return member;
  }
  void preset(Member& member, std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned length) {
    ASSERT_EQ(member.module->preset_object(index, sub, canopen::little_endian(value, length)),
              canopen::AbortCode::none)
        << std::hex << index;
  }
  void power(Member& member, bool on) {
    on ? member.module->power_on(timeline.now()) : member.module->power_off(timeline.now());
  }
  void power_on() {
    for (Member& member : members) power(member, true);
  }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  std::uint16_t get(Member& member, module::BufferAddress address) {
    const std::uint16_t value = member.module->program_read(address, timeline.now());
    return value;
  }
  void set(Member& member, module::BufferAddress address, std::uint16_t value) {
    member.module->write_word(address, value, timeline.now());
  }
  /// Of an FX3U-CAN: #20 = 1, and as long as it takes.
  void exchange(Member& member) {
    set(member, 20, 1);
    run(2ms);
    EXPECT_EQ(get(member, 20), 0);
  }
  /// Of an FX3U-CAN: parameters to #1001 on, the code to #1000, and as long as it takes. The result.
  std::uint16_t command(Member& member, const Words& words) {
    for (std::size_t i = 1; i < words.size(); ++i)
      set(member, static_cast<module::BufferAddress>(1000 + i), words[i]);
    set(member, 1000, words.front());
    for (int i = 0; i < 5000 && get(member, 1000) == 0xFFFF; ++i) run(1ms);
    return get(member, 1000);
  }

  can::Timeline timeline;
  sim::Bus bus;
  std::list<Member> members;

 private:
  std::uint32_t bit_rate_;
};

}  // namespace canopus::scenario
