// PDO, SYNC and TIME as the manual has them [RJ71CN91 1.4, 1.5, 1.6, 5.4, App. 2 RPDO, TPDO, App. 3 1400H, 1800H].

#include "canopus/sim/bus/bus.hpp"

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_process_data_test {
namespace {

using namespace rj71cn91_presets;

/// Operational, as node 1 or another one.
void operational(IntelligentScenario& s, std::uint8_t node = 1) {
  s.power_on_as(node);
  s.nmt(0x01, node).ignore_tx();
}

// Case 4 of the timing charts.
TEST(Rj71Tpdo, InhibitTimeBelowTheEventTimer_ChangesAndTheTimer) {
  RecordProperty("spec", "RJ71-TPDO-007");
  IntelligentScenario s(rj71cn91);
  operational(s, 5);
  s.set_object(0x18FF, 1, 0xC0000285, 4).set_object(0x18FF, 3, 500, 2).set_object(0x18FF, 5, 200, 2);
  s.set_object(0x18FF, 1, 0x40000285, 4).set_object(0x1801, 1, 0xC0000285, 4);
  s.ignore_tx().write(14020, 1);
  s.exchange().tx(0x285, {1, 0, 0, 0, 0, 0, 0, 0});
  s.advance(40ms).write(14020, 2);
  s.exchange().no_tx();  // within the inhibit time of 50 ms
  s.advance(20ms).write(14020, 3);
  s.exchange().tx(0x285, {3, 0, 0, 0, 0, 0, 0, 0});                           // after it
  s.advance(198ms).no_tx().advance(2ms).tx(0x285, {3, 0, 0, 0, 0, 0, 0, 0});  // silence is filled
  s.advance(199ms).no_tx().advance(1ms).tx(0x285, {3, 0, 0, 0, 0, 0, 0, 0}).no_tx();
}

TEST(Rj71Rpdo, SynchronousTypes_WaitForTheNextSync_WhateverTheNumber) {
  RecordProperty("spec", "RJ71-RPDO-002 RJ71-SYNC-003");
  for (const std::uint16_t type : Words{0x00, 0x01, 0x02, 0x7F, 0xEF, 0xF0}) {
    IntelligentScenario s(rj71cn91);
    operational(s);
    s.set_object(0x1402, 1, 0x80000401, 4).set_object(0x1402, 2, type, 1).set_object(0x1402, 1, 0x401, 4);
    for (std::uint8_t round = 1; round <= 3; ++round) {
      s.rx(0x401, {round, 0, 0, 0, 0, 0, 0x77, round}).rx(0x401, {0xA0, 0, 0, 0, 0, 0, 0x77, round});
      s.expect_object(0xA580, 9, round == 1 ? 0 : 0xA0, 2);
      s.exchange().expect(10011, round == 1 ? 0 : static_cast<std::uint16_t>((round - 1) << 8 | 0x77));
      s.rx(0x080);
      s.exchange().expect(10008, {0xA0, 0, 0, static_cast<std::uint16_t>(round << 8 | 0x77)});
    }
    s.rx(0x080);
    s.exchange().expect(10008, 0xA0).no_tx();  // none came since
  }
}

// A slave and a flying master that stands by both follow the SYNC of the active master.
TEST(Rj71Sync, ConsumersTimeTheirPdos_ByTheFrame) {
  RecordProperty("spec", "RJ71-SYNC-003");
  for (const bool stands_by : {false, true}) {
    IntelligentScenario s(rj71cn91);
    // An object of its own for SYNC: any free CAN-ID.
    start_as(s, 9,
             {{0x1F80, 0, stands_by ? 0x21U : 0U},
              {0x1005, 0, 0xA0},
              {0x1006, 0, 10'000},
              {0x1800, 2, 2, 1},
              {0x1400, 2, 1, 1}});
    if (stands_by) {
      // Node 1 says that it is the active master [CiA 302-2].
      s.wait_tx(0x073).rx(0x071, {0x01, 0x01}).rx(0x701, {0x05}).ignore_tx();
    }
    s.nmt(0x01, 9).ignore_tx().expect(609, 5).expect_bit(25, 15, false);
    s.rx(0x209, {7, 0, 0, 0, 0, 0, 0, 0});
    s.exchange().expect(10000, 0);
    s.rx(0x080);
    s.exchange().expect(10000, 0).no_tx();  // not its SYNC
    s.rx(0x0A0).no_tx().rx(0x0A0).tx(0x189, {0, 0, 0, 0, 0, 0, 0, 0});
    s.exchange().expect(10000, 7);
    s.rx(0x0A0).no_tx().rx(0x0A0).tx(0x189, {0, 0, 0, 0, 0, 0, 0, 0});
    for (const can::Frame& frame : s.controller().sent) EXPECT_NE(frame.identifier, 0x0A0U);
    s.ignore_tx();
  }
}

TEST(Rj71Rpdo, DummyObjects_SkipBytes_AndCannotBeRead) {
  RecordProperty("spec", "RJ71-RPDO-004");
  const std::map<std::uint32_t, unsigned> bits{{2, 8}, {3, 16}, {4, 32}, {5, 8}, {6, 16}, {7, 32}, {8, 32}};
  for (const auto& [dummy, length] : bits) {
    IntelligentScenario s(rj71cn91);
    operational(s);
    s.set_object(0x1400, 1, 0x80000201, 4).set_object(0x1600, 0, 0, 1);
    s.set_object(0x1600, 1, dummy << 16 | length, 4).set_object(0x1600, 2, 0xA4C00108, 4);
    s.set_object(0x1600, 0, 2, 1).set_object(0x1400, 1, 0x201, 4);
    Bytes frame(length / 8, 0xAA);
    frame.push_back(0xBB);
    s.rx(0x201, frame);
    s.exchange().expect(10000, {0x00BB, 0, 0}).no_tx();
  }
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  for (std::uint8_t index = 1; index <= 8; ++index) {
    s.cif({0x0004, 0, index, 0});
    s.expect_abort(0x06020000);
    s.rx(0x601, {0x40, index, 0x00, 0x00, 0, 0, 0, 0}).tx(0x581, {0x80, index, 0x00, 0x00, 0, 0, 0x02, 0x06});
    s.rx(0x601, {0x2F, index, 0x00, 0x00, 1, 0, 0, 0}).tx(0x581, {0x80, index, 0x00, 0x00, 0, 0, 0x02, 0x06});
  }
}

TEST(Rj71Rpdo, OutputVariables_WrittenBySdo_AreInTheWords_NotTheOtherWayRound) {
  RecordProperty("spec", "RJ71-RPDO-005");
  IntelligentScenario s(rj71cn91);
  operational(s);
  s.rx(0x601, {0x2B, 0x80, 0xA5, 0x01, 0x34, 0x12, 0, 0}).tx(0x581, {0x60, 0x80, 0xA5, 0x01, 0, 0, 0, 0});
  s.rx(0x601, {0x2B, 0x84, 0xA5, 0x08, 0x78, 0x56, 0, 0}).tx(0x581, {0x60, 0x84, 0xA5, 0x08, 0, 0, 0, 0});
  s.exchange().expect(10000, {0x1234, 0}).expect(11023, 0x5678);
  s.set_object(0xA580, 2, 0x4321, 2).exchange().expect(10000, {0x1234, 0x4321});
  s.write(10000, 0x9999);
  s.exchange().expect(10000, 0x1234).expect(29, 0);
  s.expect_object(0xA580, 1, 0x1234, 2).no_tx();
}

TEST(Rj71Rpdo, ShortFrame_IsNotTaken_LongOneIs_BothAreReported) {
  RecordProperty("spec", "RJ71-RPDO-006 RJ71-RPDO-007");
  for (const std::uint16_t number : Words{1, 4, 256}) {
    for (Bytes data{1, 2, 3, 4, 5, 6, 7}; !data.empty(); data.pop_back()) {
      IntelligentScenario s(rj71cn91);
      operational(s, 3);
      s.set_object(static_cast<std::uint16_t>(0x13FF + number), 1, 0x80000233, 4);
      s.set_object(static_cast<std::uint16_t>(0x13FF + number), 1, 0x233, 4);
      const std::size_t first = 10000U + 4U * (number - 1U);
      s.rx(0x233, data).tx(0x083, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();
      s.exchange().expect(static_cast<module::BufferAddress>(first), {0, 0, 0, 0});
      ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1801}));
      const auto error = s.plug_in().module_errors()[0];
      EXPECT_EQ(error.details[0].name, "PDO number");
      EXPECT_EQ(error.details[0].value, number);
      EXPECT_EQ(error.details[1].name, "PDO error cause");
      EXPECT_EQ(error.details[1].value, 0x8210U);
    }
  }
  IntelligentScenario s(rj71cn91);
  operational(s, 3);
  s.set_object(0x1400, 1, 0x80000203, 4).set_object(0x1600, 0, 0, 1).set_object(0x1600, 0, 3, 1);
  s.set_object(0x1400, 1, 0x203, 4).ignore_tx();
  s.rx(0x203, {1, 2, 3, 4, 5, 6, 7, 8}).tx(0x083, {0x20, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.exchange().expect(10000, {0x0201, 0x0403, 0x0605, 0});
  ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1801}));
  EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, 1U);
  EXPECT_EQ(s.plug_in().module_errors()[0].details[1].value, 0x8220U);
}

