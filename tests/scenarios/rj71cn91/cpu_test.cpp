// The CPU's STOP and RUN [RJ71CN91 App. 4, 1.7, 1.10], and what a program sees of start-ups.

#include <set>

#include "canopus/canopen/dictionary/object_dictionary.hpp"

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::rj71cn91_cpu_test {
namespace {

constexpr auto run = module::CpuState::run;
constexpr auto stop = module::CpuState::stop;
const Bytes me002{0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x32};
const Bytes no_error(8, 0);

void preset(IntelligentScenario& s, std::uint16_t index, std::uint8_t sub, std::uint32_t value,
            unsigned length) {
  ASSERT_EQ(s.plug_in().preset_object(index, sub, canopen::little_endian(value, length)),
            canopen::AbortCode::none);
}

/// 1029:01, and where it leads from Operational when the CPU stops.
struct Behaviour {
  std::uint8_t value;
  std::uint16_t state;
};
constexpr std::array behaviours{Behaviour{0, 0x7F}, Behaviour{1, 0x7F}, Behaviour{2, 0x04}};

TEST(Rj71Cpu, Slave_GoesWhere1029HSays_SendsMe002_AndRunLeavesItThere) {
  RecordProperty("spec", "RJ71-CPU-001 RJ71-CPU-002 RJ71-EMCY-003 RJ71-ERRB-003 RJ71-ERRB-004");
  for (const Behaviour& behaviour : behaviours) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(3);
    s.set_object(0x1029, 1, behaviour.value, 1);
    s.set_object(0x1017, 0, 100, 2);
    s.nmt(0x01, 3).ignore_tx().expect(603, 0x05);
    s.cpu(stop).tx(0x083, me002).no_tx().expect(603, behaviour.state);
    // A slave keeps its heartbeat.
    s.advance(250ms).tx(0x703, {static_cast<std::uint8_t>(behaviour.state)});
    s.ignore_tx();
    s.nmt(0x01, 3);
    s.expect(603, behaviour.value == 1 ? 0x05 : behaviour.state);
    const std::uint16_t before = s.read(603);
    s.cpu(run).ignore_tx().expect(603, before).advance(1s).ignore_tx().expect(603, before);
    s.nmt(0x01, 3).expect(603, 0x05).ignore_tx();
    // Outside of Operational 0 and 1 change nothing, 2 stops.
    s.nmt(0x80, 3).cpu(stop).expect(603, behaviour.state).ignore_tx();
  }
}

TEST(Rj71Cpu, Run_TakesMe002OutOfTheHistory_AndReportsNoErrorWhenItIsEmpty) {
  RecordProperty("spec", "RJ71-EMCY-004");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(3);
  s.cpu(stop).tx(0x083, me002);
  s.expect_object(0x1003, 0, 1, 1);
  s.expect_object(0x1001, 0, 0x81, 1);
  s.cpu(run).tx(0x083, no_error).no_tx();
  s.expect_object(0x1003, 0, 0, 1);
  s.expect_object(0x1001, 0, 0, 1);
  // With another error in the list only its own entry goes.
  s.cif({0x000A, 0x1000, 0x0001, 0, 0}).ignore_tx();
  s.cpu(stop).ignore_tx();
  s.expect_object(0x1003, 0, 2, 1);
  s.cpu(run).no_tx();
  s.expect_object(0x1003, 0, 1, 1);
  s.expect_object(0x1003, 1, 0x00001000, 4);
  s.cif({0x0004, 0, 0x1001, 0}).expect(1005, 0x0081);
  s.ignore_tx();
}

TEST(Rj71Cpu, StopRightAfterTheStart_CountsAsRunToStop) {
  RecordProperty("spec", "RJ71-CPU-002 RJ71-EMCY-003");
  for (const Behaviour& behaviour : behaviours) {
    IntelligentScenario s(rj71cn91);
    s.plug_in().preset_node_id(3);
    preset(s, 0x1029, 1, behaviour.value, 1);
    s.cpu(stop).supply_on().advance(1s);
    s.tx(0x703, {0x00}).tx(0x083, me002).no_tx();
    s.expect(603, behaviour.value == 2 ? 0x04 : 0x7F);
    s.nmt(0x01, 3).expect(603, behaviour.value == 1 ? 0x05 : behaviour.value == 2 ? 0x04 : 0x7F);
    // After an NMT reset likewise: the node starts, and the CPU is in STOP.
    s.nmt(0x82, 3).advance(20ms).tx(0x703, {0x00}).tx(0x083, me002).no_tx();
  }
  IntelligentScenario in_run(rj71cn91);
  in_run.plug_in().preset_node_id(3);
  in_run.supply_on().advance(1s).tx(0x703, {0x00}).no_tx();
}

// A CPU error that stops the CPU is a STOP like any other: one message.
TEST(Rj71Cpu, StopByAnError_IsAStop) {
  RecordProperty("spec", "RJ71-CPU-002");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(3);
  s.plug_in().cpu_failed(s.now());
  s.cpu(stop).tx(0x083, me002).no_tx();
}

TEST(Rj71Cpu, Master_StopEndsItsRoleAndHeartbeat_RunBeginsThemAnew) {
  RecordProperty("spec", "RJ71-CPU-003 RJ71-CPU-004 RJ71-HB-007 RJ71-STARTUP-001");
  IntelligentScenario s(rj71cn91);
  s.plug_in().preset_node_id(1);
  preset(s, 0x1F80, 0, 1, 4);
  preset(s, 0x1017, 0, 100, 2);
  preset(s, 0x1005, 0, 0x40000080, 4);
  preset(s, 0x1006, 0, 50'000, 4);
  preset(s, 0x1F81, 5, 0x00640301, 4);  // guarded every 100 ms
  s.power_on();
  s.advance(1s).expect_bit(25, 15, true).expect(601, 0x05);
  s.ignore_tx().advance(100ms);
  bool sync = false, heartbeat = false, guarding = false;
  for (const can::Frame& frame : s.controller().sent) {
    sync = sync || frame.identifier == 0x080;
    heartbeat = heartbeat || frame.identifier == 0x701;
    guarding = guarding || (frame.identifier == 0x705 && frame.remote);
  }
  EXPECT_TRUE(sync && heartbeat && guarding);
  s.ignore_tx();

  s.cpu(stop).tx(0x081, me002).expect_bit(25, 15, false).expect_bit(25, 14, false).expect(601, 0x7F);
  s.advance(3s).no_tx();
  s.cif({0x0002, 0, 0x1F82, 5, 1, 0x05}).expect(1000, 0x000F).no_tx();  // no NMT master

  s.cpu(run).tx(0x081, no_error);
  s.wait_tx(0x000, {0x82, 0x00}).expect_bit(25, 15, true);
  s.advance(1s).expect(601, 0x05);
  sync = heartbeat = false;
  for (const can::Frame& frame : s.controller().sent) {
    sync = sync || frame.identifier == 0x080;
    heartbeat = heartbeat || (frame.identifier == 0x701 && !frame.remote);
  }
  EXPECT_TRUE(sync && heartbeat);
  s.ignore_tx();
}

TEST(Rj71Cpu, MasterInStop_DoesNotBegin_UntilRun) {
  RecordProperty("spec", "RJ71-CPU-003 RJ71-CPU-004 RJ71-STARTUP-001 RJ71-HB-007");
  IntelligentScenario s(rj71cn91);
  s.plug_in().preset_node_id(1);
  preset(s, 0x1F80, 0, 1, 4);
  preset(s, 0x1017, 0, 100, 2);
  s.cpu(stop).supply_on().advance(1s).tx(0x701, {0x00}).tx(0x081, me002);
  s.advance(5s).no_tx().expect_bit(25, 15, false).expect(601, 0x7F);
  s.cpu(run).tx(0x081, no_error).wait_tx(0x000, {0x82, 0x00});
  s.expect_bit(25, 15, true).advance(1s).expect(601, 0x05).ignore_tx();
}

// --- start-up bits of G25

TEST(Rj71StartUp, MandatorySlaveMissing_G25_11_UntilTheMasterStartsAnew) {
  RecordProperty("spec", "RJ71-STARTUP-011 RJ71-STARTUP-017 RJ71-STARTUP-018");
  for (const std::uint32_t boot_time : {700U, 2000U}) {
    IntelligentScenario s(rj71cn91);
    s.plug_in().preset_node_id(1);
    preset(s, 0x1F80, 0, 1, 4);
    preset(s, 0x1F81, 5, 0x0D, 4);
    preset(s, 0x1F89, 0, boot_time, 4);
    s.power_on();
    s.expect_bit(25, 11, false).expect_bit(25, 14, true);
    s.advance(std::chrono::milliseconds(boot_time - 100)).ignore_tx().expect_bit(25, 11, false);
    s.advance(1s).ignore_tx().expect_bit(25, 11, true).expect_bit(25, 14, false).expect(601, 0x7F);
    s.expect_bit(405, 4, true);
    s.rx(0x705, {0x00}).advance(5s).no_tx().expect_bit(25, 11, true);  // start-up is over
    s.restart();
    s.expect_bit(25, 11, false).ignore_tx();
  }
  IntelligentScenario unlimited(rj71cn91);  // 1F89H = 0
  unlimited.plug_in().preset_node_id(1);
  preset(unlimited, 0x1F80, 0, 1, 4);
  preset(unlimited, 0x1F81, 5, 0x0D, 4);
  unlimited.power_on();
  unlimited.advance(600s).ignore_tx().expect_bit(25, 11, false).expect_bit(25, 14, true);
}

TEST(Rj71StartUp, OptionalSlaveFailed_G25_13_AndTheStartUpGoesOn) {
  RecordProperty("spec", "RJ71-STARTUP-012 RJ71-SLAVEID-005");
  IntelligentScenario s(rj71cn91);
  s.plug_in().preset_node_id(1);
  preset(s, 0x1F80, 0, 1, 4);
  preset(s, 0x1F81, 5, 0x05, 4);
  preset(s, 0x1F85, 5, 0x1234, 4);
  s.power_on();
  s.expect_bit(25, 13, false);
  s.rx(0x705, {0x00}).wait_tx(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x585, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  s.wait_tx(0x605, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
  s.rx(0x585, {0x43, 0x18, 0x10, 0x01, 0x35, 0x12, 0x00, 0x00});
  s.advance(1s).ignore_tx();
  s.expect_bit(25, 13, true).expect_bit(25, 14, false).expect_bit(25, 11, false).expect(601, 0x05);
  s.expect(605, 0x7F).expect_bit(405, 4, true);
  EXPECT_EQ(s.plug_in().module_errors().front().code, 0x1806);
  // Booted at its next try, with the identity it should have.
  s.rx(0x705, {0x00}).wait_tx(0x605, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x585, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00});
  s.wait_tx(0x605, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
  s.rx(0x585, {0x43, 0x18, 0x10, 0x01, 0x34, 0x12, 0x00, 0x00});
  s.advance(1s).ignore_tx().expect_bit(25, 13, false);
}

// --- identification of a slave

/// 1000H and 1018:01-04 of slave 5.
using Identity = std::array<std::uint32_t, 5>;

/// Boots slave 5, which has this identity. Whether it was started; `asked`: the objects that were read.
bool is_started(const Identity& expected, const Identity& found, std::set<std::size_t>& asked) {
  IntelligentScenario s(rj71cn91);
  s.plug_in().preset_node_id(1);
  preset(s, 0x1F80, 0, 1, 4);
  preset(s, 0x1F81, 5, 0x05, 4);
  for (std::size_t item = 0; item < expected.size(); ++item) {
    preset(s, static_cast<std::uint16_t>(0x1F84 + item), 5, expected[item], 4);
  }
  s.power_on();
  s.rx(0x705, {0x00});
  bool started = false;
  for (unsigned step = 0; step < 100; ++step) {
    s.advance(20ms);
    while (!s.controller().sent.empty()) {
      const can::Frame frame = s.controller().sent.front();
      s.controller().sent.pop_front();
      if (frame.identifier == 0x000 && frame.data[0] == 0x01 && frame.data[1] == 5) started = true;
      if (frame.identifier != 0x605) continue;
      const std::size_t item = frame.data[1] == 0x00 ? 0 : frame.data[3];
      asked.insert(item);
      Bytes answer{0x43, frame.data[1], frame.data[2], frame.data[3]};
      for (const std::uint8_t byte : canopen::little_endian(found[item], 4)) answer.push_back(byte);
      s.rx(0x585, answer);
    }
  }
  EXPECT_EQ(s.read(605), started ? 0x05 : 0x7F);
  EXPECT_EQ((s.read(405) & 0x0010) != 0, !started);
  s.ignore_tx();
  return started;
}

TEST(Rj71StartUp, Identity_EachItemIsCompared_UnlessItIs0) {
  RecordProperty("spec", "RJ71-SLAVEID-001 RJ71-SLAVEID-002 RJ71-SLAVEID-003");
  const Identity own{0x00020191, 0x1D0, 0x100, 0x00010002, 4711};
  std::set<std::size_t> asked;
  EXPECT_TRUE(is_started(own, own, asked));
  EXPECT_EQ(asked, (std::set<std::size_t>{0, 1, 2, 3, 4}));
  asked.clear();
  EXPECT_TRUE(is_started({0, 0, 0, 0, 0}, own, asked));
  EXPECT_EQ(asked, (std::set<std::size_t>{0}));  // its presence
  for (const std::size_t item : {0U, 1U, 2U, 4U}) {
    for (const std::int64_t step : {-1, 1, 0x10000}) {
      Identity other = own;
      other[item] = static_cast<std::uint32_t>(own[item] + step);
      EXPECT_FALSE(is_started(own, other, asked)) << item << ' ' << step;
      Identity unchecked = own;
      unchecked[item] = 0;
      asked.clear();
      EXPECT_TRUE(is_started(unchecked, other, asked)) << item << ' ' << step;
      EXPECT_EQ(asked.contains(item), item == 0) << item;
    }
  }
}

TEST(Rj71StartUp, Revision_SameMajor_AndNoOlderMinor) {
  RecordProperty("spec", "RJ71-SLAVEID-004");
  std::set<std::size_t> asked;
  const auto passes = [&asked](std::uint32_t parameter, std::uint32_t found) {
    return is_started({0, 0, 0, parameter, 0}, {0x191, 1, 2, found, 3}, asked);
  };
  EXPECT_TRUE(passes(0x00010002, 0x00010002));
  EXPECT_TRUE(passes(0x00010002, 0x00010005));
  EXPECT_FALSE(passes(0x00010002, 0x00010001));
  EXPECT_FALSE(passes(0x00010002, 0x00020002));
  EXPECT_FALSE(passes(0x00010002, 0x00000005));
  EXPECT_TRUE(passes(0x00010000, 0x0001FFFF));
  EXPECT_TRUE(passes(0xFFFF0001, 0xFFFF0001));
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_cpu_test
