// What the RJ71CN91 does otherwise than the ME3CAN1-Q in CANopen 405 mode: errors and their clearing, time stamp, data
// exchange, initialization, command interface.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::rj71cn91_differences_test {
namespace {

const Bytes no_error(8, 0);

/// The heartbeat of node 5 is lost: X10, G29.10.
void lose_node_5(IntelligentScenario& s) { s.rx(0x705, {0x05}).advance(200ms).ignore_tx(); }

// --- errors

TEST(Rj71Errors, BadValue_IsShown_UntilTheWordHasAGoodOne_OrYf) {
  RecordProperty("spec", "RJ71-MODE-005 RJ71-BM-007 RJ71-BM-011");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.write(21, 12).expect(29, 0x0040).expect(39, 21).expect_x(0x0F, true).expect(21, 405);
  s.write(24, 99).expect(39, 21);  // the first one
  s.write(21, 405).expect(29, 0x0040);
  s.write(24, 500).expect(29, 0).expect_x(0x0F, false).expect(39, 21);  // shown until YF
  s.y(0x0F, true).expect(39, 0).y(0x0F, false).expect(29, 0).expect(39, 0);
  // Its cause is still there: it comes again.
  s.write(24, 99).y(0x0F, true).expect(29, 0).expect(39, 0).expect_x(0x0F, false);
  s.y(0x0F, false).expect(29, 0x0040).expect(39, 24).expect_x(0x0F, true);
  // Removed while YF is ON: stays away. A new one while YF is ON shows up afterwards.
  s.y(0x0F, true).write(24, 250).y(0x0F, false).expect(29, 0).expect_x(0x0F, false);
  s.y(0x0F, true).write(27, 200).expect(29, 0).expect(39, 0).y(0x0F, false).expect(29, 0x0040).expect(39, 27);
  // G29 takes no writes.
  s.write(29, 0).write(29, 0xFFBF).expect(29, 0x0040).expect(39, 27);
}

TEST(Rj71Errors, Yf_ClearsEverything_ButAHardwareError_AndItComesAgainWithItsCause) {
  RecordProperty("spec", "RJ71-IO-004 RJ71-IO-005 RJ71-LED-003");
  const auto led = [](IntelligentScenario& s) { return s.plug_in().leds(s.now())[1].pattern; };
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x00050064, 4).ignore_tx();
  lose_node_5(s);
  s.expect_x(0x10, true).expect_x(0x0F, false).expect(29, 0x0400);  // X10, not XF
  s.error_counters(128, 0).ignore_tx().expect(29, 0x4400).expect_x(0x0F, false);
  s.error_counters(256, 0).expect(29, 0x0408).expect_x(0x0F, true);
  EXPECT_EQ(led(s), module::LedPattern::on);
  s.y(0x0F, true).expect(29, 0).expect_x(0x0F, false).expect_x(0x10, false).expect_bit(405, 7, false);
  EXPECT_EQ(led(s), module::LedPattern::off);
  s.y(0x0F, false).expect(29, 0x0008).expect_x(0x0F, true);  // still bus-off; the failure was an event
  EXPECT_EQ(led(s), module::LedPattern::on);
  s.error_counters(0, 0).expect(29, 0).expect_x(0x0F, false);

  // Each bit: XF or not.
  s.controller().overflows = 1;
  s.write(20, 0).expect(29, 0x0100).expect_x(0x0F, true).ignore_tx();
  s.y(0x0F, true).expect(29, 0).y(0x0F, false).expect(29, 0).expect_x(0x0F, false);

  // A failure that comes while YF is ON is not shown, not even afterwards.
  s.y(0x0F, true);
  lose_node_5(s);
  s.expect_x(0x10, false).expect(29, 0).y(0x0F, false).expect_x(0x10, false).expect_bit(405, 7, false);
  lose_node_5(s);
  s.expect_x(0x10, true).expect(29, 0x0400);

