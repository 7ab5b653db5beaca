// Node guarding and heartbeat: every bit of G401 to G527, when it comes and when it goes [RJ71CN91 1.8, 1.9, 1.10,
// App. 2 G401].

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_error_control_test {
namespace {

using namespace rj71cn91_presets;

constexpr std::uint32_t guarded_100_by_3 = 0x00640301;  // 1F81H: assigned; guard time 100 ms, retry factor 3

/// Node 1, NMT master, guards node 5 every 100 ms; it has answered once, Pre-operational.
void guard_node_5(IntelligentScenario& s, Where where = Where::current()) {
  start_as(s, 1, {{0x1F80, 0, 0x01}, {0x1F81, 5, guarded_100_by_3}}, where);
  s.tx(0x000, {0x82, 0x00}, where).rx(0x705, {0x00}).tx_remote(0x705, where).rx(0x705, {0x7F});
  s.expect(405, 0x0001, where).expect_x(0x10, false, where);
}

TEST(Rj71Guarding, Master_MissThenLifeTime_Bit0GoesWithTheTimeOut) {
  RecordProperty("spec", "RJ71-NG-002 RJ71-BM-017 RJ71-LED-002");
  IntelligentScenario s(rj71cn91);
  guard_node_5(s);
  const std::size_t seen = s.plug_in().event_history().size();
  s.advance(99ms).no_tx().expect(405, 0x0001);
  s.advance(1ms).tx_remote(0x705).advance(99ms).expect(405, 0x0001).expect_x(0x10, false);
  EXPECT_EQ(led(s, "CAN ERR"), module::LedPattern::off);
  s.advance(1ms).expect(405, 0x0005).expect_x(0x10, true).expect_bit(29, 10, true).expect_x(0x0F, false);
  EXPECT_NE(led(s, "CAN ERR"), module::LedPattern::off);
  s.tx_remote(0x705).advance(99ms).expect(405, 0x0005).no_tx();
  s.advance(1ms).expect(405, 0x000C);  // 300 ms: the node life time; guarding is not in progress
  s.tx_remote(0x705).tx(0x000, {0x82, 0x05}).tx(0x081, {0x05, 0x8F, 0x11, 0, 0, 0, 0, 0}).no_tx();
  EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{0x0412, 0x0412}));
  EXPECT_EQ(s.plug_in().event_history().back().detail, 5U);
  EXPECT_NE(led(s, "CAN ERR"), module::LedPattern::off);
  // It answers again: guarding is in progress; the failures stay until Y10.
  s.rx(0x705, {0x00}).ignore_tx().rx(0x705, {0x7F}).ignore_tx().expect(405, 0x000D).expect(605, 0x7F);
  s.write(400, 5).y(0x10, true).expect(405, 0x0001).expect_x(0x10, false).expect(29, 0).y(0x10, false);
  EXPECT_EQ(led(s, "CAN ERR"), module::LedPattern::off);
  s.ignore_tx();
}

TEST(Rj71Guarding, Master_InvalidAnswer_IsBit2_StopRequest_EndsBit0) {
  RecordProperty("spec", "RJ71-NG-002 RJ71-NG-012 RJ71-BM-017");
  IntelligentScenario s(rj71cn91);
  guard_node_5(s);
  s.advance(100ms).tx_remote(0x705).rx(0x705, {0x7F}).expect(405, 0x0005).expect_x(0x10, true);  // toggle bit
  s.y(0x10, true).expect(405, 0x0001).y(0x10, false);
  s.advance(100ms).ignore_tx().rx(0x705, {0xFF}).y(0x10, true).expect(405, 0x0001).y(0x10, false);
  // The states it may have.
  bool toggle = false;
  for (const std::uint8_t state : Bytes{0x05, 0x04, 0x7F}) {
    s.set_object(0x1F82, 5, state, 1);
    s.advance(100ms).ignore_tx().rx(0x705, {static_cast<std::uint8_t>(state | (toggle ? 0x80 : 0x00))});
    s.no_tx().expect(605, state).expect(405, 0x0001);
    s.expect_object(0x1F82, 5, state, 1);
    toggle = !toggle;
  }
  s.set_object(0x1F83, 5, 0, 1);
  s.ignore_tx().expect(405, 0).advance(1s).no_tx().expect(405, 0);
}

