// The NMT start-up, what it starts, and what a lost slave leads to [RJ71CN91 1.2, App. 3 1F80H to 1F90H, 5.5].

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_start_up_test {
namespace {

using namespace rj71cn91_presets;

constexpr std::uint32_t assigned = 0x01;   // 1F81H: NMT slave
constexpr std::uint32_t optional = 0x05;   // and boot slave
constexpr std::uint32_t mandatory = 0x0D;  // and mandatory

TEST(Rj71StartUp, MasterOrSlave_By1F80HBit0_OfTheStoredObjects) {
  RecordProperty("spec", "RJ71-STARTUP-002");
  {  // a slave: every other setting is ignored
    IntelligentScenario s(rj71cn91);
    start_as(s, 1, {{0x1F80, 0, 0x7E}, {0x1F81, 5, 0x0064030D}, {0x1F89, 0, 1000}, {0x1F85, 5, 1}});
    s.rx(0x705, {0x00}).advance(60s).no_tx().expect(25, 0x0100).expect(405, 0).expect_x(0x10, false);
    s.nmt(0x01).expect(25, 0x0201);
  }
  enum class Way : std::uint8_t { restart, reset_node, reset_communication };
  for (const Way way : {Way::restart, Way::reset_node, Way::reset_communication}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(1);
    s.set_object(0x1F80, 0, 1, 4).ignore_tx().advance(10s).no_tx().expect_bit(25, 15, false);  // not yet
    s.store_objects();
    s.advance(10s).no_tx().expect_bit(25, 15, false);
    if (way == Way::restart) s.y(0x02, true).wait_x(0x02, true).y(0x02, false).ignore_tx();
    if (way == Way::reset_node) s.nmt(0x81, 1).wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
    if (way == Way::reset_communication) s.nmt(0x82, 1).wait_tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
    s.expect_bit(25, 15, true).advance(1s).expect(601, 5).ignore_tx();
    s.set_object(0x1F80, 0, 0, 4).advance(1s).expect_bit(25, 15, true);  // likewise the other way
    s.store_objects();
    s.restart();
    s.expect_bit(25, 15, false).advance(5s).no_tx();
  }
}

TEST(Rj71StartUp, CommunicationReset_OfAll_OrOneByOneWhereSomeAreKeptAlive) {
  RecordProperty("spec", "RJ71-STARTUP-004 RJ71-STARTUP-005");
  IntelligentScenario all(rj71cn91);
  start_as(all, 1, {{0x1F80, 0, 1}, {0x1F81, 5, optional}, {0x1F81, 6, mandatory}, {0x1F81, 127, assigned}});
  all.tx(0x000, {0x82, 0x00}).no_tx();
  IntelligentScenario single(rj71cn91);
  start_as(single, 1, {{0x1F80, 0, 1}, {0x1F81, 5, optional}, {0x1F81, 6, optional | 0x10}});
  single.tx(0x000, {0x82, 0x05}).advance(1s);  // each NMT slave but those; no other node
  for (const can::Frame& frame : single.controller().sent) {
    EXPECT_FALSE(frame.identifier == 0 && frame.data[0] == 0x82);
  }
  single.ignore_tx();
}

// Its words in the tool: the waiting time after the communication reset of all nodes.
TEST(Rj71StartUp, G70_IsBetweenTheResetOfAllAndTheStartOfAll) {
  RecordProperty("spec", "RJ71-STARTUP-006 RJ71-STARTUP-015");
  for (const std::uint16_t delay : Words{0, 1, 500, 3000, 65535}) {
    IntelligentScenario s(rj71cn91);
    start_with_delay(s, delay, 1, {{0x1F80, 0, 0x03}, {0x1F81, 5, mandatory}});
    s.expect(70, delay).tx(0x000, {0x82, 0x00});
    const can::Time reset = s.now();
    boots(s, 5);
    s.wait_tx(0x000, {0x01, 0x00}, 70s).no_tx();
    EXPECT_EQ(s.now() - reset, std::chrono::milliseconds(delay));
  }
}

TEST(Rj71StartUp, StartAll_OnlyWhenAllWereBooted_AndWhereStartingIsAllowed) {
  RecordProperty("spec", "RJ71-STARTUP-015");
  for (const std::uint32_t start_up : {0x03U, 0x0BU}) {  // all at once; and not started by the master
    for (const bool second_fails : {false, true}) {
      IntelligentScenario s(rj71cn91);
      start_with_delay(s, 500, 1,
                       {{0x1F80, 0, start_up},
                        {0x1F81, 5, optional},
                        {0x1F81, 6, optional},
                        {0x1F81, 7, optional},
                        {0x1F84, 6, 0x000F0191}});
      s.tx(0x000, {0x82, 0x00});
      boots(s, 5);
      boots(s, 7);
      s.rx(0x706, {0x00}).wait_tx(0x606, ask_1000);
      s.rx(0x586,
           {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, static_cast<std::uint8_t>(second_fails ? 0x0E : 0x0F), 0});
      s.advance(2s);
      if (start_up == 0x0B) {
        s.no_tx();
      } else if (second_fails) {
        s.tx(0x000, {0x01, 0x05}).tx(0x000, {0x01, 0x07}).no_tx();
      } else {
        s.tx(0x000, {0x01, 0x00}).no_tx();
      }
      s.expect_bit(25, 13, second_fails).expect_bit(25, 14, false).expect(601, 5);
    }
  }
}

TEST(Rj71StartUp, AbsentOptionalSlave_IsInProgress_AndStartedWhenItComes) {
  RecordProperty("spec", "RJ71-STARTUP-020");
  IntelligentScenario s(rj71cn91);
  start_as(s, 1, {{0x1F80, 0, 0x03}, {0x1F81, 5, mandatory}, {0x1F81, 6, optional}});
  s.tx(0x000, {0x82, 0x00});
  boots(s, 5);
  s.advance(9700ms)
      .expect_bit(25, 13, false)
      .expect_bit(25, 14, true)
      .expect_bit(406, 4, false)
      .expect(601, 5);
  unsigned starts = 0, questions = 0;
  for (const can::Frame& frame : s.controller().sent) {
    questions += frame.identifier == 0x606 && frame.data[0] == 0x40 ? 1 : 0;
    if (frame.identifier != 0 || frame.data[0] != 0x01) continue;
    ++starts;
    EXPECT_EQ(frame.data[1], 5);  // alone, not all nodes
  }
  EXPECT_EQ(starts, 1U);
  EXPECT_GE(questions, 6U);
  s.ignore_tx();
  boots(s, 6);
  s.tx(0x000, {0x01, 0x06}).expect_bit(25, 13, false).expect_bit(25, 14, false).expect(601, 5).ignore_tx();
}

/// Slave 5 with heartbeat (500 ms), a concise DCF (1017H = 100) and an identity to check.
void start_with_everything(IntelligentScenario& s, std::uint32_t assignment) {
  start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 5, assignment}, {0x1016, 1, 0x000501F4}, {0x1F84, 5, 0x000F0191}});
  s.tx(0x000, {0x82, 0x00});
  EXPECT_EQ(write_concise_dcf(s, 5, write_of_1017(100)), 0U);
  s.ignore_tx();
  s.restart();
}

