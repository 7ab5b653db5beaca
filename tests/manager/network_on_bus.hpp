#pragma once
// A master and real nodes as its slaves, on the simulated bus.

#include <iostream>

#include <gmock/gmock.h>

#include "canopus/can/frame_bits.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "master_bench.hpp"

namespace canopus::manager::test {

inline canopen::DictionaryBuilder slave_objects() {
  using canopen::Access;
  using canopen::DataType;
  canopen::DictionaryBuilder builder;
  builder.variable(
      0x1000,
      {.name = "Device type", .access = Access::read_only, .value = canopen::little_endian(0x000F0191, 4)});
  builder.variable(0x1001,
                   {.name = "Error register", .type = DataType::unsigned8, .access = Access::read_only});
  builder.variable(0x1017, {.name = "Producer heartbeat time", .type = DataType::unsigned16});
  builder.uniform(0x1018, canopen::ObjectCode::record, "Identity", 4,
                  {.name = "Identity", .access = Access::read_only, .value = canopen::little_endian(7, 4)});
  builder.uniform(0x2000, canopen::ObjectCode::array, "Parameters", 190, {.name = "Parameter"});
  builder.variable(0x2100, {.name = "Table", .type = DataType::domain});
  return builder;
}
inline std::shared_ptr<const canopen::DictionaryDescription> slave_dictionary() {
  static const auto description = slave_objects().build();
  return description;
}
/// With a TPDO of one word.
inline std::shared_ptr<const canopen::DictionaryDescription> slave_with_tpdo() {
  using canopen::DataType;
  canopen::DictionaryBuilder builder = slave_objects();
  builder.uniform(0x6000, canopen::ObjectCode::array, "Inputs", 4,
                  {.name = "Input", .type = DataType::unsigned16, .tpdo_mappable = true});
  builder.object(0x1800, canopen::ObjectCode::record, "TPDO communication");
  builder.sub(0x1800, 1, {.value = canopen::little_endian(0x180, 4), .adds_node_id = true});
  builder.sub(0x1800, 2, {.type = DataType::unsigned8, .value = {0xFE}});
  builder.object(0x1A00, canopen::ObjectCode::record, "TPDO mapping");
  builder.sub(0x1A00, 0, {.type = DataType::unsigned8, .value = {1}});
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    builder.sub(0x1A00, sub, {.value = canopen::little_endian(0x60000010U + 0x100U * sub, 4)});
  }
  return builder.build();
}

class MasterOnBus final : public ConfiguredMaster {
 public:
  MasterOnBus(sim::Port& port, can::Timeline& timeline) : ConfiguredMaster(port) {
    timeline.add(*this);
    port.connect(*this);
  }
};

class NetworkOnBus : public ::testing::Test {
 public:
  struct Slave {
    Slave(std::uint8_t id, sim::Bus& bus, can::Timeline& timeline,
          std::shared_ptr<const canopen::DictionaryDescription> description = slave_dictionary())
        : port(bus.add_port("slave " + std::to_string(id))), node(std::move(description), id, port) {
      timeline.add(node);
      port.connect(node);
    }
    sim::Port& port;
    canopen::Node node;
  };

  Slave& slave(std::uint8_t id) { return slaves.emplace_back(id, bus, timeline); }
  void switch_on() {
    for (Slave& device : slaves) {
      device.node.power_on(timeline.now());
    }
    run_for(100ms);
    master.node().power_on(timeline.now());
  }
  void run_for(can::Duration duration) { timeline.run_until(timeline.now() + duration); }

  can::Timeline timeline;
  sim::Bus bus{"field", 1'000'000, timeline};
  MasterOnBus master{bus.add_port("master"), timeline};
  std::list<Slave> slaves;
};

/// Bits on the wire of frames that come one after the other, with the intermission after each.
class WireTime {
 public:
  void frame(std::uint32_t identifier, std::initializer_list<std::uint8_t> bytes) {
    bits_ += can::frame_bits(can::data_frame(identifier, bytes)) + can::intermission_bits;
  }
  void frame(std::uint32_t identifier, std::span<const std::uint8_t> bytes) {
    bits_ += can::frame_bits(can::data_frame(identifier, bytes)) + can::intermission_bits;
  }
  [[nodiscard]] double seconds(std::uint32_t bit_rate) const {
    return static_cast<double>(bits_) / static_cast<double>(bit_rate);
  }

 private:
  std::uint64_t bits_ = 0;
};

inline constexpr std::uint8_t low(std::size_t value) { return static_cast<std::uint8_t>(value & 0xFF); }
inline constexpr std::uint8_t high(std::size_t value) { return static_cast<std::uint8_t>(value >> 8 & 0xFF); }

}  // namespace canopus::manager::test