// The slave's word is its own: the master's number is not known to it.
TEST(Rj71Guarding, Slave_NoRemoteFrameInGuardTime_Bit2_InLifeTime_Bit6) {
  RecordProperty("spec", "RJ71-NG-005 RJ71-NG-010 RJ71-BM-017");
  struct Behaviour {
    std::uint8_t value;
    std::uint16_t state;
  };
  for (const Behaviour& behaviour : {Behaviour{0, 0x7F}, Behaviour{1, 0x05}, Behaviour{2, 0x04}}) {
    for (const std::uint8_t node : Bytes{3, 127}) {
      const module::BufferAddress word = 400U + node;
      const std::uint32_t identifier = 0x700U + node;
      IntelligentScenario s(rj71cn91);
      start_as(s, node, {{0x100C, 0, 100, 2}, {0x100D, 0, 3, 1}, {0x1029, 1, behaviour.value, 1}});
      s.nmt(0x01).advance(10s).no_tx().expect(word, 0);  // not before the first remote frame
      s.rx_remote(identifier, 1).tx(identifier, {0x05}).expect(word, 0x0001).expect_x(0x10, false);
      s.advance(99ms).expect(word, 0x0001).rx_remote(identifier, 1).tx(identifier, {0x85});
      s.advance(99ms).expect(word, 0x0001).expect_x(0x10, false);
      const std::size_t seen = s.plug_in().event_history().size();
      s.advance(1ms).expect(word, 0x0005).expect_x(0x10, true).no_tx().expect(600U + node, 0x05);
      EXPECT_EQ(event_codes(s, seen), (std::vector<std::uint16_t>{}));
      s.advance(199ms).expect(word, 0x0005).no_tx();
      s.advance(1ms).expect(word, 0x0044).expect(600U + node, behaviour.state);
      s.tx(0x080U + node, {node, 0x8F, 0x11, 0, 0, 0, 0, 0}).no_tx();
      EXPECT_EQ(event_codes(s, seen).front(), 0x0413);
      EXPECT_NE(led(s, "CAN ERR"), module::LedPattern::off);
      // Asked again: in progress; the failures stay until Y10.
      s.rx_remote(identifier, 1).ignore_tx().expect(word, 0x0045);
      s.y(0x10, true).expect(word, 0x0001).expect_x(0x10, false).y(0x10, false).expect(word, 0x0001);
      s.advance(100ms).expect(word, 0x0005).ignore_tx();
      // A heartbeat of its own ends it.
      s.set_object(0x1017, 0, 1000, 2).advance(1s).ignore_tx().expect_bit(word, 0, false);
    }
  }
  // The master may guard without the slave doing so: it answers, and watches nobody.
  IntelligentScenario slave(rj71cn91);
  start_as(slave, 3, {{0x1029, 1, 0, 1}});
  slave.nmt(0x01).rx_remote(0x703, 1).tx(0x703, {0x05}).advance(60s).no_tx().expect(403, 0).expect(603, 5);
}

/// Node 1 as `start_up` (1F80H) says, watching node 9 by heartbeat in 500 ms.
void watch_node_9(IntelligentScenario& s, std::uint32_t start_up, Where where = Where::current()) {
  start_as(s, 1, {{0x1F80, 0, start_up}, {0x1016, 126, 0x000901F4}}, where);
  if (start_up != 0) s.tx(0x000, {0x82, 0x00}, where);
  s.nmt(0x01, 1).ignore_tx();
}

