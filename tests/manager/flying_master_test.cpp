// Flying master [CiA 302-2; ME3CAN1-Q 4.8.10]: one node's frames, and whole networks of masters.

#include "canopus/manager/nmt/flying_master.hpp"

#include <cstdlib>
#include <iostream>
#include <random>

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Node 1, level 1, as the ME3CAN1-Q's defaults.
class Flying : public MasterBench {
 public:
  Flying() { object(0x1F80, 0, 0x23); }
  /// Without the heartbeats.
  std::vector<std::string> frames() {
    std::vector<std::string> lines;
    for (const std::string& line : sent()) {
      if (line.find(" 701 ") == std::string::npos) lines.push_back(line);
    }
    return lines;
  }
};

TEST_F(Flying, NobodyAnswers_NetworkReset_Negotiation_ThenActive) {
  switch_on();
  run_until_ms(499);
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(599);
  EXPECT_THAT(frames(), ElementsAre("500 073"));
  run_until_ms(2109);
  EXPECT_THAT(frames(), ElementsAre("600 000 82 00", "600 072"));
  EXPECT_FALSE(master.active());
  EXPECT_EQ(master.active_master(), 0);
  run_until_ms(2110);  // 1 x 1500 + 1 x 10
  EXPECT_THAT(frames(), ElementsAre("2110 071 01 01", "2110 000 82 00"));
  EXPECT_TRUE(master.active());
  EXPECT_EQ(master.active_master(), 1);
  run_until_ms(2700);
  EXPECT_THAT(frames(), ElementsAre("2610 000 01 00"));
}

TEST_F(Flying, HeartbeatIsProducedEverySecond_WhenNoneIsConfigured) {
  switch_on();
  run_until_ms(2050);
  EXPECT_THAT(only(sent(), " 701 "), ElementsAre("0 701 00", "1000 701 7F", "2000 701 7F"));
}

TEST_F(Flying, HeartbeatConfigured_StaysAsItIs) {
  object(0x1017, 0, 400);
  switch_on();
  run_until_ms(900);
  EXPECT_THAT(only(sent(), " 701 "), ElementsAre("0 701 00", "400 701 7F", "800 701 7F"));
}

TEST_F(Flying, BetterMasterAnswers_StandsBy_AndWatchesItsHeartbeat) {
  switch_on();
  run_until_ms(550);
  hear(can::data_frame(0x071, {0x00, 0x05}));
  EXPECT_EQ(master.active_master(), 5);
  EXPECT_FALSE(master.active());
  const auto entry = node.dictionary().get<std::uint32_t>(0x1016, 1);
  EXPECT_EQ(entry, 0x000505E6U);  // 1510 ms
  sent();
  run_until_ms(2000);
  EXPECT_THAT(frames(), IsEmpty());
  EXPECT_EQ(write(0x1F82, 2, 0x05, 1), AbortCode::device_state);
}

TEST_F(Flying, WatchedAlready_KeepsItsOwnConsumerTime) {
  object(0x1016, 3, 0x00050BB8);
  switch_on();
  run_until_ms(550);
  hear(can::data_frame(0x071, {0x00, 0x05}));
  EXPECT_EQ(node.dictionary().get<std::uint32_t>(0x1016, 1), 0U);
  sent();
  run_until_ms(3549);
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(3550);
  EXPECT_THAT(frames(), ElementsAre("3550 000 82 00"));
}

TEST_F(Flying, WorseMasterAnswers_IsForcedToNegotiate) {
  switch_on();
  run_until_ms(550);
  sent();
  hear(can::data_frame(0x071, {0x01, 0x05}));
  EXPECT_THAT(frames(), ElementsAre("550 076", "550 072"));
  hear(can::data_frame(0x072));
  run_until_ms(2059);
  EXPECT_FALSE(master.active());
  run_until_ms(2060);
  EXPECT_TRUE(master.active());
}

TEST_F(Flying, BetterMasterIsFasterInTheNegotiation_StandsBy) {
  switch_on();
  run_until_ms(1000);
  hear(can::data_frame(0x071, {0x00, 0x7F}));
  run_until_ms(2400);
  EXPECT_FALSE(master.active());
  EXPECT_EQ(master.active_master(), 127);
}

