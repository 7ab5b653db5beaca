// FX3U-CAN among themselves and with a Q rack's ME3CAN1-Q, on a bus with its arbitration and its bit rate
// [FX3U-CAN 5.6.1, 5.8.11, 6.13, 7.2, 14.2].

#include "scenarios/fx3u_can/network.hpp"

#include <algorithm>
#include <set>

#include "canopus/module/models/me3can1_q/me3can1_q.hpp"

namespace canopus::scenario::fx3u_can_network_test {
namespace {

using Member = BlockNetwork::Member;

// S101 with all eight.
TEST(FxNetwork, ModeA_EveryoneSeesTheWordsOfNodeK_AtTheSamePlace) {
  RecordProperty("spec", "FX3U-MA-001 FX3U-MA-002 FX3U-DX-001 FX3U-DX-003");
  BlockNetwork network;
  std::vector<Member*> nodes;
  for (std::uint8_t id = 1; id <= 8; ++id) nodes.push_back(&network.add(id));
  network.preset(*nodes[0], 0x1F80, 0, 3, 4);
  network.power_on();
  network.run(5s);
  for (Member* node : nodes) {
    EXPECT_EQ(network.command(*node, {0x8200}), 0x8201);
    EXPECT_EQ(network.get(*node, 25) & 0x0301, 0x0201);
  }
  for (unsigned round = 1; round <= 3; ++round) {
    for (unsigned k = 0; k < 8; ++k) {
      for (unsigned word = 0; word < 16; ++word)
        network.set(*nodes[k], 11000 + word, static_cast<std::uint16_t>(round << 12 | (k + 1) << 8 | word));
      network.exchange(*nodes[k]);
    }
    network.run(50ms);
    for (unsigned own = 0; own < 8; ++own) {
      network.exchange(*nodes[own]);
      for (unsigned word = 0; word < 128; ++word) {
        const unsigned k = word / 16;
        const unsigned expected = k == own ? 0U : round << 12 | (k + 1) << 8 | word % 16;
        ASSERT_EQ(network.get(*nodes[own], 10000 + word), expected) << "node " << own + 1 << " word " << word;
      }
      EXPECT_EQ(network.get(*nodes[own], 29), 0);
    }
  }
}

// S087
TEST(FxNetwork, FlyingMasters_5And6_Then5IsGone_Then4Comes) {
  RecordProperty("spec",
                 "FX3U-FM-002 FX3U-FM-005 FX3U-FM-006 FX3U-FM-007 FX3U-FM-008 FX3U-FM-009 FX3U-FM-011");
  BlockNetwork network;
  network.add(100);  // a slave
  Member& five = network.add(5);
  Member& six = network.add(6);
  Member& four = network.add(4);
  for (Member* member : {&five, &six, &four}) network.preset(*member, 0x1F80, 0, 0x21, 4);
  network.power(network.members.front(), true);
  network.power(five, true);
  network.power(six, true);
  const auto is_master = [&](Member& member) { return (network.get(member, 25) & 0x8000) != 0; };
  network.run(10s);
  EXPECT_TRUE(is_master(five));
  EXPECT_FALSE(is_master(six));
  network.run(10s);
  EXPECT_TRUE(is_master(five));
  network.power(five, false);
  network.run(1s);
  EXPECT_FALSE(is_master(six));
  network.run(9s);
  EXPECT_TRUE(is_master(six));
  network.power(four, true);
  network.run(10s);
  EXPECT_TRUE(is_master(four));
  EXPECT_FALSE(is_master(six));
  // STOP of its CPU ends the role, RUN negotiates anew.
  four.module->cpu_changed(module::CpuState::stop, network.timeline.now());
  network.run(10s);
  EXPECT_FALSE(is_master(four));
  EXPECT_TRUE(is_master(six));
  four.module->cpu_changed(module::CpuState::run, network.timeline.now());
  network.run(10s);
  EXPECT_TRUE(is_master(four));
  EXPECT_FALSE(is_master(six));
}

TEST(FxNetwork, ExchangingFasterThanTheBusCarries_OverflowsTheQueue) {
  RecordProperty("spec", "FX3U-DX-009 FX3U-ERR-010 FX3U-ERR-002");
  BlockNetwork network(10'000);
  Member& one = network.add(1);
  network.add(2);
  network.power_on();
  network.run(2s);
  one.module->receive(can::data_frame(0x000, {0x01, 0x01}), network.timeline.now());
  EXPECT_EQ(network.get(one, 29), 0);
  network.set(one, 26, 0);
  for (std::uint16_t i = 1; i <= 500; ++i) {
    for (module::BufferAddress word = 11000; word < 11016; ++word) network.set(one, word, i);
    network.exchange(one);
  }
  EXPECT_EQ(network.get(one, 29), 0x0101);
  network.run(1min);
  EXPECT_EQ(network.get(one, 29), 0x0101);
  network.set(one, 29, 0);
  EXPECT_EQ(network.get(one, 29), 0);
}

/// Everything on the bus, in order.
class Ear final : public can::Participant {
 public:
  void receive(const can::Frame& frame, can::Time) override { heard.push_back(frame); }
  void tick(can::Time) override {}
  std::vector<can::Frame> heard;
};

TEST(FxNetwork, TheLowestIdentifierGoesFirst_AmongNodesAndWithinOne) {
  RecordProperty("spec", "FX3U-COB-003");
  BlockNetwork network(50'000);
  Member& one = network.add(1);
  Member& two = network.add(2);
  for (const auto& [pdo, id] :
       std::vector<std::pair<unsigned, std::uint32_t>>{{0, 0x4FF}, {1, 0x3FF}, {2, 0x2FF}, {3, 0x1FF}})
    network.preset(one, static_cast<std::uint16_t>(0x1800 + pdo), 1, 0x4000'0000U | id, 4);
  Ear ear;
  sim::Port& port = network.bus.add_port("ear");
  network.timeline.add(ear);
  port.connect(ear);
  network.power_on();
  network.run(3s);
  for (Member* member : {&one, &two}) {
    member->module->receive(can::data_frame(0x000, {0x01, 0x00}), network.timeline.now());
    for (module::BufferAddress word = 11000; word < 11016; ++word) network.set(*member, word, 7);
  }
  ear.heard.clear();
  network.set(two, 20, 1);
  network.set(one, 20, 1);
  network.run(200ms);
  std::vector<std::uint32_t> order;
  for (const can::Frame& frame : ear.heard) order.push_back(frame.identifier);
  ASSERT_EQ(order.size(), 8U);
  // The bus was free for whoever came first; from then on the identifiers decide.
  EXPECT_TRUE(std::ranges::is_sorted(order.begin() + 1, order.end()));
  EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()),
            (std::set<std::uint32_t>{0x182, 0x1FF, 0x282, 0x2FF, 0x382, 0x3FF, 0x482, 0x4FF}));
}

// TL2-40. Whoever is alone gets no acknowledgement: error passive, and no bus-off [ISO 11898-1].
TEST(FxNetwork, Alone_ItsTransmitCounterRisesByEight_AndFallsByOne) {
  RecordProperty("spec", "FX3U-CNT-001 FX3U-ERR-007 FX3U-LED-002");
  BlockNetwork network(250'000);
  Member& one = network.add(1);
  Member& two = network.add(2);
  network.preset(one, 0x1017, 0, 100, 2);
  network.power(one, true);
  std::vector<std::uint16_t> seen;
  for (int step = 0; step < 80'000 && (seen.empty() || seen.back() != 128); ++step) {
    network.run(50us);
    const std::uint16_t counter = network.get(one, 35);
    if (counter != (seen.empty() ? 0 : seen.back())) seen.push_back(counter);
  }
  EXPECT_EQ(seen, (Words{8, 16, 24, 32, 40, 48, 56, 64, 72, 80, 88, 96, 104, 112, 120, 128}));
  EXPECT_EQ(network.get(one, 29), 0x4000);
  const auto leds = one.module->leds(network.timeline.now());
  EXPECT_EQ(std::ranges::find(leds, std::string_view("ERROR"), &module::Led::name)->pattern,
            module::LedPattern::single_flash);
  network.run(10s);
  EXPECT_EQ(network.get(one, 35), 128);
  network.power(two, true);
  network.run(1500ms);
  EXPECT_LT(network.get(one, 35), 128);
  EXPECT_EQ(network.get(one, 29), 0);
  const std::uint16_t before = network.get(one, 35);
  network.run(100ms);
  EXPECT_EQ(network.get(one, 35), before - 1);
  network.run(1min);
  EXPECT_EQ(network.get(one, 35), 0);
}

// As master and slave of each other: the ME3CAN1-Q asks by Y01, the FX3U-CAN by #20.
TEST(FxNetwork, WithAnMe3can1Q_MasterAndSlaveOfEachOther) {
  RecordProperty("spec", "FX3U-IDENT-001 FX3U-BOOT-002 FX3U-HB-002 FX3U-HB-003 FX3U-BOOT-015 FX3U-ERR-009");
  for (const bool fx_is_master : {true, false}) {
    BlockNetwork network;
    Member& fx = network.add(fx_is_master ? 1 : 2);
    Member& q = network.add<module::me3can1_q::Me3can1Q>(fx_is_master ? 2 : 1);
    Member& master = fx_is_master ? fx : q;
    Member& slave = fx_is_master ? q : fx;
    network.preset(master, 0x1F80, 0, 1, 4);
    network.preset(master, 0x1F81, 2, 0x05, 4);
    network.preset(master, 0x1F84, 2, 0x195, 4);
    network.preset(master, 0x1F85, 2, 0x71, 4);
    network.preset(master, 0x1F86, 2, fx_is_master ? 0xED63 : 7170, 4);
    network.preset(master, 0x1016, 1, 0x0002'00C8, 4);
    network.preset(master, 0x1400, 1, 0x182, 4);
    network.preset(slave, 0x1400, 1, 0x181, 4);
    network.preset(slave, 0x1017, 0, 100, 2);
    network.power_on();
    network.run(5s);
    network.set(fx, 26, 0);
    EXPECT_EQ(network.get(master, 25) & 0xC301, 0x8201) << fx_is_master;
    EXPECT_EQ(network.get(slave, 25) & 0x8301, 0x0201) << fx_is_master;
    const auto exchange_q = [&] {
      for (const bool on : {true, false}) {
        q.module->signals()->set_output(1, on, network.timeline.now());
        network.run(2ms);
      }
    };
    network.set(fx, 11000, 0x1234);
    network.set(fx, 11003, 0x5678);
    network.exchange(fx);
    network.run(5ms);
    exchange_q();
    EXPECT_EQ(network.get(q, 10000), 0x1234);
    EXPECT_EQ(network.get(q, 10003), 0x5678);
    network.set(q, 13001, 0xBEEF);
    exchange_q();
    network.run(5ms);
    network.exchange(fx);
    EXPECT_EQ(network.get(fx, 10001), 0xBEEF);
    EXPECT_EQ(network.get(fx, 1), 0xBEEF);
    // The slave goes, and comes back.
    network.power(slave, false);
    network.run(1s);
    if (fx_is_master) {
      EXPECT_EQ(network.get(fx, 900) & 0x8000, 0x8000);
    } else {
      EXPECT_EQ(network.get(q, 402) & 0x80, 0x80);
    }
    network.power(slave, true);
    network.run(2s);
    if (!fx_is_master) network.set(fx, 26, 0);
    network.run(3s);
    EXPECT_EQ(network.get(slave, 25) & 0x0301, 0x0201);
    if (fx_is_master) {
      EXPECT_EQ(network.get(fx, 602), 5);
      network.set(fx, 29, 0);
      EXPECT_EQ(network.get(fx, 29), 0);
    }
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_network_test