  s.plug_in().inject(module::ModuleFault::hardware_error, s.now());
  s.expect_bit(29, 1, true).expect_x(0x0F, true);
  s.y(0x0F, true).expect(29, 0x0002).expect_x(0x0F, true).y(0x0F, false).expect_bit(29, 1, true);
  s.ignore_tx();
}

TEST(Rj71Errors, NodeFailures_AreX10AndG29_10_NotXf_AndY10ClearsTheNodeOfG400) {
  RecordProperty("spec", "RJ71-BM-019 RJ71-ERR-004 RJ71-IO-006");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  s.set_object(0x1016, 1, 0x00050064, 4);
  s.set_object(0x1016, 2, 0x00070064, 4).ignore_tx();
  s.rx(0x705, {0x05})
      .rx(0x707, {0x05})
      .expect(405, 0x0002)
      .expect(407, 0x0002)
      .expect(29, 0)
      .expect_x(0x10, false);
  s.advance(200ms);
  s.tx(0x081, {0x05, 0x8F, 0x11, 0, 0, 0, 0, 0}).tx(0x081, {0x07, 0x8F, 0x11, 0, 0, 0, 0, 0});
  s.expect_bit(405, 7, true)
      .expect_bit(407, 7, true)
      .expect(29, 0x0400)
      .expect_x(0x10, true)
      .expect_x(0x0F, false);
  s.write(400, 5)
      .y(0x10, true)
      .expect_bit(405, 7, false)
      .expect_bit(407, 7, true)
      .expect_x(0x10, true)
      .expect(29, 0x0400);
  const auto events = s.plug_in().event_history().size();
  s.rx(0x705, {0x05}).advance(200ms).ignore_tx().expect_bit(405, 7, false);  // held clear, and not logged
  EXPECT_EQ(s.plug_in().event_history().size(), events);
  s.y(0x10, false)
      .write(400, 0)
      .y(0x10, true)
      .expect_bit(407, 7, false)
      .expect_x(0x10, false)
      .expect(29, 0)
      .y(0x10, false);
  lose_node_5(s);
  s.expect_bit(405, 7, true).expect_x(0x10, true);
  EXPECT_EQ(s.plug_in().event_history().back().code, 0x0412);
}

TEST(Rj71Errors, WritesWhileInitializing_HaveNoEffect_AndNoError) {
  RecordProperty("spec", "RJ71-BM-016 RJ71-NMT-002");
  IntelligentScenario s(rj71cn91);
  s.supply_on().expect(25, 0x0080).expect(29, 0);
  s.write(70, 1).write(24, 99).write(20, 0x1100).expect(29, 0).expect(39, 0).expect_x(0x0F, false);
  s.rx(0x67F, {0x40, 0, 0x10, 0, 0, 0, 0, 0}).rx(0x000, {0x01, 0x7F}).no_tx();
  s.advance(1s).ignore_tx().expect(25, 0x0100).expect(29, 0).expect(70, 500).expect(24, 250).expect(20, 0);
  s.y(0x02, true).tx(0x0FF, {0x00, 0x62, 0x01, 0x4D, 0x45, 0x30, 0x30, 0x34}).expect(25, 0x0080);
  s.write(70, 1).advance(5s).no_tx().expect(25, 0x0080).expect_x(0x02, false).expect(29, 0);
  s.wait_x(0x02, true, 2s).ignore_tx().expect(25, 0x0100).expect(70, 500).expect(29, 0);
}

TEST(Rj71Errors, HistoryCleared_SendsNoError_AndOnlyThen) {
  RecordProperty("spec", "RJ71-EMCY-008");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(3);
  s.rx(0x080, {1}).ignore_tx();     // a SYNC with data: 8200H
  s.rx(0x080).advance(1s).no_tx();  // its end is no message
  s.cif({0x000A, 0xFF00, 0x0081, 0, 0}).ignore_tx();
  s.expect_object(0x1003, 0, 2, 1);
  s.expect_object(0x1001, 0, 0x91, 1);
  s.cif({0x0002, 0, 0x1003, 0, 1, 1});
  s.expect_abort(0x06090030).no_tx();
  s.expect_object(0x1003, 0, 2, 1);
  s.set_object(0x1003, 0, 0, 1).tx(0x083, no_error).no_tx();
  s.expect_object(0x1003, 0, 0, 1);
  s.expect_object(0x1001, 0, 0, 1);
  s.cif({0x0004, 0, 0x1003, 1}).expect(1000, 0x000F);  // an unused sub-index
}