TEST_F(Flying, ActiveMasterLost_ResetsTheNetwork_AndNegotiates) {
  switch_on();
  run_until_ms(550);
  hear(can::data_frame(0x071, {0x00, 0x05}));
  run_until_ms(2000);
  heartbeat(5, 0x05);
  sent();
  run_until_ms(3509);
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(6000);
  EXPECT_THAT(frames(),
              ElementsAre("3510 000 82 00", "4010 073", "4110 072", "5620 071 01 01", "5620 000 82 00"));
  EXPECT_TRUE(master.active());
}

TEST_F(Flying, ActiveMasterWithoutHeartbeat_IsResetAgainAndAgain) {
  switch_on();
  run_until_ms(550);
  for (int i = 0; i < 5; ++i) {
    hear(can::data_frame(0x071, {0x00, 0x05}));
    sent();
    run_for(1510ms);
    EXPECT_EQ(commands().size(), 1U);
    run_for(550ms);
  }
}

TEST_F(Flying, Active_AnswersWhoAsks) {
  switch_on();
  run_until_ms(3000);
  sent();
  hear(can::data_frame(0x073));
  EXPECT_THAT(frames(), ElementsAre("3000 071 01 01"));
  hear(can::data_frame(0x075));
  EXPECT_THAT(frames(), ElementsAre("3000 074"));
}

TEST_F(Flying, Active_LooksForASecondActiveMasterEveryCycle) {
  switch_on();
  run_until_ms(3000);
  sent();
  run_until_ms(15000);
  EXPECT_THAT(only(sent(), " 076"), ElementsAre("6120 076", "10130 076", "14140 076"));
}

TEST_F(Flying, Active_ForcedToNegotiate_GivesTheRoleUpMeanwhile) {
  object(0x1F81, 2, 0x00640301);
  slave(2);
  switch_on();
  run_until_ms(3000);
  ASSERT_TRUE(master.guarding(2));
  sent();
  hear(can::data_frame(0x076));
  EXPECT_THAT(frames(), ElementsAre("3000 072"));
  EXPECT_FALSE(master.active());
  EXPECT_FALSE(master.guarding(2));
  run_until_ms(4509);
  EXPECT_FALSE(master.active());
  EXPECT_THAT(frames(), IsEmpty());
  run_until_ms(4510);
  EXPECT_TRUE(master.active());
  const auto lines = frames();
  EXPECT_EQ(lines[0], "4510 071 01 01");
  EXPECT_EQ(lines[1], "4510 000 82 00");
}

TEST_F(Flying, Active_HearsABetterOne_StandsBy) {
  switch_on();
  run_until_ms(3000);
  hear(can::data_frame(0x071, {0x00, 0x09}));
  EXPECT_FALSE(master.active());
  EXPECT_EQ(master.active_master(), 9);
}

TEST_F(Flying, WaitingTime_IsLevelTimesPrioritySlotPlusNodeIdTimesDeviceSlot) {
  class Nobody : public can::Sink, public FlyingMasterUser {
   public:
    bool send(const can::Frame&) override { return true; }
    void mastership_won(can::Time) override {}
    void mastership_lost(can::Time) override {}
    can::Duration standby_for(std::uint8_t, can::Time) override { return 1s; }
    void reset_all_nodes(can::Time) override {}
  } nobody;
  FlyingMaster flying(nobody, nobody);
  const std::vector<std::tuple<std::uint8_t, std::uint8_t, can::Duration>> rows{
      {std::uint8_t{0}, std::uint8_t{1}, 10ms},
      {std::uint8_t{1}, std::uint8_t{1}, 1510ms},
      {std::uint8_t{1}, std::uint8_t{127}, 2770ms},
      {std::uint8_t{2}, std::uint8_t{127}, 4270ms}};
  for (const auto& [level, id, expected] : rows) {
    FlyingMasterTiming timing;
    timing.level = level;
    flying.start(id, timing, now);
    EXPECT_EQ(flying.waiting_time(), expected);
  }
}

TEST_F(Flying, PriorityLevelAbove2_IsRefused) {
  switch_on();
  EXPECT_EQ(write(0x1F90, 3, 2, 2), AbortCode::none);
  EXPECT_EQ(write(0x1F90, 3, 3, 2), AbortCode::invalid_value);
  EXPECT_EQ(write(0x1F90, 3, 0x100, 2), AbortCode::invalid_value);
}

TEST_F(Flying, KeepAliveSlaves_AreResetAllTheSame) {
  object(0x1F81, 2, 0x1D);
  slave(2);
  switch_on();
  run_until_ms(2112);
  EXPECT_THAT(commands(), ElementsAre("600 000 82 00", "2110 000 82 00"));
}

