// Flying master [CiA 302-2; ME3CAN1-Q 4.8.10]: whole networks of masters.

#include <iostream>
#include <random>

#include <gmock/gmock.h>

#include "canopus/manager/nmt/flying_master.hpp"

#include "master_bench.hpp"
#include "support/random_cases.hpp"

namespace canopus::manager::test::flying_network_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

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
  /// How many networks are tried.
  static unsigned seeds() { return support::random_cases(100, 1000); }
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
}  // namespace canopus::manager::test::flying_network_test