// The EMCY goes once for as long as the error stays; the error of module diagnostics comes again after YF.
TEST(Rj71Rpdo, WrongLength_IsFoundAgain_AfterTheErrorsWereCleared) {
  RecordProperty("spec", "RJ71-RPDO-006");
  IntelligentScenario s(rj71cn91);
  operational(s, 3);
  s.rx(0x203, {1, 2}).tx(0x083, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();
  s.y(0x0F, true);
  s.rx(0x203, {1, 2}).no_tx();
  ASSERT_TRUE(error_codes(s).empty());  // none while YF is ON
  s.y(0x0F, false);
  s.rx(0x403, {1, 2, 3}).tx(0x083, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0}).no_tx();
  ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1801}));
  EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, 3U);
  s.rx(0x203, {1, 2}).no_tx();  // there already: what was found first stays
  EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, 3U);
  s.y(0x0F, true).y(0x0F, false);
  s.rx(0x203, {1, 2}).no_tx();
  ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1801}));
  EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, 1U);
  s.y(0x0F, true).y(0x0F, false);
  s.rx(0x203, {1, 2, 3, 4, 5, 6, 7, 8}).rx(0x403, {1, 2, 3, 4, 5, 6, 7, 8}).no_tx();
  ASSERT_TRUE(error_codes(s).empty());
}