// --- networks

/// Masters on one bus that can be switched on and off one by one, and a bus that can be cut in two.
class Network {
 public:
  struct Member : can::Sink, canopen::NodeListener {
    Member(Network& owner, std::uint8_t id, std::uint8_t priority)
        : network(owner), level(priority), node(dictionary(), id, *this), master(node, *this) {
      node.set_listener(this);
    }
    static std::shared_ptr<const canopen::DictionaryDescription> dictionary() {
      static const auto description = master_dictionary();
      return description;
    }
    bool send(const can::Frame& frame) override {
      network.transmit(*this, frame);
      return true;
    }
    void reset_requested(canopen::NmtCommand, can::Time at) override { master.stop(at); }
    void reset_done(canopen::NmtCommand, can::Time at) override {
      node.dictionary().set(0x1F80, 0, 0x21U);
      node.dictionary().set(0x1F90, 3, std::uint16_t{level});
      node.dictionary().set(0x1F90, 6, static_cast<std::uint16_t>(4000 + 10 * node.node_id()));
      master.start(at);
    }
    void nmt_state_changed(NmtState state, can::Time at) override { master.own_state_changed(state, at); }
    void heartbeat_received(std::uint8_t id, NmtState state, can::Time at) override {
      master.heartbeat_received(id, state, at);
    }
    void heartbeat_lost(std::uint8_t id, can::Time at) override { master.heartbeat_lost(id, at); }

    Network& network;
    std::uint8_t level;
    bool on = false;
    int side = 0;
    canopen::Node node;
    NmtMaster master;
  };
  struct Coming {
    can::Time time;
    std::uint32_t identifier;
    unsigned order;
    can::Frame frame;
    Member* sender;
  };

  Member& add(std::uint8_t id, std::uint8_t level) { return members.emplace_back(*this, id, level); }
  void switch_on(Member& member) {
    member.on = true;
    member.node.power_on(now);
  }
  void switch_off(Member& member) {
    member.on = false;
    member.master.stop(now);
    member.node.power_off();
    std::erase_if(bus, [&](const Coming& coming) { return coming.sender == &member; });
  }
  void transmit(Member& sender, const can::Frame& frame) {
    bus.push_back({now, frame.identifier, ++order, frame, &sender});
  }
  /// One frame after the other, the lowest identifier first, 0.2 ms each.
  void run_until(can::Time end) {
    for (;;) {
      can::Time next = end;
      for (Member& member : members) {
        if (member.on) next = std::min({next, member.node.deadline(), member.master.deadline()});
      }
      if (!bus.empty()) next = std::min(next, std::max(now, bus_free));
      if (next >= end) break;
      now = std::max(now, next);
      for (Member& member : members) {
        while (member.on && member.node.deadline() <= now) member.node.tick(now);
        while (member.on && member.master.deadline() <= now) member.master.tick(now);
      }
      if (!bus.empty() && bus_free <= now) {
        const auto first = std::min_element(bus.begin(), bus.end(), [](const Coming& a, const Coming& b) {
          return std::pair(a.identifier, a.order) < std::pair(b.identifier, b.order);
        });
        const Coming coming = *first;
        bus.erase(first);
        now += 200us;
        bus_free = now;
        for (Member& member : members) {
          if (!member.on || &member == coming.sender || member.side != coming.sender->side) continue;
          member.node.receive(coming.frame, now);
          member.master.receive(coming.frame, now);
        }
      }
    }
    now = end;
  }
  [[nodiscard]] std::vector<std::uint8_t> active(int side) const {
    std::vector<std::uint8_t> ids;
    for (const Member& member : members) {
      if (member.on && member.side == side && member.master.active()) ids.push_back(member.node.node_id());
    }
    return ids;
  }
  /// The one that should be active: lowest level, then lowest node-ID.
  [[nodiscard]] std::uint8_t best(int side) const {
    const Member* found = nullptr;
    for (const Member& member : members) {
      if (!member.on || member.side != side) continue;
      if (found == nullptr ||
          std::pair(member.level, member.node.node_id()) < std::pair(found->level, found->node.node_id())) {
        found = &member;
      }
    }
    return found != nullptr ? found->node.node_id() : std::uint8_t{0};
  }
  /// Time from `from` until the network had exactly its best master and kept it for 10 s.
  std::optional<can::Duration> settle(can::Duration at_most) {
    const can::Time from = now;
    can::Time since = can::never;
    while (now - from < at_most) {
      const bool good = active(0) == std::vector{best(0)};
      if (!good) {
        since = can::never;
      } else if (since == can::never) {
        since = now;
      } else if (now - since >= 10s) {
        return since - from;
      }
      run_until(now + 10ms);
    }
    return std::nullopt;
  }