// The inhibit time runs from any message of the module, also one of its own finding.
TEST(Rj71Errors, InhibitTime_RunsFromTheModulesOwnMessageToo) {
  RecordProperty("spec", "RJ71-EMCY-010");
  IntelligentScenario s(rj71cn91);
  s.power_on_as(3);
  s.set_object(0x1015, 0, 10'000, 2).ignore_tx();
  s.rx(0x080, {1}).tx(0x083, {0x00, 0x82, 0x11, 0, 0, 0, 0, 0});
  s.cif({0x000A, 0xFF00, 0x0081, 0, 0}).expect(1000, {0x000C, 0x0001}).no_tx();
  s.advance(900ms);
  s.cif({0x000A, 0xFF00, 0x0081, 0, 0}).expect(1000, {0x000C, 0x0001}).no_tx();
  s.advance(100ms);
  s.cif({0x000A, 0xFF00, 0x0081, 0, 0}).expect(1000, {0x000B, 0x0000});
  s.tx(0x083, {0x00, 0xFF, 0x91, 0, 0, 0, 0, 0});
  s.cif({0x000A, 0xFF00, 0x0081, 0, 0}).expect(1000, {0x000C, 0x0001}).no_tx();
}

// --- time stamp

TEST(Rj71Time, RoleAndTime_AreTakenOverByY12) {
  RecordProperty("spec", "RJ71-TIME-003 RJ71-TIME-004");
  struct Role {
    std::uint16_t word;
    std::uint32_t cob_id;
  };
  for (const Role& role :
       {Role{0, 0x00000100}, Role{1, 0x80000100}, Role{2, 0x40000100}, Role{3, 0xC0000100}}) {
    IntelligentScenario s(rj71cn91);
    s.power_on();
    s.write(50, role.word).expect(50, role.word);
    s.expect_object(0x1012, 0, 0x80000100, 4);
    s.y(0x12, true).expect_x(0x12, true).y(0x12, false).expect_x(0x12, false);
    s.expect_object(0x1012, 0, role.cob_id, 4).expect(29, 0);
    s.nmt(0x82, 0x7F).advance(20ms).ignore_tx();  // not kept over a reset, unless stored
    s.expect_object(0x1012, 0, 0x80000100, 4).expect(50, 1);
  }
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.write(50, {2, 2024, 2, 29, 13, 5, 30}).write(58, 1).y(0x12, true).expect_x(0x12, true).y(0x12, false);
  s.expect(57, 4).expect(29, 0).advance(1s);
  s.write(51, 0)
      .y(0x13, true)
      .expect_x(0x13, true)
      .expect(50, {2, 2024, 2, 29, 13, 5, 31, 4, 1})
      .y(0x13, false);
  // Out of range, one word at a time: nothing is taken.
  struct Bad {
    std::uint16_t address;
    std::uint16_t value;
  };
  for (const Bad& bad : {Bad{51, 1999}, Bad{51, 2080}, Bad{51, 24}, Bad{51, 99}, Bad{52, 0}, Bad{52, 13},
                         Bad{53, 0}, Bad{53, 32}, Bad{54, 24}, Bad{55, 60}, Bad{56, 60}, Bad{58, 1441}}) {
    s.write(51, {2030, 6, 15, 1, 2, 3}).write(58, 1).write(bad.address, bad.value);
    s.y(0x12, true).expect_x(0x12, true).expect(29, 0x0040).expect(39, bad.address).y(0x12, false);
    s.y(0x13, true).expect(51, {2024, 2, 29, 13, 5}).y(0x13, false);
    s.write(bad.address, 1);
    s.clear_errors().expect(29, 0);
  }
  s.write(51, {2023, 2, 29, 0, 0, 0}).y(0x12, true).expect(29, 0x0040).expect(39, 53).y(0x12, false);
  s.write(53, 28);
  s.clear_errors().expect(29, 0);
  for (const std::uint16_t year : Words{2000, 2079}) {
    s.write(51, {year, 12, 31, 23, 59, 59}).write(58, 1440).y(0x12, true).expect(29, 0).y(0x12, false);
    s.y(0x13, true).expect(51, {year, 12, 31, 23, 59, 59}).y(0x13, false);
  }
  s.ignore_tx();
}

TEST(Rj71Time, ReceivedTime_OutsideOf2000To2079_IsTheFirstSecondOf2000) {
  RecordProperty("spec", "RJ71-TIME-006 RJ71-TIME-002 RJ71-TIME-010");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  s.y(0x13, true).expect(51, {2014, 8, 1, 0, 0, 0, 5}).y(0x13, false);
  s.advance(10s).y(0x13, true).expect(56, 0).y(0x13, false);  // it stands until the first TIME
  const auto receive = [&s](std::uint16_t days, std::uint32_t milliseconds) {
    s.rx(0x100,
         {static_cast<std::uint8_t>(milliseconds & 0xFF), static_cast<std::uint8_t>(milliseconds >> 8 & 0xFF),
          static_cast<std::uint8_t>(milliseconds >> 16 & 0xFF), static_cast<std::uint8_t>(milliseconds >> 24),
          static_cast<std::uint8_t>(days & 0xFF), static_cast<std::uint8_t>(days >> 8)});
    s.y(0x13, true).y(0x13, false);
  };
  s.expect_bit(25, 12, false);
  receive(5844, 0);
  s.expect(51, {2000, 1, 1, 0, 0, 0}).expect_bit(25, 12, true).write(25, 0xFFFF).expect_bit(25, 12, true);
  s.write(25, 0).expect_bit(25, 12, false);
  receive(35063, 86'399'000);
  s.expect(51, {2079, 12, 31, 23, 59, 59}).expect_bit(25, 12, true);
  receive(5843, 86'399'000);
  s.expect(51, {2000, 1, 1, 0, 0, 0});
  receive(14669, 47'130'000);
  s.expect(51, {2024, 2, 29, 13, 5, 30});
  receive(35064, 0);
  s.expect(51, {2000, 1, 1, 0, 0, 0});
  receive(0xFFFF, 1000);
  s.expect(51, {2000, 1, 1, 0, 0, 0});
}

// --- data exchange

TEST(Rj71Exchange, OutsideOfOperational_NoProcessData_ButEmergencies) {
  RecordProperty("spec", "RJ71-PDO-003");
  for (const std::uint8_t command : Bytes{0x80, 0x02}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(1);
    s.nmt(0x01, 1).rx(0x201, {1, 0, 2, 0, 3, 0, 4, 0});
    s.nmt(0x80, 1).ignore_tx();
    s.rx(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5});
    s.nmt(command, 1);
    s.write(13000, 0x1111);
    s.exchange();
    s.no_tx().expect(10000, {0, 0, 0, 0}).expect(750, {5, 0x8130, 0x0111, 0x0302, 0x0504});
    s.nmt(0x01, 1).advance(1s).no_tx().expect(10000, 0);  // it does not wait
    s.exchange().tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0}).expect(10000, {1, 2, 3, 4});
  }
}

