// spec/me3can1-q/scenarios.md, section 6: command interface - emergencies, display, errors, planes (S32 to S37).

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_command_interface_test {
namespace {

CANOPUS_OF_BOTH_MODULES(CommandInterface);

TEST_P(CommandInterface, S32_SendEmergency) {
  spec("ME3-CIF-021 ME3-CIF-022 ME3-CIF-023 ME3-EMCY-001 ME3-OD-008",
       "RJ71-EMCY-009 RJ71-EMCY-010 RJ71-EMCY-011 RJ71-EMCY-001");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.cif({0x000A, 0x1000, 0xAA81, 0xCCBB, 0xEEDD});
  s.tx(0x081, {0x00, 0x10, 0x81, 0xAA, 0xBB, 0xCC, 0xDD, 0xEE}).no_tx();
  s.expect(1000, {0x000B, 0x0000});
  s.expect_object(0x1003, 0, 1, 1);
  s.cif({0x0004, 0, 0x1003, 1});
  s.expect(1005, 0x1000);
  s.expect_object(0x1001, 0, 0x81, 1);
  s.set_object(0x1003, 0, 0, 1);
  s.expect_object(0x1001, 0, 0, 1);
  s.ignore_tx();

  s.set_object(0x1015, 0, 1000, 2);  // 100 ms
  s.cif({0x000A, 0x1000, 0x0001, 0, 0});
  s.expect(1000, {0x000B, 0x0000});
  s.tx(0x081, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.cif({0x000A, 0x1001, 0x0001, 0, 0});
  s.expect(1000, {0x000C, 0x0001}).no_tx();
  s.advance(97500us);  // a command takes 1 ms: 99.5 ms after the message
  s.cif({0x000A, 0x1001, 0x0001, 0, 0});
  s.expect(1000, {0x000C, 0x0001}).no_tx();
  s.advance(10s);
  s.no_tx();
  s.cif({0x000A, 0x1001, 0x0001, 0, 0});
  s.expect(1000, {0x000B, 0x0000});
  s.tx(0x081, {0x01, 0x10, 0x01, 0, 0, 0, 0, 0});
  s.advance(100ms);

  s.nmt(0x02);
  s.cif({0x000A, 0x1002, 0x0001, 0, 0});
  s.expect(1000, {0x000C, 0x0002}).no_tx();
  s.nmt(0x01);  // Operational
  s.cif({0x000A, 0x1003, 0x0001, 0, 0});
  s.expect(1000, {0x000B, 0x0000});
  s.tx(0x081, {0x03, 0x10, 0x01, 0, 0, 0, 0, 0}).no_tx();
}

// The generic bit hangs on the code, the others are the program's.
TEST_P(CommandInterface, SendEmergency_ErrorRegister) {
  spec("ME3-OD-008", "");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.expect_object(0x1001, 0, 0x00, 1);
  s.cif({0x000A, 0x00FF, 0x0010, 0, 0});
  s.tx(0x081, {0xFF, 0x00, 0x10, 0, 0, 0, 0, 0}).no_tx();
  s.expect_object(0x1001, 0, 0x10, 1);
  s.set_object(0x1003, 0, 0, 1);
  s.ignore_tx();
  s.expect_object(0x1001, 0, 0x00, 1);
  s.cif({0x000A, 0x0100, 0x0080, 0, 0});
  s.tx(0x081, {0x00, 0x01, 0x81, 0, 0, 0, 0, 0}).no_tx();
  s.expect_object(0x1001, 0, 0x81, 1);
  s.set_object(0x1003, 0, 0, 1);
  s.ignore_tx();
  s.expect_object(0x1001, 0, 0x00, 1);
  s.cif({0x000A, 0x1000, 0x00FE, 0, 0});
  s.ignore_tx();
  s.expect_object(0x1001, 0, 0xFF, 1);
}

TEST_P(CommandInterface, S33_Display_ShowsTheParametersOfTheLastCommand) {
  spec("ME3-CIF-007", "RJ71-CIF-009");
  IntelligentScenario s(GetParam());
  s.power_on_as(1);
  s.cif({0x000A, 0x1000, 0xAA81, 0xCCBB, 0xEEDD});
  s.ignore_tx();
  s.expect(1000, {0x000B, 0x0000});
  s.write(1000, 0x0000);
  s.y(0x17, true);
  s.wait_x(0x17, true);
  s.expect(1000, {0x0000, 0x1000, 0xAA81, 0xCCBB, 0xEEDD}).no_tx();
}

TEST_P(CommandInterface, Display_AfterAnError_WholeBlock_InEveryMode) {
  spec("ME3-CIF-007", "RJ71-CIF-009");
  IntelligentScenario s(GetParam());
  s.power_on();
  Words parameters;
  for (std::uint16_t i = 1; i <= 66; ++i) parameters.push_back(static_cast<std::uint16_t>(0x4000 + i));
  for (const bool layer2 : {false, true}) {
    if (layer2) {
      s.write(21, 11);
      s.save();
      s.restart();
    }
    s.cif({0x0000});
    s.expect(1000, Words(67, 0));  // no command yet
    s.write(1001, parameters);
    s.cif({0x1234});
    s.expect(1000, {0x000F, 0x0064});
    // One memory: what the error does not need stays as it was [RJ71CN91 App. 2 CIF].
    s.expect(1002, is_rj71cn91() ? Words(parameters.begin() + 1, parameters.end()) : Words(65, 0));
    // What the program has written beside the display command is not what it issued last.
    s.cif({0x0000, 1, 2, 3});
    s.expect(1000, 0x0000).expect(1001, parameters);
    s.cif({0x0000});
    s.expect(1000, 0x0000).expect(1001, parameters);
    s.write(1002, 7);  // the parameters are there to be adjusted
    s.expect(1000, {0x0000, 0x4001, 7, 0x4003}).expect(1066, 0x4042).no_tx();
  }
}

TEST_P(CommandInterface, S34_UnknownCommand) {
  spec("ME3-CIF-006 ME3-CIF-026", "RJ71-CIF-004 RJ71-CIF-003");
  IntelligentScenario s(GetParam());
  s.power_on();
  for (const std::uint16_t code : Words{0x1234, 0x000C, 0x0001, 0x0003, 0x0005, 0x000F}) {
    s.cif({code});
    s.expect(1000, {0x000F, 0x0064});
  }
  s.cif({0x0000});
  s.expect(1000, 0x0000);
  s.cif({0xFFFF});
  s.expect(1000, 0x0000);
  s.write(21, 11);
  s.save();
  s.restart();
  for (const std::uint16_t code : Words{0x0002, 0x0004, 0x0006, 0x0008, 0x000A, 0x1234}) {
    s.cif({code});
    s.expect(1000, {0x000F, 0x0064});
  }
  s.cif({0x0000});
  s.expect(1000, 0x0000);
  s.cif({0x000C, 0x123, 0, 0, 0});
  s.expect(1000, {0x000F, 0x0F0F});  // known here, but the module is offline
  s.cif({0xFFFF});
  s.expect(1000, 0x0000).no_tx();
}

TEST_P(CommandInterface, S35_WriteWhileBusy_LocksUntilFfffh) {
  spec("ME3-CIF-004 ME3-CIF-005", "RJ71-CIF-007 RJ71-CIF-008");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(1000, {0x0004, 2, 0x1000, 0, 0, 7});
  s.y(0x17, true);
  s.advance(1ms);
  s.ignore_tx();
  s.expect(1000, 0xFFFF);
  s.write(1005, 1);
  s.expect(1000, {0x000F, 0xFFFF});
  s.wait_x(0x17, true);
  s.ignore_tx();
  s.expect(1000, {0x000F, 0xFFFF});
  s.y(0x17, false);
  s.cif({0x0004, 0, 0x1000, 0});
  s.expect(1000, {0x000F, 0xFFFF});
  s.cif({0xFFFF});
  s.expect(1000, 0x0000);
  s.write(1000, 0x0000);
  s.expect(1005, 7);  // the write that came too early was not stored
  s.cif({0x0004, 0, 0x1000, 0});
  s.expect(1000, {0x0005, 0, 0x1000, 0, 4, 0x0195});
}

TEST_P(CommandInterface, WriteWhileBusy_ToAnyWord_IsNotStored) {
  spec("ME3-CIF-004 ME3-CIF-005", "RJ71-CIF-007 RJ71-CIF-008");
  Words command{0x0004, 2, 0x1000, 0};
  for (std::uint16_t i = 4; i <= 66; ++i) command.push_back(static_cast<std::uint16_t>(0x100 + i));
  for (std::uint16_t word = 0; word <= 66; ++word) {
    IntelligentScenario s(GetParam());
    s.power_on();
    s.write(1000, command);
    s.y(0x17, true);
    s.advance(1ms);
    s.tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
    s.write(1000U + word, 0x0000);
    s.expect(1000, {0x000F, 0xFFFF}).expect_x(0x17, false);
    s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
    s.expect(1000, {0x000F, 0xFFFF}).expect_x(0x17, true).no_tx();
    s.y(0x17, false);
    for (const std::uint16_t refused : Words{0x0004, 0x0002, 0x000A, 0x0000}) {
      s.cif({refused});
      s.expect(1000, {0x000F, 0xFFFF}).no_tx();
    }
    s.cif({0xFFFF});
    s.expect(1000, 0x0000);
    s.write(1000, command[0]);
    Words kept = command;
    if (is_rj71cn91()) kept[1] = 0xFFFF;  // one memory: the error was stored there
    s.expect(1000, kept);
  }
}

// FFFFH counts as a clear command only at its place, and not as the write that does the harm.
TEST_P(CommandInterface, WriteWhileBusy_OfFfffh_IsNotStoredEither) {
  spec("ME3-CIF-004 ME3-CIF-005", "RJ71-CIF-007 RJ71-CIF-008");
  for (const module::BufferAddress word : {1000U, 1005U}) {
    IntelligentScenario s(GetParam());
    s.power_on();
    s.write(1000, {0x0004, 2, 0x1000, 0});
    s.y(0x17, true).advance(1ms).ignore_tx();
    s.write(word, 0xFFFF).expect(1000, {0x000F, 0xFFFF});
    if (word != 1000) s.write(word, 0xFFFF);
    s.y(0x17, false).y(0x17, true).advance(10ms).expect(1000, {0x000F, 0xFFFF}).no_tx();
    s.y(0x17, false).advance(10s).ignore_tx();
    s.expect(1000, {0x000F, 0xFFFF});
    s.cif({0xFFFF});
    s.expect(1000, 0x0000);
  }
}

TEST_P(CommandInterface, WriteWhileBusy_ClearedBeforeTheTransferEnds_GivesItUp) {
  spec("ME3-CIF-004 ME3-CIF-005", "RJ71-CIF-007 RJ71-CIF-008");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(1000, {0x0004, 2, 0x1000, 0});
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.write(1005, 1);
  s.y(0x17, false);
  s.cif({0xFFFF});
  s.expect(1000, 0x0000);
  s.ignore_tx();
  s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
  s.advance(2s);
  s.expect(1000, {0x0000, either(0, 0xFFFF)}).no_tx();
  s.cif({0x0004, 0, 0x1000, 0});
  s.expect(1000, {0x0005, 0, 0x1000, 0, 4, 0x0195}).no_tx();
  // Once more, and at once to another node: nothing of the first transfer is in the way.
  s.write(1000, {0x0004, 2, 0x1000, 0}).y(0x17, true).advance(1ms);
  s.write(1005, 1).y(0x17, false).ignore_tx();
  s.cif({0xFFFF});
  s.write(1000, {0x0004, 3, 0x1018, 1}).y(0x17, true).ignore_tx().advance(1ms);
  s.tx(0x603, {0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0});
  s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00}).expect(1000, 0xFFFF);
  s.rx(0x583, {0x43, 0x18, 0x10, 0x01, 0x71, 0, 0, 0}).expect(1000, {0x0005, 3, 0x1018, 1, 4, 0x0071, 0});
  s.expect_x(0x17, true).no_tx();
}

TEST(Me3CommandInterface, S36_TwoPlanes) {
  RecordProperty("spec", "ME3-CIF-001");
  IntelligentScenario s;
  s.power_on();
  s.cif({0x0004, 0, 0x1018, 2});
  s.expect(1000, {0x0005, 0, 0x1018, 2, 4, 0xED63});
  s.write(1003, 1);
  s.expect(1000, {0x0004, 0, 0x1018, 1, 0, 0});
  s.y(0x17, true);
  s.wait_x(0x17, true);
  s.expect(1000, {0x0005, 0, 0x1018, 1, 4, 0x0071});
  // The whole block, and the display command instead of a write.
  Words request{0x0004, 0, 0x1018, 2};
  for (std::uint16_t i = 4; i <= 66; ++i) request.push_back(static_cast<std::uint16_t>(0x100 + i));
  Words result{0x0005, 0, 0x1018, 2, 4, 0xED63};
  result.resize(67);
  s.y(0x17, false);
  s.write(1000, request);
  s.expect(1000, request);
  s.y(0x17, true);
  s.wait_x(0x17, true);
  s.expect(1000, result);
  s.y(0x17, false);
  s.write(1066, 0x1234);
  request[66] = 0x1234;
  s.expect(1000, request);
  s.y(0x17, true);
  s.wait_x(0x17, true);
  s.expect(1000, result);
  s.y(0x17, false);
  s.cif({0x0000});
  request[0] = 0;
  s.expect(1000, request);
}

// What stays inside the module needs no bus: Stopped and bus-off do not matter.
TEST(Me3CommandInterface, OwnDictionary_IsReachedInStoppedAndAtBusOff) {
  RecordProperty("spec", "ME3-CIF-009 ME3-CIF-010 ME3-CIF-015");
  for (const bool bus_off : {true, false}) {
    const std::uint16_t obstacle = bus_off ? 0xB0FF : 0x0F0F;
    IntelligentScenario s;
    s.power_on_as(5);
    if (bus_off) {
      s.error_counters(256, 0);
    } else {
      s.nmt(0x02, 5);
    }
    s.ignore_tx();
    for (const std::uint16_t own : Words{0, 5}) {
      s.cif({0x0004, own, 0x1018, 1});
      s.expect(1000, {0x0005, own, 0x1018, 1, 4, 0x0071});
      s.cif({0x0002, own, 0x1015, 0, 2, 7});
      s.expect(1000, {0x0003, own, 0x1015, 0});
      s.cif({0x0008, own, 0x1018, 1, 0, 0, 0, 0, 0, 0xFFFF, 0, 0, 0, 0, 0, 0, 0,
             2});  // after the end: no record
      s.expect(1000, {0x0009, own, 0x1018, 1, 4, 0x0071});
      s.cif({0x0006, own, 0x1015, 0, 2, 9, 0, 0, 0, 0xFFFF});
      s.expect(1000, {0x0007, own, 0x1015, 0});
      s.cif({0x0006, 0xFFFF});  // nothing to do
      s.expect(1000, 0x0007);
    }
    Words eight{0x0008};
    for (int i = 0; i < 8; ++i) eight.insert(eight.end(), {0, 0x1018, 1, 0, 0, 0, 0, 0});
    s.cif(eight);
    s.expect(1000, 0x0009).expect(1057, {0, 0x1018, 1, 4, 0x0071});
    // One record for somebody else, and nothing is done.
    eight[57] = 2;
    s.cif(eight);
    s.expect(1000, {0x000F, obstacle, 0, 0, 0}).no_tx();
    s.cif({0x0004, 2, 0x1018, 1});
    s.expect(1000, {0x000F, obstacle, 0, 0, 0}).no_tx();
  }
}

TEST_P(CommandInterface, S37_BusOffAndWrongState) {
  spec("ME3-CIF-009 ME3-CIF-010", "RJ71-CIF-006 RJ71-CIF-005");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.nmt(0x02);
  const std::vector<Words> commands{
      {0x0004, 2, 0x1000, 0},
      {0x0002, 2, 0x1017, 0, 2, 1},
      {0x0006, 0, 0x1015, 0, 2, 1, 0, 0, 0, 2, 0x1017, 0, 2, 1, 0, 0, 0, 0xFFFF},
      {0x0008, 0, 0x1000, 0, 0, 0, 0, 0, 0, 2, 0x1000, 0, 0, 0, 0, 0, 0, 0xFFFF}};
  for (const Words& command : commands) {
    s.cif(command);
    s.expect(1000, {0x000F, 0x0F0F}).no_tx();
  }
  s.cif({0x0004, 0, 0x1000, 0});  // the own dictionary needs no bus
  s.expect(1000, 0x0005);
  s.nmt(0x80);
  s.error_counters(256, 0);
  s.ignore_tx();
  for (const Words& command : commands) {
    s.cif(command);
    s.expect(1000, {0x000F, 0xB0FF}).no_tx();
  }
  s.cif({0x000A, 0x1000, 1, 0, 0});
  s.expect(1000, {0x000F, 0xB0FF}).no_tx();
  s.cif({0x0004, 0, 0x1000, 0});
  s.expect(1000, 0x0005);
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_command_interface_test