// 8250H is in the table of what is sent, yet no object sets such a time.
TEST(Rj71Rpdo, TimeOut_HasNoObject) {
  RecordProperty("spec", "RJ71-RPDO-008");
  IntelligentScenario s(rj71cn91);
  operational(s);
  for (const std::uint16_t index : Words{0x1400, 0x14FF}) {
    s.expect_object(index, 0, 2, 1);
    for (const std::uint16_t sub : Words{3, 5}) {
      s.cif({0x0004, 0, index, sub});
      s.expect_abort(0x06090011);
      s.cif({0x0002, 0, index, sub, 2, 100});
      s.expect_abort(0x06090011);
    }
  }
  s.rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8}).advance(1h).no_tx();
}

/// Whether two nodes exchange PDOs: this module's TPDO1 with what is changed, and RPDO1.
TEST(Rj71ProcessData, WhatKeepsPdosFromComing) {
  RecordProperty("spec", "RJ71-PDO-007");
  const auto sends = [](IntelligentScenario& s, std::uint16_t value) {
    s.ignore_tx().write(13000, value);
    s.exchange();
    const bool sent = !s.controller().sent.empty();
    s.ignore_tx();
    return sent;
  };
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  EXPECT_FALSE(sends(s, 1));  // not Operational
  s.nmt(0x01, 1);
  EXPECT_TRUE(sends(s, 2));
  EXPECT_FALSE(sends(s, 2));              // event type, unchanged, without an event timer
  s.write(13000, 3).advance(1s).no_tx();  // no Y1
  EXPECT_TRUE(sends(s, 3));
  s.nmt(0x02, 1);
  s.write(13000, 4).y(0x01, true).advance(1s).y(0x01, false).no_tx();
  s.nmt(0x01, 1);
  s.set_object(0x1800, 1, 0xC0000181, 4);  // invalid
  EXPECT_FALSE(sends(s, 5));
  s.set_object(0x1800, 2, 1, 1).set_object(0x1800, 1, 0x40000181, 4);
  EXPECT_FALSE(sends(s, 6));  // SYNC type, and nobody produces SYNC
  s.rx(0x080).tx(0x181, {6, 0, 0, 0, 0, 0, 0, 0});
  s.set_object(0x1800, 1, 0xC0000181, 4).set_object(0x1800, 2, 0xFE, 1).set_object(0x1800, 5, 100, 2);
  s.set_object(0x1800, 1, 0x40000181, 4);
  s.ignore_tx().advance(101ms).tx(0x181, {6, 0, 0, 0, 0, 0, 0, 0});  // the event timer needs no change
  s.ignore_tx();
  s.set_object(0x1800, 1, 0xC0000181, 4);
  s.rx(0x202, {9, 0, 0, 0, 0, 0, 0, 0});
  s.exchange().expect(10000, 0);  // another CAN-ID than the RPDO's
  s.set_object(0x1400, 1, 0x80000201, 4).rx(0x201, {9, 0, 0, 0, 0, 0, 0, 0});
  s.exchange().expect(10000, 0);
  s.set_object(0x1400, 1, 0x201, 4).rx(0x201, {9, 0, 0, 0, 0, 0, 0, 0});
  s.expect(10000, 0);
  s.exchange().expect(10000, 9).ignore_tx();
}