TEST(Rj71Heartbeat, TimeOut_Bit7_AndBit1Goes) {
  RecordProperty("spec", "RJ71-HB-002 RJ71-HB-004 RJ71-HB-006 RJ71-BM-017 RJ71-LED-002");
  for (const std::uint32_t start_up : {0U, 1U}) {  // as a slave, as the NMT master
    IntelligentScenario s(rj71cn91);
    watch_node_9(s, start_up);
    s.advance(10s).no_tx().expect(409, 0).expect(609, 0);  // not before the first heartbeat
    s.rx(0x709, {0x05}).expect(409, 0x0002).expect(609, 5).expect_x(0x10, false);
    s.advance(499ms).rx(0x709, {0x05}).advance(499ms).expect(409, 0x0002).no_tx();
    EXPECT_EQ(led(s, "CAN ERR"), module::LedPattern::off);
    const std::size_t seen = s.plug_in().event_history().size();
    s.advance(1ms).expect(409, 0x0080).expect_x(0x10, true).expect(29, 0x0400).expect_x(0x0F, false);
    s.tx(0x081, {0x09, 0x8F, 0x11, 0, 0, 0, 0, 0}).no_tx();
    EXPECT_EQ(event_codes(s, seen).front(), 0x0412);
    EXPECT_EQ(s.plug_in().event_history()[seen].detail, 9U);
    EXPECT_NE(led(s, "CAN ERR"), module::LedPattern::off);
    // Error behaviour of a slave, none of an NMT master.
    s.expect(601, start_up == 0 ? 0x7F : 0x05);
    s.rx(0x709, {0x05}).expect(409, 0x0082).no_tx();  // heard again; the failure stays until Y10
    s.y(0x10, true).expect(409, 0x0002).expect_x(0x10, false).y(0x10, false);
    for (const std::uint8_t state : Bytes{0x04, 0x7F, 0x05}) s.rx(0x709, {state}).expect(609, state);
    s.ignore_tx();
  }
}

// "The latest NMT state in which instructions were given from the consumer", or that in which watching began.
TEST(Rj71Heartbeat, AnotherStateThanExpected_IsBit5) {
  RecordProperty("spec", "RJ71-HB-005 RJ71-BM-017");
  for (const std::uint8_t began : Bytes{0x05, 0x04, 0x7F}) {  // nobody was commanded
    IntelligentScenario s(rj71cn91);
    watch_node_9(s, 0);
    s.rx(0x709, {began}).advance(100ms).rx(0x709, {began}).expect(409, 0x0002);
    const std::uint8_t other = began == 0x05 ? 0x7F : 0x05;
    s.rx(0x709, {other}).expect(409, 0x0022).expect_x(0x10, true).expect(609, other);
    // A wrong state is no lost node: nothing is sent, the own state stays.
    s.no_tx().expect(601, 5);
    s.rx(0x709, {began}).expect(409, 0x0022);  // until Y10
    s.y(0x10, true).expect(409, 0x0002).y(0x10, false).rx(0x709, {began}).expect(409, 0x0002);
    s.rx(0x709, {other}).expect(409, 0x0022);
  }
  IntelligentScenario master(rj71cn91);
  watch_node_9(master, 1);
  master.rx(0x709, {0x7F}).expect(409, 0x0002);
  master.set_object(0x1F82, 9, 0x05, 1);
  master.tx(0x000, {0x01, 0x09}).advance(100ms).rx(0x709, {0x05}).expect(409, 0x0002).expect(609, 5);
  master.set_object(0x1F82, 9, 0x04, 1);
  master.tx(0x000, {0x02, 0x09}).advance(100ms).rx(0x709, {0x05}).expect(409, 0x0022).expect_x(0x10, true);
  master.no_tx().expect(609, 5);
  // Lost and heard again: what was instructed still counts.
  master.y(0x10, true).y(0x10, false).rx(0x709, {0x04}).expect(409, 0x0002).advance(500ms).ignore_tx();
  master.expect(409, 0x0080).rx(0x709, {0x05}).expect(409, 0x00A2).ignore_tx();
  // After its boot-up nothing is instructed: watching begins anew.
  master.y(0x10, true).y(0x10, false).rx(0x709, {0x00}).rx(0x709, {0x04}).expect(409, 0x0002);
}