const Bytes write_1017{0x2B, 0x17, 0x10, 0x00, 0x64, 0x00, 0, 0};
const Bytes written_1017{0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0};

TEST(Rj71StartUp, BootOfASlave_IdentificationThenConfigurationThenErrorControlThenStart) {
  RecordProperty("spec", "RJ71-STARTUP-007 RJ71-STARTUP-008 RJ71-STARTUP-009 RJ71-STARTUP-021 RJ71-CM-001");
  {  // every step
    IntelligentScenario s(rj71cn91);
    start_with_everything(s, mandatory);
    s.rx(0x705, {0x00}).tx(0x605, ask_1000).no_tx().rx(0x585, is_0191);
    s.tx(0x605, write_1017).no_tx().rx(0x585, written_1017);
    s.advance(499ms).no_tx().expect(405, 0).expect_bit(25, 14, true).expect(601, 0x7F);
    s.rx(0x705, {0x7F}).tx(0x000, {0x01, 0x05}).no_tx().expect(405, 0x0002).expect(601, 5);
    EXPECT_EQ(error_codes(s), (std::vector<std::uint16_t>{}));
  }
  const auto fails = [](IntelligentScenario& s, std::vector<std::uint16_t> errors) {
    s.expect_bit(405, 4, true).expect_x(0x10, true).expect_bit(25, 11, true).expect_bit(25, 14, false);
    EXPECT_EQ(error_codes(s), errors);
    s.advance(60s).no_tx().expect(601, 0x7F);  // the slave is not started, nor is the master
  };
  {  // identification
    IntelligentScenario s(rj71cn91);
    start_with_everything(s, mandatory);
    s.rx(0x705, {0x00})
        .tx(0x605, ask_1000)
        .rx(0x585, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x0F, 0x00})
        .no_tx();
    fails(s, {0x1806, 0x1807});
    EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, 5U);
    EXPECT_FALSE(s.plug_in().module_errors()[0].details[1].name.empty());
    EXPECT_FALSE(s.plug_in().module_errors()[1].details[0].name.empty());
  }
  {  // configuration: 1808H
    IntelligentScenario s(rj71cn91);
    start_with_everything(s, mandatory);
    s.rx(0x705, {0x00}).tx(0x605, ask_1000).rx(0x585, is_0191).tx(0x605, write_1017);
    s.rx(0x585, {0x80, 0x17, 0x10, 0x00, 0x30, 0x00, 0x09, 0x06}).no_tx();
    fails(s, {0x1808, 0x1807});
    EXPECT_EQ(s.plug_in().module_errors()[0].details[0].value, 5U);
  }
  {  // error control: the heartbeat does not come
    IntelligentScenario s(rj71cn91);
    start_with_everything(s, mandatory);
    s.rx(0x705, {0x00}).tx(0x605, ask_1000).rx(0x585, is_0191).tx(0x605, write_1017).rx(0x585, written_1017);
    s.advance(499ms).expect_bit(405, 4, false).advance(1ms).no_tx();
    fails(s, {0x1806, 0x1807});
  }
  {  // bit 2 of 1F81H clear: neither asked nor configured nor started, but watched
    IntelligentScenario s(rj71cn91);
    start_with_everything(s, assigned);
    s.rx(0x705, {0x00}).advance(100ms).no_tx().rx(0x705, {0x7F}).expect(405, 0x0002);
    s.advance(300ms).no_tx().expect(601, 5).expect(605, 0x7F);
  }
  {  // guarding instead of a heartbeat
    IntelligentScenario s(rj71cn91);
    start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 5, 0x00640300 | mandatory}});
    s.tx(0x000, {0x82, 0x00});
    boots(s, 5);
    s.tx_remote(0x705).no_tx().rx(0x705, {0x7F}).tx(0x000, {0x01, 0x05});
    s.expect_bit(405, 0, true).expect_bit(405, 4, false).ignore_tx();
    IntelligentScenario silent(rj71cn91);
    start_as(silent, 1, {{0x1F80, 0, 1}, {0x1F81, 5, 0x00640300 | mandatory}});
    silent.tx(0x000, {0x82, 0x00});
    boots(silent, 5);
    silent.tx_remote(0x705).advance(100ms).expect_bit(405, 4, true).expect_x(0x10, true).ignore_tx();
    silent.expect(601, 0x7F);
  }
}