// --- SYNC

/// Two stations on a bus of 125 kbit/s: the module as NMT master, and one that sends long frames.
class SyncBus : can::Listener {
 public:
  SyncBus() : module(make_module(rj71cn91, own, memory)) {
    module->preset_node_id(1);
    module->preset_bit_rate(125'000);
    for (const PresetObject& object : {PresetObject{0x1F80, 0, 1}, PresetObject{0x1006, 0, 20'000},
                                       PresetObject{0x1005, 0, 0x4000'0080}}) {
      module->preset_object(object.index, object.sub, canopen::little_endian(object.value, object.length));
    }
    timeline.add(*module);
    own.connect(*module);
    other.connect(*this);
    module->power_on(timeline.now());
    timeline.run_until(can::Time{} + 3s);
    times.clear();
  }
  void receive(const can::Frame& frame, can::Time now) override {
    if (frame.identifier == 0x080) times.push_back(now);
  }

  can::Timeline timeline;
  sim::Bus bus{"field", 125'000, timeline};
  sim::Port& own = bus.add_port("module");
  sim::Port& other = bus.add_port("other");
  RamMemory memory;
  std::unique_ptr<module::ModuleEngine> module;
  std::vector<can::Time> times;
};

TEST(Rj71Sync, AFrameOnTheWire_DelaysIt_AndTheNextOneIsInTimeAgain) {
  RecordProperty("spec", "RJ71-SYNC-004");
  SyncBus quiet;
  quiet.timeline.run_until(can::Time{} + 3500ms);
  ASSERT_GE(quiet.times.size(), 20U);
  for (std::size_t i = 1; i < quiet.times.size(); ++i) EXPECT_EQ(quiet.times[i] - quiet.times[i - 1], 20ms);
  // 8 bytes last 0.9 to 1.1 ms here: one that begins 0.5 ms before a SYNC is over 0.4 to 0.6 ms after it.
  SyncBus busy;
  const can::Time first = quiet.times[0];
  for (unsigned cycle = 1; cycle < 20; ++cycle) {
    const can::Time due = first + 20ms * cycle;
    if (cycle % 2 == 0) continue;
    busy.timeline.run_until(due - 900us);
    busy.other.send(can::data_frame(0x7F0, Bytes{1, 2, 3, 4, 5, 6, 7, 8}));
  }
  busy.timeline.run_until(first + 410ms);
  ASSERT_GE(busy.times.size(), 20U);
  unsigned late = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    const auto delay = busy.times[i] - (first + 20ms * static_cast<int>(i));
    EXPECT_GE(delay, 0ns) << i;
    EXPECT_LE(delay, 1100us) << i;  // never more than one frame, and it does not add up
    if (delay > 0ns) ++late;
  }
  EXPECT_EQ(late, 10U);
}

// --- TIME

TEST(Rj71Time, Producer_EveryG58Minutes_AsActiveMaster_InOperationalAndPreOperational) {
  RecordProperty("spec", "RJ71-TIME-001");
  const auto start = [](IntelligentScenario& s, std::uint32_t start_up, std::uint16_t role,
                        std::uint16_t minutes) {
    start_as(s, 1, {{0x1F80, 0, start_up}});
    s.advance(1s).ignore_tx();
    s.write(50, {role, 2024, 2, 29, 12, 0, 0})
        .write(58, minutes)
        .y(0x12, true)
        .expect_x(0x12, true)
        .y(0x12, false);
    s.expect_object(0x1012, 0, static_cast<std::uint32_t>((role & 1U) << 31 | (role & 2U) << 29 | 0x100), 4);
    s.ignore_tx();
  };
  const auto time_of = [](const can::Frame& frame) {
    return std::pair{can::load_u32({frame.data.data(), 4}), frame.data[4] | frame.data[5] << 8};
  };
  constexpr unsigned day = 14669;  // 2024-02-29 since 1984-01-01
  for (const std::uint16_t minutes : Words{1, 7, 1440}) {
    for (const std::uint16_t role : Words{2, 3}) {
      IntelligentScenario s(rj71cn91);
      start(s, 1, role, minutes);
      s.advance(std::chrono::minutes(minutes) - 1s).ignore_tx().advance(2s);
      ASSERT_EQ(s.controller().sent.size(), 1U) << minutes;
      const can::Frame frame = s.controller().sent.front();
      EXPECT_EQ(frame.identifier, 0x100U);
      EXPECT_EQ(frame.dlc, 6);
      const auto [ms, days] = time_of(frame);
      EXPECT_EQ(days, static_cast<int>(minutes == 1440 ? day + 1 : day));
      EXPECT_NEAR(ms, 43'200'000.0 + (minutes == 1440 ? 0 : minutes * 60'000.0), 1001);
      s.ignore_tx().advance(std::chrono::minutes(minutes) - 3s).no_tx().advance(3s);
      EXPECT_EQ(s.controller().sent.size(), 1U);
      s.ignore_tx();
      if (minutes == 1440) continue;
      s.cif({0x0002, 0, 0x1F82, 1, 1, 0x7F}).ignore_tx().expect(601, 0x7F);  // Pre-operational
      s.advance(std::chrono::minutes(minutes));
      EXPECT_EQ(s.controller().sent.size(), 1U);
      s.ignore_tx();
      s.cif({0x0002, 0, 0x1F82, 1, 1, 0x04}).ignore_tx().expect(601, 0x04);  // Stop
      s.advance(std::chrono::minutes(10 * minutes)).no_tx();
    }
  }
  for (const auto& [start_up, role, minutes] :
       std::vector<std::tuple<std::uint32_t, std::uint16_t, std::uint16_t>>{
           {1, 2, 0}, {1, 1, 1}, {1, 0, 1}, {0, 2, 1}}) {  // no interval, no producer, no master
    IntelligentScenario s(rj71cn91);
    start(s, start_up, role, minutes);
    s.advance(10min).no_tx();
  }
}

// --- CAN-IDs

TEST(Rj71CanIds, OfPdos_FreeOnes_AndThoseInUse) {
  RecordProperty("spec", "RJ71-CANID-004");
  IntelligentScenario s(rj71cn91);
  operational(s);
  s.set_object(0x1800, 1, 0xC0000181, 4).set_object(0x1400, 1, 0x80000201, 4);
  const auto free = [](std::uint32_t id) {
    return (id >= 0x181 && id <= 0x580) || id == 0x600 || (id >= 0x680 && id <= 0x6DF) || id == 0x700;
  };
  const auto used = [](std::uint32_t id) {
    return id == 0x080 || id == 0x100 || (id >= 0x081 && id <= 0x0FF);
  };
  for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
    if (used(id)) continue;  // of other functions: a matter of the whole network [1.1 note 5]
    for (const std::uint16_t index : Words{0x18FE, 0x14FE}) {
      const std::uint32_t value = id | (index == 0x18FE ? 0x40000000U : 0U);
      s.cif({0x0002, 0, index, 1, 4, static_cast<std::uint16_t>(value),
             static_cast<std::uint16_t>(value >> 16)});
      s.expect(1000, free(id) ? 0x0003 : 0x000F);
      if (!free(id)) s.expect_abort(0x06090030);
      s.set_object(index, 1, index == 0x18FE ? 0xC0000000U : 0x80000000U, 4);
    }
  }
  s.ignore_tx();
}

TEST(Rj71CanIds, FixedOnes_SettableOnes_AndDuplicatesAreNobodysBusiness) {
  RecordProperty("spec", "RJ71-CANID-003 RJ71-CANID-005 RJ71-CANID-002");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(9);
  s.set_object(0x1005, 0, 0xA0, 4).set_object(0x1012, 0, 0xA1, 4).set_object(0x1012, 0, 0x800000A1, 4);
  s.set_object(0x1028, 5, 0x80000345, 4).set_object(0x1028, 5, 0x345, 4);
  s.set_object(0x1800, 1, 0xC00003AA, 4).set_object(0x1800, 1, 0x400003AA, 4);
  s.set_object(0x1400, 1, 0x800003AB, 4).set_object(0x1400, 1, 0x3AB, 4);
  s.cif({0x0002, 0, 0x1014, 0, 4, 0x0085, 0});
  s.expect_abort(0x06010002);
  for (const std::uint16_t index : Words{0x1200, 0x1280}) {  // SDO: no objects at all
    s.cif({0x0004, 0, index, 1});
    s.expect_abort(0x06020000);
  }
  s.nmt(0x01, 9).write(13000, 1);
  s.exchange().tx(0x3AA, {1, 0, 0, 0, 0, 0, 0, 0});
  s.rx(0x3AB, {2, 0, 0, 0, 0, 0, 0, 0});
  s.exchange().expect(10000, 2);
  s.rx(0x345, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}).expect_x(0x11, true);
  s.write(25, 0xEFFF).rx(0x0A1, {0, 0, 0, 0, 0x10, 0x27}).expect_bit(25, 12, true);
  s.rx(0x0A0, {1}).tx(0x089, {0x00, 0x82, 0x11, 0, 0, 0, 0, 0});
  // Its own CAN-IDs from somebody else, and one of its own twice: no EMCY 8150H, no error.
  s.rx(0x3AA, {1, 2, 3, 4, 5, 6, 7, 8})
      .rx(0x089, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0})
      .rx(0x709, {0x05})
      .no_tx();
  s.set_object(0x1801, 1, 0xC00003AA, 4).set_object(0x1801, 1, 0x400003AA, 4).no_tx();
  s.write(13000, {2, 0, 0, 0, 3});
  s.exchange().tx(0x3AA, {2, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x3AA, {3, 0, 0, 0, 0, 0, 0, 0}).no_tx().expect(29, 0);
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_process_data_test