  can::Time now{};
  can::Time bus_free{};
  std::list<Member> members;
  std::vector<Coming> bus;
  unsigned order = 0;
};

class FlyingNetwork : public ::testing::TestWithParam<unsigned> {
 public:
  void populate(Network& network, std::mt19937& random) const {
    std::vector<std::uint8_t> ids;
    while (ids.size() < GetParam()) {
      const auto id = static_cast<std::uint8_t>(1 + random() % 127);
      if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
    }
    for (const std::uint8_t id : ids) network.add(id, static_cast<std::uint8_t>(random() % 3));
  }
  static void switch_all_on(Network& network, std::mt19937& random) {
    const bool at_once = random() % 2 == 0;
    for (Network::Member& member : network.members) {
      if (!at_once) network.run_until(network.now + std::chrono::milliseconds(random() % 3000));
      network.switch_on(member);
    }
  }
  /// How many networks are tried; more of them with CANOPUS_SEEDS=1000 in the environment.
  static unsigned seeds() {
    const char* wanted = std::getenv("CANOPUS_SEEDS");
    return wanted != nullptr ? static_cast<unsigned>(std::atoi(wanted)) : 25U;
  }
  static constexpr can::Duration limit = 60s;
};

TEST_P(FlyingNetwork, PowerOn_TheBestMasterIsTheOnlyActiveOne) {
  can::Duration worst{};
  for (unsigned seed = 0; seed < seeds(); ++seed) {
    std::mt19937 random(seed);
    Network network;
    populate(network, random);
    switch_all_on(network, random);
    const auto time = network.settle(limit);
    ASSERT_TRUE(time.has_value()) << "seed " << seed;
    worst = std::max(worst, *time);
  }
  std::cout << "worst: " << std::chrono::duration_cast<std::chrono::milliseconds>(worst).count() << " ms\n";
}

TEST_P(FlyingNetwork, PowerCutOfAnyMasterAtAnyMoment_LeavesTheBestOfTheRest) {
  can::Duration worst{};
  for (unsigned seed = 0; seed < seeds(); ++seed) {
    std::mt19937 random(1000 + seed);
    Network network;
    populate(network, random);
    switch_all_on(network, random);
    network.run_until(network.now + std::chrono::milliseconds(random() % 8000));
    const auto active = network.active(0);
    for (Network::Member& member : network.members) {
      if (active.empty() ? random() % 2 == 0 : member.node.node_id() == active[0]) {
        network.switch_off(member);
        break;
      }
    }
    const auto time = network.settle(limit);
    ASSERT_TRUE(time.has_value()) << "seed " << seed;
    worst = std::max(worst, *time);
  }
  std::cout << "worst: " << std::chrono::duration_cast<std::chrono::milliseconds>(worst).count() << " ms\n";
}

TEST_P(FlyingNetwork, BusCutAndMerged_OneActiveMasterInEachPart_ThenOneAgain) {
  can::Duration worst{};
  for (unsigned seed = 0; seed < seeds(); ++seed) {
    std::mt19937 random(2000 + seed);
    Network network;
    populate(network, random);
    switch_all_on(network, random);
    ASSERT_TRUE(network.settle(limit).has_value()) << "seed " << seed;
    for (Network::Member& member : network.members) member.side = random() % 2 == 0 ? 0 : 1;
    network.run_until(network.now + 20s);
    for (const int side : {0, 1}) {
      if (network.best(side) != 0) {
        EXPECT_EQ(network.active(side), std::vector{network.best(side)}) << "seed " << seed;
      }
    }
    network.run_until(network.now + std::chrono::milliseconds(random() % 5000));
    for (Network::Member& member : network.members) member.side = 0;
    const auto time = network.settle(limit);
    ASSERT_TRUE(time.has_value()) << "seed " << seed;
    worst = std::max(worst, *time);
  }
  std::cout << "worst: " << std::chrono::duration_cast<std::chrono::milliseconds>(worst).count() << " ms\n";
}

INSTANTIATE_TEST_SUITE_P(Masters, FlyingNetwork, ::testing::Values(2U, 3U, 10U));

}  // namespace
}  // namespace canopus::manager::test