TEST(Rj71Exchange, G20_SelectsWhatIsExchanged_AndReadsWhatWasWritten) {
  RecordProperty("spec", "RJ71-BM-002");
  for (const std::uint16_t choice : Words{0x0000, 0x0100, 0x1000, 0x1100}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(1);
    s.nmt(0x01, 1)
        .rx(0x201, {7, 0, 0, 0, 0, 0, 0, 0})
        .rx(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0})
        .ignore_tx();
    s.write(20, static_cast<std::uint16_t>(choice | 0x0EFF)).expect(20, choice).write(13000, 9);
    s.y(0x01, true).expect(20, choice).wait_x(0x01, true).y(0x01, false).expect(20, choice);
    const bool process_data = choice != 0x1000, emergencies = choice != 0x0100;
    if (process_data) s.tx(0x181, {9, 0, 0, 0, 0, 0, 0, 0});
    s.no_tx().expect(10000, process_data ? 7 : 0).expect(750, emergencies ? 5 : 0);
    s.cif({0x0004, 0, 0xA100, 1}).expect(1005, process_data ? 9 : 0);
  }
}

TEST(Rj71Exchange, EventTypesFeAndFf_BehaveAlike) {
  RecordProperty("spec", "RJ71-TPDO-004 RJ71-RPDO-003");
  for (const std::uint32_t type : {0xFEU, 0xFFU}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(1);
    s.set_object(0x1800, 2, type, 1);
    s.set_object(0x1400, 2, type, 1);
    s.expect_object(0x1800, 2, type, 1);
    s.nmt(0x01, 1).write(13000, 1);
    s.exchange().tx(0x181, {1, 0, 0, 0, 0, 0, 0, 0});
    s.exchange().no_tx();
    s.write(13003, 1);
    s.exchange().tx(0x181, {1, 0, 0, 0, 0, 0, 1, 0});
    s.rx(0x201, {5, 0, 0, 0, 0, 0, 6, 0});
    s.exchange().expect(10000, {5, 0, 0, 6});  // without a SYNC
    s.rx(0x201, {8, 0, 0, 0, 0, 0, 6, 0}).expect(10000, 5);
    s.exchange().expect(10000, 8).no_tx();
  }
}

