// What each function mode has, its frames, and the way from one to another [RJ71CN91 1.1, 1.2 NMT state, 2.1, App. 1 Y2, Y3,
// App. 2 G21].

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_function_modes_test {
namespace {

using namespace rj71cn91_presets;

const Bytes read_1000{0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0};
const Bytes is_0195{0x43, 0x00, 0x10, 0x00, 0x95, 0x01, 0x00, 0x00};
const Bytes foreign_emergency{0x10, 0x81, 0x11, 0, 0, 0, 0, 0};
const Bytes some_time{0, 0, 0, 0, 0x10, 0x27};
constexpr auto stop = module::CpuState::stop;

can::Frame extended(can::Frame frame) {
  frame.extended = true;
  return frame;
}

/// Which services the module has now, by what it sends and shows.
struct Services {
  bool sdo = false;
  bool sync = false;
  bool time = false;
  bool emcy = false;
  bool pdo = false;
  bool guarding = false;
  bool operator==(const Services&) const = default;
};

Services services(IntelligentScenario& s, std::uint8_t node) {
  Services found;
  const auto answers = [&s](std::uint32_t identifier) {
    bool answered = false;
    for (const can::Frame& frame : s.controller().sent) answered = answered || frame.identifier == identifier;
    s.ignore_tx();
    return answered;
  };
  s.ignore_tx().rx(0x600U + node, read_1000);
  found.sdo = answers(0x580U + node);
  s.rx(0x080, {0x01});  // a byte too many: EMCY 8200H says that SYNC is heard
  found.sync = answers(0x080U + node);
  s.rx(0x080);
  s.cif({0x0002, 0, 0x1003, 0, 1, 0}).ignore_tx();
  s.write(25, 0xEFFF).rx(0x100, some_time);
  found.time = (s.read(25) & 0x1000) != 0;
  s.y(0x11, true).y(0x11, false).rx(0x085, foreign_emergency);
  found.emcy = s.x(0x11);
  s.write(13000, static_cast<std::uint16_t>(s.read(13000) + 1)).y(0x01, true).advance(100ms).y(0x01, false);
  const bool sends = answers(0x180U + node);
  s.rx(0x200U + node, {static_cast<std::uint8_t>(s.read(10000) + 1), 0, 0, 0, 0, 0, 0, 0});
  const std::uint16_t before = s.read(10000);
  s.y(0x01, true).advance(100ms).y(0x01, false);
  found.pdo = sends && s.read(10000) != before;
  EXPECT_EQ(sends, s.read(10000) != before);
  s.rx_remote(0x700U + node, 1);
  found.guarding = answers(0x700U + node);
  return found;
}

TEST(Rj71Nmt, Services_OfEachState) {
  RecordProperty("spec", "RJ71-NMT-003 RJ71-NMT-004 RJ71-NMT-005");
  for (const std::uint8_t node : Bytes{1, 127}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(node);
    const Services pre_operational{.sdo = true, .sync = true, .time = true, .emcy = true, .guarding = true};
    Services operational = pre_operational;
    operational.pdo = true;
    const Services stopped{.guarding = true};
    EXPECT_EQ(services(s, node), pre_operational);
    s.expect(25, 0x1100);
    // Parameters of PDOs can be changed here.
    s.set_object(0x1800, 1, 0xC0000180U + node, 4).set_object(0x1800, 2, 0xFE, 1);
    s.set_object(0x1800, 1, 0x40000180U + node, 4);
    s.nmt(0x01, node);
    EXPECT_EQ(services(s, node), operational);
    s.expect(25, 0x1201);
    s.nmt(0x02, node);
    EXPECT_EQ(services(s, node), stopped);
    s.expect(25, 0x0000);
    s.cif({0x000A, 0x1000, 0x0001, 0, 0}).expect(1000, {0x000C, 0x0002}).no_tx();
    s.nmt(0x80, node);
    EXPECT_EQ(services(s, node), pre_operational);
    s.nmt(0x02, node);
    s.nmt(0x01, node);
    EXPECT_EQ(services(s, node), operational);
    // Heartbeats in each state.
    s.set_object(0x1017, 0, 100, 2).ignore_tx();
    for (const auto& [command, state] :
         std::map<std::uint8_t, std::uint8_t>{{0x01, 0x05}, {0x02, 0x04}, {0x80, 0x7F}}) {
      s.nmt(command, node);
      s.ignore_tx().advance(100ms).tx(0x700U + node, {state}).no_tx();
    }
  }
}

TEST(Rj71Nmt, Path9_ResetsFromEveryState_ToInitialization) {
  RecordProperty("spec", "RJ71-NMT-012");
  for (const std::uint8_t reset : Bytes{0x81, 0x82}) {
    for (const std::uint8_t before : Bytes{0x80, 0x01, 0x02}) {
      for (const std::uint8_t to : Bytes{0, 9}) {  // to all, to it
        IntelligentScenario s(rj71cn91);
        s.power_on_as(9);
        s.nmt(before).nmt(reset, to).expect_bit(25, 7, true).expect(25, 0x0080).expect(609, 0x07);
        s.wait_bit(25, 7, false).tx(0x709, {0x00}).no_tx().expect(25, 0x0100).expect(609, 0x7F);
      }
    }
  }
  for (const bool by_supply : {true, false}) {  // path 1: the supply, Y2
    IntelligentScenario s(rj71cn91);
    s.power_on_as(9);
    s.nmt(0x01).expect(25, 0x0201);
    if (by_supply) s.supply_off().supply_on();
    if (!by_supply) s.y(0x02, true);
    s.expect(25, 0x0080).ignore_tx().wait_bit(25, 7, false).tx(0x709, {0x00}).no_tx().expect(25, 0x0100);
  }
}

TEST(Rj71Modes, Canopen405_HasEveryServiceOfCanopen_AndNoLayer2) {
  RecordProperty("spec", "RJ71-MODE-002 RJ71-MODE-009");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.expect(21, 405);
  s.expect_object(0x1000, 0, 0x195, 4);
  s.nmt(0x01, 1);
  EXPECT_EQ(services(s, 1), (Services{true, true, true, true, true, true}));
  s.set_object(0x1017, 0, 100, 2).ignore_tx().advance(100ms).tx(0x701, {0x05});
  s.set_object(0x1017, 0, 0, 2).ignore_tx();
  // Settings of Layer 2, taken before: no words, no signals, no frames.
  s.write(6000, {0xFFFF, 0x5FFF, 2, 1}).expect(6000, {0, 0, 0, 0});
  s.write(8450, {0x123, 0, 1, 0x55}).expect(8450, {0, 0, 0, 0}).expect(29, 0);
  s.y(0x03, true).y(0x04, true).advance(1s).expect_x(0x03, false).expect_x(0x04, false).no_tx();
  s.cif({0x000C, 0x123, 0, 0, 1, 0x55}).expect(1000, {0x000F, 0x0064}).no_tx();
  s.rx(0x123, {1, 2}).no_tx();
  s.cpu(stop).tx(0x081, {0x00, 0xFF, 0x81, 0x4D, 0x45, 0x30, 0x30, 0x32}).no_tx();  // no STOP message
  s.expect(601, 0x7F);  // operation at error occurrence
}

TEST(Rj71Modes, Layer2_HasNothingOfCanopen) {
  RecordProperty("spec", "RJ71-MODE-003 RJ71-MODE-009");
  for (const std::uint16_t mode : Words{11, 29}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(1);
    // What would send, were it CANopen: heartbeat, NMT master, SYNC, guarding.
    s.set_object(0x1017, 0, 100, 2).set_object(0x1F80, 0, 1, 4).set_object(0x1006, 0, 10'000, 4);
    s.set_object(0x1005, 0, 0x40000080, 4).set_object(0x1F81, 5, 0x00640305, 4);
    s.store_objects();
    s.write(21, mode).expect(21, mode);
    s.save().supply_off();
    s.controller().sent.clear();
    s.supply_on().advance(10s).no_tx().expect(21, mode);  // no boot-up frame
    s.write(8450, {0x124, 0, 1, 0x77}).y(0x03, true).expect_x(0x03, true).no_tx();
    for (const std::uint8_t command : Bytes{0x01, 0x02, 0x80, 0x81, 0x82}) s.nmt(command).nmt(command, 1);
    s.rx(0x601, read_1000).rx(0x080).rx(0x080, {1}).rx(0x100, some_time).rx(0x085, foreign_emergency);
    s.rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8}).rx_remote(0x701, 1).rx_remote(0x181, 8).rx(0x705, {0x00});
    s.advance(60s).no_tx().expect(25, 0x0000).expect_x(0x11, false).expect_x(0x10, false).expect(601, 0);
    s.y(0x11, true).y(0x12, true).y(0x13, true).advance(1s).expect_x(0x12, false).expect_x(0x13, false);
    s.cif({0x0004, 0, 0x1000, 0}).expect(1000, {0x000F, 0x0064});
    s.cif({0x000A, 0x1000, 1, 0, 0}).expect(1000, {0x000F, 0x0064}).no_tx();
    // Layer 2 it has: the command interface and the STOP message.
    const auto form = [mode](const can::Frame& frame) { return mode == 29 ? extended(frame) : frame; };
    s.cif({0x000C, 0x123, 0, 0, 1, 0x55}).expect(1000, 0x000D).tx(form(can::data_frame(0x123, Bytes{0x55})));
    s.cpu(stop).tx(form(can::data_frame(0x124, Bytes{0x77}))).no_tx();
    // Back in 405 mode what was stored is there.
    s.cpu(module::CpuState::run).y(0x03, false).write(21, 405);
    s.save();
    s.restart().expect_object(0x1017, 0, 100, 2).ignore_tx();
  }
}

TEST(Rj71Modes, FramesOfTheOtherForm_AreNobodys) {
  RecordProperty("spec", "RJ71-MODE-004");
  for (const std::uint16_t mode : Words{11, 29}) {
    const auto own = [mode](can::Frame frame) { return mode == 29 ? extended(frame) : frame; };
    const auto other = [mode](can::Frame frame) { return mode == 11 ? extended(frame) : frame; };
    IntelligentScenario s(rj71cn91);
    s.power_on_layer2(mode);
    s.write(6000, {0x123, 0, 0, 0});                                          // slot 1 receives 123H
    s.write(6004, {0, 0, 0xFFFF, 0x1FFF});                                    // slot 2 everything
    s.write(6008, {0xFFFF, 0x7FFF, 0, 0}).write(10014, {0x321, 0, 1, 0x44});  // slot 3 sends and answers
    s.write(6164, {0xFFFF, 0x6FFF, 4, 0}).write(10287, {0x322, 0, 1});        // slot 42 shows remote frames
    s.write(8471, {0x555, 0, 0});
    s.y(0x03, true).tx(own(can::data_frame(0x321, Bytes{0x44}))).tx(own(can::data_frame(0x322, Bytes{0})));
    s.rx(other(can::data_frame(0x123, Bytes{1}))).rx(other(can::remote_frame(0x321, 1)));
    s.rx(other(can::remote_frame(0x322, 1))).expect(8352, 0);
    s.y(0x01, true).wait_x(0x01, true).y(0x01, false).tx(own(can::data_frame(0x321, Bytes{0x44}))).no_tx();
    s.expect(10000, {0, 0, 0}).expect(10007, {0, 0, 0});
    s.rx(own(can::data_frame(0x123, Bytes{1}))).rx(own(can::remote_frame(0x321, 1)));
    s.tx(own(can::data_frame(0x321, Bytes{0x44}))).rx(own(can::remote_frame(0x322, 1))).expect(8352, 0x0200);
    s.y(0x01, true).wait_x(0x01, true).y(0x01, false).ignore_tx();
    s.expect(10000, {0x123, 0, 0x0301, 1}).expect(10007, {0x123, 0, 0x0301, 1});
    s.cif({0x000C, 0x7FF, 0, 1, 3}).expect(1000, 0x000D).tx(own(can::remote_frame(0x7FF, 3)));
    s.cpu(stop).tx(own(can::data_frame(0x555, Bytes{}))).no_tx();
  }
  IntelligentScenario s(rj71cn91);  // 405: 11 bits
  s.power_on_as(1);
  s.nmt(0x01, 1);
  s.rx(extended(can::data_frame(0x000, Bytes{0x02, 0x01}))).expect(601, 5);
  s.rx(extended(can::data_frame(0x201, Bytes{1, 0, 0, 0, 0, 0, 0, 0})));
  s.rx(extended(can::data_frame(0x601, read_1000))).rx(extended(can::remote_frame(0x701, 1))).no_tx();
  s.exchange().expect(10000, 0).rx(0x601, read_1000).tx(0x581, is_0195).no_tx();
}

TEST(Rj71Modes, AnotherMode_NeedsSaveAndRestart) {
  RecordProperty("spec", "RJ71-MODE-006 RJ71-MODE-001 RJ71-PARAM-007");
  enum class Way : std::uint8_t { restart, supply };
  const auto start = [](IntelligentScenario& s, Way way) {
    if (way == Way::restart) {
      s.restart();
    } else {
      s.supply_off();
      s.power_on();
    }
  };
  const auto runs = [](IntelligentScenario& s, std::uint16_t mode) {
    s.cif({0x0004, 0, 0x1000, 0}).expect(1000, mode == 405 ? 0x0005 : 0x000F).ignore_tx();
    s.y(0x03, true).expect_x(0x03, mode != 405).ignore_tx().y(0x03, false).ignore_tx();
  };
  for (const Way way : {Way::restart, Way::supply}) {
    for (const std::uint16_t from : Words{405, 11, 29}) {
      for (const std::uint16_t to : Words{405, 11, 29}) {
        if (from == to) continue;
        IntelligentScenario s(rj71cn91);
        s.power_on();
        s.write(21, from);
        s.save();
        start(s, way);
        runs(s, from);
        s.write(21, to).expect(21, to);
        runs(s, from);  // not yet, and not by Y3
        start(s, way);
        s.expect(21, from);  // lost without a save
        runs(s, from);
        s.write(21, to).write(22, 1).y(0x1F, true).wait_x(0x1F, true).expect(22, 0).y(0x1F, false);
        s.expect_x(0x1F, false);
        runs(s, from);
        start(s, way);
        s.expect(21, to);
        runs(s, to);
        if (to == 405) continue;
        // Then the other settings, and Y3: no restart any more.
        s.write(24, 500).write(6000, {0xFFFF, 0x5FFF, 0, 0}).write(10000, {0x123, 0, 1, 0x66});
        s.y(0x03, true).expect_x(0x03, true).expect(37, 5000).expect(29, 0).ignore_tx();
      }
    }
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_function_modes_test