TEST(Rj71StartUp, ErrorCodes_1806H_1807H_1808H) {
  RecordProperty("spec", "RJ71-STARTUP-019");
  IntelligentScenario s(rj71cn91);
  start_as(s, 1, {{0x1F80, 0, 1}, {0x1F81, 7, mandatory}, {0x1F89, 0, 800}});
  s.advance(3s).ignore_tx();
  ASSERT_EQ(error_codes(s), (std::vector<std::uint16_t>{0x1806, 0x1807}));
  const auto errors = s.plug_in().module_errors();
  EXPECT_EQ(errors[0].details[0].name, "Node ID");
  EXPECT_EQ(errors[0].details[0].value, 7U);
  EXPECT_EQ(errors[0].details[1].name, "NMT slave start-up error cause");
  EXPECT_NE(errors[0].details[1].value, 0U);
  EXPECT_EQ(errors[1].details[0].name, "NMT start-up error cause");
  EXPECT_NE(errors[1].details[0].value, 0U);
  EXPECT_EQ(errors[0].error_class, module::ErrorClass::minor);
}

/// The master with slave 5 (heartbeat 500 ms) and slave 6, both started.
void run_with_slaves(IntelligentScenario& s, std::uint32_t start_up, std::uint32_t assignment) {
  start_as(s, 1,
           {{0x1F80, 0, start_up}, {0x1F81, 5, assignment}, {0x1F81, 6, optional}, {0x1016, 1, 0x000501F4}});
  s.tx(0x000, {0x82, 0x00});
  boots(s, 6);
  s.ignore_tx();
  boots(s, 5);
  s.rx(0x705, {0x7F}).ignore_tx().advance(10ms).rx(0x705, {0x05}).no_tx().expect(601, 5).expect(605, 5);
}