// --- command interface

TEST(Rj71Cif, RecordsWithoutANode_AreLeftOut) {
  RecordProperty("spec", "RJ71-SDO-005");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  Words read{0x0008};
  for (unsigned record = 0; record < 8; ++record) {
    const bool used = record == 1 || record == 4 || record == 7;
    const Words words{static_cast<std::uint16_t>(used ? 0 : 0xFFFF), 0x1000, 0, 0, 0, 0, 0, 0};
    read.insert(read.end(), words.begin(), words.end());
  }
  s.cif(read).expect(1000, 0x0009).no_tx();
  for (unsigned record = 0; record < 8; ++record) {
    const bool used = record == 1 || record == 4 || record == 7;
    s.expect(1004 + 8 * record,
             {static_cast<std::uint16_t>(used ? 4 : 0), static_cast<std::uint16_t>(used ? 0x195 : 0)});
  }
  Words write{0x0006};
  for (unsigned record = 0; record < 8; ++record) {
    const bool used = record == 2 || record == 7;
    const Words words{static_cast<std::uint16_t>(used ? 0 : 0xFFFF),
                      0x1016,
                      static_cast<std::uint16_t>(record + 1),
                      4,
                      100,
                      static_cast<std::uint16_t>(record + 1),
                      0,
                      0};
    write.insert(write.end(), words.begin(), words.end());
  }
  s.cif(write).expect(1000, 0x0007);
  for (std::uint8_t sub = 1; sub <= 8; ++sub)
    s.expect_object(0x1016, sub,
                    sub == 3 || sub == 8 ? 0x00000064U | static_cast<std::uint32_t>(sub) << 16 : 0, 4);
  s.cif({0x0008, 0xFFFF, 0, 0, 0, 0, 0, 0, 0, 0xFFFF}).expect(1000, 0x0009);
}

TEST(Rj71Cif, NodeAbove127_IsAnUnknownCommand) {
  RecordProperty("spec", "RJ71-SDO-011");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  for (const std::uint16_t node : Words{128, 255, 256, 0xFFFE}) {
    s.cif({0x0004, node, 0x1000, 0});
    s.expect_abort(0x05040001, node).no_tx();
    s.cif({0x0002, node, 0x1017, 0, 2, 1});
    s.expect_abort(0x05040001, node).no_tx();
  }
  s.cif({0x0008, 128, 0x1000, 0, 0, 0, 0, 0, 0, 0xFFFF});
  s.expect(1000, {0x00F9, 0x0F80, 0x1000, 0, 0, 0x0001, 0x0504}).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_differences_test
