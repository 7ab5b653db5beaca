// RJ71CN91 and ME3CAN1-Q on one bus: as master and slave of each other, and as flying masters of each other, by seeds: power
// cuts in any phase, CPUs that stop and run, the bus cut and joined. In the end exactly one master is active, the best
// one, within the time that 1F90H implies.
//
// CANOPUS_SEEDS: so many networks instead of 300, or of 1000 in ./check --all; RC_PARAMS has no meaning here.

#include <algorithm>
#include <list>
#include <random>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/sim/bus/bus.hpp"

#include "scenarios/me3can1_q/scenario.hpp"
#include "support/random_cases.hpp"

namespace canopus::scenario::rj71cn91_mixed_network_test {
namespace {

class Network {
 public:
  struct Member {
    std::string_view model;
    std::uint8_t id = 0;
    std::uint16_t level = 1;
    bool on = false;
    bool runs = true;
    bool is_far = false;
    sim::Port* port = nullptr;
    RamMemory memory;
    std::unique_ptr<module::ModuleEngine> module;
  };

  // Slaves that only acknowledge, one on each side of a cut.
  Network() {
    bus.add_port("near slave");
    bus.add_port("far slave");
  }

  Member& add(std::string_view model, std::uint8_t id) {
    Member& member = members.emplace_back();
    member.model = model;
    member.id = id;
    member.port = &bus.add_port("node " + std::to_string(id));
    member.module = make_module(model, *member.port, member.memory);
    member.module->preset_node_id(id);
    member.module->preset_bit_rate(500'000);
    timeline.add(*member.module);
    member.port->connect(*member.module);
    return member;
  }
  static void preset(Member& member, std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                     unsigned length) {
    ASSERT_EQ(member.module->preset_object(index, sub, canopen::little_endian(value, length)),
              canopen::AbortCode::none);
  }
  void power(Member& member, bool on) {
    if (member.on == on) return;
    member.on = on;
    on ? member.module->power_on(timeline.now()) : member.module->power_off(timeline.now());
  }
  void cpu(Member& member, bool runs) {
    if (member.runs == runs) return;
    member.runs = runs;
    member.module->cpu_changed(runs ? module::CpuState::run : module::CpuState::stop, timeline.now());
  }
  void cut(bool is_cut) {
    sim::Fault fault{.kind = sim::FaultKind::cut, .ports = {"far slave"}};
    for (const Member& member : members) {
      if (member.is_far) fault.ports.push_back(member.port->name());
    }
    ASSERT_TRUE(bus.set_faults(is_cut ? std::vector{fault} : std::vector<sim::Fault>{}, 1).has_value());
  }
  void run(can::Duration duration) { timeline.run_until(timeline.now() + duration); }
  std::uint16_t g(Member& member, module::BufferAddress address) {
    return member.module->program_read(address, timeline.now());
  }
  void g(Member& member, module::BufferAddress address, std::uint16_t value) {
    member.module->write_word(address, value, timeline.now());
  }
  void exchange(Member& member) {
    member.module->signals()->set_output(1, true, timeline.now());
    run(2ms);
    EXPECT_NE(member.module->signals()->inputs() & 2U, 0U);
    member.module->signals()->set_output(1, false, timeline.now());
  }
  /// Node-IDs of the active masters.
  std::vector<unsigned> active() {
    std::vector<unsigned> ids;
    for (Member& member : members) {
      if (member.on && (g(member, 25) & 0x8000) != 0) ids.push_back(member.id);
    }
    return ids;
  }

  can::Timeline timeline;
  sim::Bus bus{"field", 500'000, timeline};
  std::list<Member> members;
};

struct Pair {
  std::string_view master;
  std::string_view slave;
};
constexpr std::array pairs{Pair{rj71cn91, me3can1_q}, Pair{me3can1_q, rj71cn91}, Pair{rj71cn91, rj71cn91}};

TEST(MixedNetwork, MasterAndSlave_BootExchangeAndLoseEachOther) {
  for (const Pair& pair : pairs) {
    Network network;
    Network::Member& master = network.add(pair.master, 1);
    Network::Member& slave = network.add(pair.slave, 2);
    const bool slave_is_rj = pair.slave == rj71cn91;
    Network::preset(master, 0x1F80, 0, 1, 4);
    Network::preset(master, 0x1F81, 2, 0x05, 4);
    Network::preset(master, 0x1F84, 2, 0x195, 4);
    Network::preset(master, 0x1F85, 2, slave_is_rj ? 0x1D0 : 0x71, 4);
    Network::preset(master, 0x1F86, 2, slave_is_rj ? 0x100 : 0xED63, 4);
    Network::preset(master, 0x1F87, 2, 0x10000, 4);
    Network::preset(master, 0x1016, 1, 0x000200C8, 4);
    Network::preset(master, 0x1400, 1, 0x182, 4);
    Network::preset(slave, 0x1400, 1, 0x181, 4);
    Network::preset(slave, 0x1017, 0, 100, 2);
    network.power(master, true);
    network.power(slave, true);
    network.run(4s);
    EXPECT_EQ(network.g(master, 25) & 0xFF01, 0x8201) << pair.master;
    EXPECT_EQ(network.g(slave, 25) & 0x8301, 0x0201) << pair.slave;
    network.g(slave, 13000, 0x1234);
    network.exchange(slave);
    network.run(10ms);
    network.exchange(master);
    EXPECT_EQ(network.g(master, 10000), 0x1234);
    network.g(master, 13003, 0x5678);
    network.exchange(master);
    network.run(10ms);
    network.exchange(slave);
    EXPECT_EQ(network.g(slave, 10003), 0x5678);
    network.power(slave, false);
    network.run(1s);
    EXPECT_NE(network.g(master, 402) & 0x0080, 0) << pair.master;
    network.power(slave, true);
    network.run(5s);
    EXPECT_EQ(network.g(slave, 25) & 0x0201, 0x0201) << pair.slave;
  }
}

// [4.8.10] The one with the higher priority waits 10 s, the other 1.5 s.
TEST(MixedNetwork, ResponseWaitsInTheWrongOrder_TheNegotiationDoesNotEnd) {
  RecordProperty("spec", "ME3-FLY-017 RJ71-FLY-004");
  for (const Pair& pair : pairs) {
    Network network;
    Network::Member& high = network.add(pair.master, 100);
    Network::preset(high, 0x1F90, 3, 0, 2);
    Network::preset(high, 0x1F90, 5, 100, 2);
    Network::Member& low = network.add(pair.slave, 1);
    Network::preset(low, 0x1F90, 3, 1, 2);
    for (Network::Member* member : {&high, &low}) {
      Network::preset(*member, 0x1F80, 0, 0x21, 4);
      network.power(*member, true);
    }
    network.run(60s);
    unsigned changes = 0;
    std::vector<unsigned> before = network.active();
    for (int tenth = 0; tenth < 1200; ++tenth) {
      network.run(100ms);
      const std::vector<unsigned> now = network.active();
      changes += now != before ? 1U : 0U;
      before = now;
    }
    EXPECT_GE(changes, 10U) << pair.master << ' ' << pair.slave;
  }
}

TEST(MixedNetwork, FlyingMasterWhoseCpuStops_LeavesItsPlace_AndTakesItBackAsTheBest) {
  RecordProperty("spec", "RJ71-FLY-010 RJ71-CPU-005");
  Network network;
  Network::Member& best = network.add(rj71cn91, 2);
  network.add(me3can1_q, 5);
  Network::Member& last = network.add(rj71cn91, 9);
  for (Network::Member& member : network.members) {
    Network::preset(member, 0x1F80, 0, 0x21, 4);
    Network::preset(member, 0x1F90, 3, 1, 2);
    network.power(member, true);
  }
  network.run(30s);
  EXPECT_EQ(network.active(), (std::vector<unsigned>{2}));
  network.cpu(best, false);
  EXPECT_EQ(network.active(), (std::vector<unsigned>{}));
  network.run(30s);
  EXPECT_EQ(network.active(), (std::vector<unsigned>{5}));
  // In RUN again one takes part; only the best becomes active by it.
  network.cpu(last, false);
  network.run(10s);
  network.cpu(last, true);
  network.run(30s);
  EXPECT_EQ(network.active(), (std::vector<unsigned>{5}));
  network.cpu(best, true);
  network.run(30s);
  EXPECT_EQ(network.active(), (std::vector<unsigned>{2}));
}

TEST(MixedNetwork, FlyingMasters_InTheEndOneIsActive_TheBest) {
  RecordProperty("spec", "RJ71-FLY-001 RJ71-FLY-002 RJ71-FLY-003");
  const unsigned networks = support::random_cases(300, 1000);
  unsigned takeovers = 0, cuts = 0, stops = 0;
  for (unsigned seed = 1; seed <= networks; ++seed) {
    std::mt19937 random(seed);
    const auto any = [&random](unsigned from, unsigned to) {
      return std::uniform_int_distribution<unsigned>(from, to)(random);
    };
    Network network;
    const unsigned count = any(2, 4);
    std::vector<std::uint8_t> ids;
    while (ids.size() < count) {
      const auto id = static_cast<std::uint8_t>(any(1, 127));
      if (std::ranges::find(ids, id) == ids.end()) ids.push_back(id);
    }
    for (unsigned i = 0; i < count; ++i) {
      // At least one of each kind.
      Network::Member& member =
          network.add(i == 0 || (i > 1 && any(0, 1) == 0) ? rj71cn91 : me3can1_q, ids[i]);
      member.level = static_cast<std::uint16_t>(any(0, 2));
      member.is_far = any(0, 1) == 0;
      Network::preset(member, 0x1F80, 0, 0x21, 4);
      Network::preset(member, 0x1F90, 3, member.level, 2);
    }
    bool is_cut = false;
    const auto pick = [&]() -> Network::Member& {
      return *std::next(network.members.begin(), any(0, count - 1));
    };
    for (Network::Member& member : network.members) {
      if (any(0, 3) != 0) network.power(member, true);
      network.run(std::chrono::milliseconds(any(0, 500)));
    }
    for (unsigned step = 0; step < 8; ++step) {
      network.run(std::chrono::milliseconds(any(0, any(0, 2) == 0 ? 8000 : 1200)));
      switch (any(0, 4)) {
        case 0:
        case 1: {
          Network::Member& member = pick();
          takeovers += member.on ? 1 : 0;
          network.power(member, !member.on);
          break;
        }
        case 2: {
          Network::Member& member = pick();
          stops += member.runs ? 1 : 0;
          network.cpu(member, !member.runs);
          break;
        }
        default:
          is_cut = !is_cut;
          cuts += is_cut ? 1 : 0;
          network.cut(is_cut);
      }
    }
    network.cut(false);
    for (Network::Member& member : network.members) {
      network.cpu(member, true);
      network.power(member, true);
    }
    // Detect cycle 4000 + 10 n, time-out 100, delay 500, waiting time 1500 x level + 10 n, heartbeats 1500 + 10 n, and the
    // start of a module; a forced negotiation may follow the first one.
    network.run(30s);
    std::string text;
    const Network::Member* best = &network.members.front();
    for (const Network::Member& member : network.members) {
      text += std::string(member.model) + ' ' + std::to_string(member.id) + '/' +
              std::to_string(member.level) + ' ';
      if (std::pair(member.level, member.id) < std::pair(best->level, best->id)) best = &member;
    }
    EXPECT_EQ(network.active(), (std::vector<unsigned>{best->id})) << "seed " << seed << ": " << text;
    network.run(5s);
    EXPECT_EQ(network.active(), (std::vector<unsigned>{best->id})) << "seed " << seed << ": " << text;
    if (testing::Test::HasFailure() && seed < networks) {
      GTEST_FAIL() << "the first seed that fails: " << seed;
    }
  }
  if (networks >= 100) {
    EXPECT_GT(takeovers, networks);
    EXPECT_GT(cuts, networks);
    EXPECT_GT(stops, networks / 2);
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_mixed_network_test