TEST(Rj71ErrorEvent, LostSlave_StopsAll_ResetsAll_OrIsBootedAgain) {
  RecordProperty("spec", "RJ71-ERREV-003 RJ71-ERREV-004 RJ71-ERREV-005 RJ71-ERREV-006");
  struct Row {
    std::uint32_t start_up;
    std::uint32_t assignment;
    Bytes command;
  };
  const Bytes stop_all{0x02, 0x00}, reset_all{0x82, 0x00}, reset_5{0x82, 0x05};
  for (const Row& row :
       {Row{0x41, mandatory, stop_all}, Row{0x51, mandatory, stop_all}, Row{0x11, mandatory, reset_all},
        Row{0x01, mandatory, reset_5}, Row{0x01, optional, reset_5}, Row{0x11, optional, reset_5},
        Row{0x41, optional, reset_5}, Row{0x51, optional, reset_5}}) {
    IntelligentScenario s(rj71cn91);
    run_with_slaves(s, row.start_up, row.assignment);
    expect_node_lost(s, 1, 5);
    s.tx(0x000, row.command).no_tx().expect(405, 0x0080);
    if (row.command == stop_all) {
      s.expect(601, 0x04);
      s.rx(0x705, {0x00}).rx(0x706, {0x00}).advance(60s).no_tx();
      continue;
    }
    // It is booted again; after a reset of all the other one, too.
    boots(s, 5);
    s.rx(0x705, {0x7F});
    bool started = false;
    for (const can::Frame& frame : s.controller().sent) {
      started = started || (frame.identifier == 0 && frame.data[0] == 0x01 && frame.data[1] == 0x05);
    }
    s.ignore_tx();
    if (row.command == reset_all) {
      boots(s, 6);
      s.tx(0x000, {0x01, 0x06}).expect(601, 5);
    }
    EXPECT_TRUE(started);
    s.ignore_tx().expect_bit(25, 14, false);
  }
}

// Ways out of "stop all": Y2, communication reset by 1F82H, node reset excluding the master.
TEST(Rj71ErrorEvent, StopAll_IsLeftByY2_Or1F82H) {
  RecordProperty("spec", "RJ71-ERREV-003");
  for (const std::uint16_t way : Words{0, 0x07, 0x06}) {
    IntelligentScenario s(rj71cn91);
    run_with_slaves(s, 0x41, mandatory);
    expect_node_lost(s, 1, 5);
    s.tx(0x000, {0x02, 0x00}).expect(601, 0x04);
    if (way == 0) {
      s.restart();
    } else {
      s.cif({0x0002, 0, 0x1F82, 0x01, 1, way}).expect(1000, 0x0003).ignore_tx();
      s.wait_bit(25, 7, false).ignore_tx();
    }
    boots(s, 6);
    s.ignore_tx();
    boots(s, 5);
    s.rx(0x705, {0x7F}).advance(10ms).expect(601, 5).ignore_tx();
  }
}