TEST(Rj71Heartbeat, ConsumerTimeBelowTheProducers_LosesEachOne) {
  RecordProperty("spec", "RJ71-HB-003");
  IntelligentScenario s(rj71cn91);
  watch_node_9(s, 0);
  for (unsigned times = 0; times < 3; ++times) {  // the producer's time 600 ms, the consumer's 500 ms
    s.rx(0x709, {0x05}).expect_bit(409, 1, true).ignore_tx();
    s.advance(499ms).expect_bit(409, 1, true).advance(101ms);
    s.expect(409, 0x0080).expect_x(0x10, true).ignore_tx();  // bit 1 goes on and off
  }
  IntelligentScenario good(rj71cn91);
  watch_node_9(good, 0);
  for (unsigned times = 0; times < 100; ++times) good.rx(0x709, {0x05}).advance(333ms);  // 1.5 times
  good.expect(409, 0x0002).no_tx();
}

// 1.10: what counts as a communication error, and that it acts in Operational.
TEST(Rj71ErrorBehaviour, BusOff_LostMaster_LostHeartbeat_CpuStop_OfASlave_NoHeartbeatOfTheMaster) {
  RecordProperty("spec", "RJ71-ERRB-002 RJ71-NMT-007 RJ71-NMT-011");
  enum class Cause : std::uint8_t { bus_off, life_guarding, heartbeat, cpu_stop };
  struct Behaviour {
    std::uint8_t value;
    std::uint16_t state;
  };
  for (const std::uint32_t start_up : {0U, 1U}) {
    for (const Cause cause : {Cause::bus_off, Cause::life_guarding, Cause::heartbeat, Cause::cpu_stop}) {
      for (const Behaviour& behaviour : {Behaviour{0, 0x7F}, Behaviour{1, 0x05}, Behaviour{2, 0x04}}) {
        if (start_up != 0 && cause == Cause::life_guarding) continue;  // an NMT master is nobody's slave
        IntelligentScenario s(rj71cn91);
        start_as(s, 1,
                 {{0x1F80, 0, start_up},
                  {0x100C, 0, 100, 2},
                  {0x100D, 0, 2, 1},
                  {0x1016, 1, 0x00090064},
                  {0x1029, 1, behaviour.value, 1}});
        if (start_up == 0) s.nmt(0x01, 1);
        s.advance(1s).ignore_tx().expect(601, 0x05);
        switch (cause) {
          case Cause::bus_off: s.error_counters(256, 0); break;
          case Cause::life_guarding: s.rx_remote(0x701, 1).advance(200ms); break;
          case Cause::heartbeat: s.rx(0x709, {0x05}).advance(100ms); break;
          case Cause::cpu_stop: s.cpu(module::CpuState::stop); break;
        }
        std::uint16_t expected = behaviour.state;
        if (cause == Cause::cpu_stop && behaviour.value == 1) expected = 0x7F;
        if (cause == Cause::heartbeat && start_up != 0) expected = 0x05;
        s.expect(601, expected).ignore_tx();
      }
    }
  }
  // A master's guarding of a slave runs error event control instead.
  IntelligentScenario s(rj71cn91);
  start_as(s, 1, {{0x1F80, 0, 0x01}, {0x1F81, 5, guarded_100_by_3}, {0x1029, 1, 2, 1}});
  s.tx(0x000, {0x82, 0x00}).rx(0x705, {0x00}).tx_remote(0x705).rx(0x705, {0x7F});
  s.expect(601, 0x05).advance(400ms).expect_bit(405, 3, true).expect(601, 0x05).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_error_control_test