// The printed third way excludes the master, which then is Stopped and boots nobody.
TEST(Rj71ErrorEvent, StopAll_IsNotLeftByRequestsExcludingTheMaster) {
  RecordProperty("spec", "RJ71-ERREV-007");
  for (const std::uint16_t way : Words{0x86, 0x87}) {
    IntelligentScenario s(rj71cn91);
    run_with_slaves(s, 0x41, mandatory);
    expect_node_lost(s, 1, 5);
    s.tx(0x000, {0x02, 0x00}).expect(601, 0x04);
    s.cif({0x0002, 0, 0x1F82, 0x80, 1, way}).expect(1000, 0x0003).ignore_tx();
    s.rx(0x705, {0x00}).rx(0x706, {0x00}).advance(60s).no_tx().expect(601, 0x04);
  }
}

TEST(Rj71FlyingMaster, SlaveSetUp_CountsForWhoIsActive_AndOwnEntryIsIgnored) {
  RecordProperty("spec", "RJ71-FLY-012 RJ71-FLY-008");
  for (const bool claims : {true, false}) {
    IntelligentScenario s(rj71cn91);
    start_as(s, 2,
             {{0x1F80, 0, 0x21},
              {0x1F81, 2, 0x00640305},
              {0x1F81, 3, claims ? optional : 0U},
              {0x1F81, 9, optional}});
    s.wait_bit(25, 15, true, 20s).ignore_tx();
    // Another master, standing by, and a slave come up; the slave is booted by whoever is active.
    bool asked_self = false;
    s.rx(0x703, {0x00}).rx(0x709, {0x00}).advance(3s);
    bool boots_3 = false, boots_9 = false;
    for (const can::Frame& frame : s.controller().sent) {
      boots_3 = boots_3 || frame.identifier == 0x603;
      boots_9 = boots_9 || frame.identifier == 0x609;
      asked_self = asked_self || frame.identifier == 0x602 || (frame.remote && frame.identifier == 0x702);
    }
    EXPECT_EQ(boots_3, claims);
    EXPECT_TRUE(boots_9);
    EXPECT_FALSE(asked_self);
    s.ignore_tx();
  }
}

TEST(Rj71Configuration, UpToDate_IsNotWrittenAgain) {
  RecordProperty("spec", "RJ71-CM-002 RJ71-OD-004");
  const auto answer = [](std::uint8_t sub, std::uint32_t value) {
    Bytes bytes{0x43, 0x20, 0x10, sub};
    for (const std::uint8_t byte : canopen::little_endian(value, 4)) bytes.push_back(byte);
    return bytes;
  };
  constexpr std::uint32_t date = 15'000, time = 45'000'000;
  for (const auto& [found_date, found_time] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {date, time}, {date + 1, time}, {date, time + 1}, {0, 0}}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(1);
    s.set_object(0x1F80, 0, 1, 4).set_object(0x1F81, 127, mandatory, 4);
    s.set_object(0x1F26, 127, date, 4).set_object(0x1F27, 127, time, 4);
    EXPECT_EQ(write_concise_dcf(s, 127, write_of_1017(100)), 0U);
    s.store_objects();
    s.restart();
    s.rx(0x77F, {0x00}).tx(0x67F, ask_1000).rx(0x5FF, is_0191);
    s.tx(0x67F, {0x40, 0x20, 0x10, 0x01, 0, 0, 0, 0}).rx(0x5FF, answer(1, found_date));
    if (found_date == date)
      s.tx(0x67F, {0x40, 0x20, 0x10, 0x02, 0, 0, 0, 0}).rx(0x5FF, answer(2, found_time));
    if (found_date != date || found_time != time) s.tx(0x67F, write_1017).rx(0x5FF, written_1017);
    s.wait_tx(0x000, {0x01, 0x7F}).no_tx().expect(601, 5);
  }
  // An RJ71CN91 as such a slave: any change of a setting makes its own 1020H 0; it is stored by 1010H.
  IntelligentScenario slave(rj71cn91);
  slave.power_on_as(5);
  slave.set_object(0x1020, 1, date, 4).set_object(0x1020, 2, time, 4).store_objects();
  slave.restart();
  slave.expect_object(0x1020, 1, date, 4).expect_object(0x1020, 2, time, 4);
  slave.rx(0x605, {0x2B, 0x17, 0x10, 0x00, 0x64, 0x00, 0, 0}).ignore_tx();
  slave.expect_object(0x1020, 1, 0, 4).expect_object(0x1020, 2, 0, 4).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_start_up_test
