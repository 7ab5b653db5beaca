// spec/me3can1-q/scenarios.md, section 6: command interface - SDO (S25 to S29).

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario::me3can1_q_command_interface_sdo_test {
namespace {

CANOPUS_OF_BOTH_MODULES(CommandInterfaceSdo);

TEST(Me3CommandInterfaceSdo, S25_SdoRead_LocalAndRemote) {
  RecordProperty(
      "spec",
      "ME3-CIF-011 ME3-CIF-002 ME3-CIF-003 ME3-CIF-015 ME3-IO-024 ME3-MODE-008 ME3-SDO-002 ME3-OD-007");
  IntelligentScenario s;
  s.power_on();
  s.write(1000, {0x0004, 0, 0x1000, 0});
  s.advance(1s);
  s.expect(1000, 0x0004);  // the write alone executes nothing
  s.y(0x17, true);
  s.expect(1000, 0xFFFF);
  s.wait_x(0x17, true);
  s.expect(1000, {0x0005, 0, 0x1000, 0, 4, 0x0195, 0}).no_tx();
  s.y(0x17, false);
  s.expect_x(0x17, false);

  s.write(1001, 2);
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.expect(1000, {0xFFFF, 2, 0x1000, 0, 0, 0}).expect_x(0x17, false);  // G1000 alone says so
  s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
  s.expect_x(0x17, true).expect(1000, {0x0005, 2, 0x1000, 0, 4, 0x0191, 0x000F}).no_tx();
  s.y(0x17, false);

  s.cif({0x0004, 0, 0x1008, 0});
  s.expect(1000, {0x0005, 0, 0x1008, 0, 9, 0x454D, 0x4333, 0x4E41, 0x2D31, 0x0051, 0});
  s.cif({0x0004, 0, 0x1009, 0});
  s.expect(1000, {0x0005, 0, 0x1009, 0, 4, 0x2E31, 0x3030});
  s.cif({0x0004, 0, 0x100A, 0});
  s.expect(1000, {0x0005, 0, 0x100A, 0, 4, 0x2E31, 0x3030});
}

TEST_P(CommandInterfaceSdo, OwnNodeId_IsTheOwnDictionary_WithoutBusTraffic) {
  spec("ME3-CIF-016", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.cif({0x0004, 127, 0x1000, 0});
  s.expect(1000, {0x0005, 127, 0x1000, 0, 4, 0x0195, 0}).no_tx();
}

TEST_P(CommandInterfaceSdo, NodeZero_IsTheOwnDictionary_WhateverTheNodeId) {
  spec("ME3-CIF-015 ME3-CIF-016", "RJ71-SDO-008");
  for (const std::uint8_t node_id : Bytes{1, 5, 126}) {
    IntelligentScenario s(GetParam());
    s.power_on_as(node_id);
    for (const std::uint16_t node : Words{0, node_id}) {
      s.cif({0x0004, node, 0x1014, 0});
      s.expect(1000, {0x0005, node, 0x1014, 0, 4, static_cast<std::uint16_t>(0x80U + node_id), 0}).no_tx();
    }
    s.write(1000, {0x0004, 127, 0x1014, 0});  // somebody else now
    s.y(0x17, true);
    s.advance(1ms);
    s.tx(0x67F, {0x40, 0x14, 0x10, 0x00, 0, 0, 0, 0});
    s.rx(0x5FF, {0x43, 0x14, 0x10, 0x00, 0xFF, 0, 0, 0});
    s.expect(1000, {0x0005, 127, 0x1014, 0, 4, 0x00FF, 0}).no_tx();
  }
}

TEST_P(CommandInterfaceSdo, S26_SdoWrite_Remote) {
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(1000, {0x0002, 2, 0x1017, 0, 2, 0x03E8});
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0x00, 0x00});
  s.rx(0x582, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0});
  s.expect_x(0x17, true).expect(1000, {0x0003, 2, 0x1017, 0}).no_tx();
}

// 124 bytes, segmented both ways, byte by byte in the order of the bus.
TEST_P(CommandInterfaceSdo, SdoWriteAndRead_124Bytes_LowByteFirst) {
  spec("ME3-CIF-011 ME3-CIF-013 ME3-CIF-014", "RJ71-SDO-001 RJ71-SDO-002");
  IntelligentScenario s(GetParam());
  s.power_on();
  Words command{0x0002, 2, 0x2000, 1, 124};
  for (unsigned i = 0; i < 124; i += 2) command.push_back(static_cast<std::uint16_t>((i + 2) << 8 | (i + 1)));
  s.write(1000, command);
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x21, 0x00, 0x20, 0x01, 124, 0, 0, 0});
  s.rx(0x582, {0x60, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  for (unsigned segment = 0; segment < 18; ++segment) {
    const unsigned bytes = segment == 17 ? 5 : 7;
    const unsigned toggle = segment % 2 * 0x10;
    Bytes expected(8, 0);
    expected[0] = static_cast<std::uint8_t>(toggle | (7 - bytes) << 1 | (segment == 17 ? 1 : 0));
    for (unsigned i = 0; i < bytes; ++i) expected[i + 1] = static_cast<std::uint8_t>(segment * 7 + i + 1);
    s.tx(0x602, expected);
    s.rx(0x582, {static_cast<std::uint8_t>(0x20 | toggle), 0, 0, 0, 0, 0, 0, 0});
  }
  s.expect_x(0x17, true).expect(1000, {0x0003, 2, 0x2000, 1}).no_tx();
  s.y(0x17, false);

  s.write(1000, {0x0004, 2, 0x2000, 1});
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  s.rx(0x582, {0x41, 0x00, 0x20, 0x01, 124, 0, 0, 0});
  for (unsigned segment = 0; segment < 18; ++segment) {
    const unsigned bytes = segment == 17 ? 5 : 7;
    const unsigned toggle = segment % 2 * 0x10;
    s.tx(0x602, {static_cast<std::uint8_t>(0x60 | toggle), 0, 0, 0, 0, 0, 0, 0});
    Bytes answer(8, 0);
    answer[0] = static_cast<std::uint8_t>(toggle | (7 - bytes) << 1 | (segment == 17 ? 1 : 0));
    for (unsigned i = 0; i < bytes; ++i) answer[i + 1] = static_cast<std::uint8_t>(segment * 7 + i + 1);
    s.rx(0x582, answer);
  }
  s.expect_x(0x17, true)
      .expect(1000, {0x0005, 2, 0x2000, 1, 124, 0x0201, 0x0403})
      .expect(1066, 0x7C7B)
      .no_tx();
  s.y(0x17, false);

  for (const std::uint16_t node : Words{0, 2}) {
    for (const std::uint16_t length : Words{0, 125, 0xFFFF}) {
      s.cif({0x0002, node, 0x1017, 0, length, 1});
      s.expect_abort(0x06070010, node).no_tx();
    }
  }
}

TEST_P(CommandInterfaceSdo, SdoRead_MoreThan124Bytes_FailsAtTheStart) {
  spec("ME3-CIF-012", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(1000, {0x0004, 2, 0x2000, 1});
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  s.rx(0x582, {0x41, 0x00, 0x20, 0x01, 125, 0, 0, 0});
  s.expect_x(0x17, true);
  s.expect_abort(0x60600000, 2);
  s.tx(0x602, {0x80, 0x00, 0x20, 0x01, 0x05, 0x00, 0x04, 0x05}).no_tx();  // no segment was asked for
  s.y(0x17, false);
  // The own dictionary: a concise DCF of 131 bytes comes over the bus, and is too long to be read.
  const std::uint8_t size = 131;
  s.rx(0x67F, {0x21, 0x22, 0x1F, 0x05, size, 0, 0, 0}).tx(0x5FF, {0x60, 0x22, 0x1F, 0x05, 0, 0, 0, 0});
  for (unsigned sent = 0, segment = 0; sent < size; sent += 7, ++segment) {
    const unsigned unused = size - sent < 7 ? 7 - (size - sent) : 0;
    const unsigned last = size - sent <= 7 ? 1 : 0;
    s.rx(0x67F, {static_cast<std::uint8_t>(segment % 2 * 0x10 | unused << 1 | last), 0, 0, 0, 0, 0, 0, 0});
    s.tx(0x5FF, {static_cast<std::uint8_t>(0x20 | segment % 2 * 0x10), 0, 0, 0, 0, 0, 0, 0});
  }
  s.cif({0x0004, 0, 0x1F22, 5});
  s.expect_abort(0x60600000).no_tx();
}

TEST_P(CommandInterfaceSdo, S27_SdoFailures_ShowClassNodeAndAbortCode) {
  spec("ME3-CIF-008 ME3-SDO-004 ME3-SDO-005 ME3-DLY-002",
       "RJ71-CIF-010 RJ71-SDO-010 RJ71-SDO-012 RJ71-BM-022");
  IntelligentScenario s(GetParam());
  s.power_on();
  const std::vector<std::pair<Bytes, Words>> aborts{
      {{0x30, 0x00, 0x09, 0x06}, {0x0030, 0x0609}},
      {{0x02, 0x00, 0x01, 0x06}, {0x0002, 0x0601}},
      {{0x78, 0x56, 0x34, 0x12}, {0x5678, 0x1234}},  // no code anybody knows
  };
  for (const auto& [code, words] : aborts) {
    s.write(1000, {0x0002, 2, 0x1017, 0, 2, 0x03E8});
    s.y(0x17, true);
    s.advance(1ms);
    s.tx(0x602, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0x00, 0x00});
    s.rx(0x582, {0x80, 0x17, 0x10, 0x00, code[0], code[1], code[2], code[3]});
    s.expect_x(0x17, true).expect(1000, {0x000F, 0x0003, 2, words[0], words[1], either(0, 0x03E8)}).no_tx();
    s.y(0x17, false);
  }
  s.expect(71, 500);
  for (const std::uint16_t time_out : Words{500, 50, 1000}) {
    s.write(71, time_out);
    s.write(1000, {0x0002, 2, 0x1017, 0, 2, 0x03E8});
    s.y(0x17, true);
    s.advance(1ms);
    s.tx(0x602, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0x00, 0x00});
    s.advance(std::chrono::milliseconds(time_out - 1));
    s.expect(1000, 0xFFFF).expect_x(0x17, false);
    s.advance(1ms);
    s.expect_x(0x17, true);
    s.expect_abort(0x05040000, 2);
    s.tx(0x602, {0x80, 0x17, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}).no_tx();
    s.y(0x17, false);
  }
  s.write(71, 32767);
  s.expect(29, 0).expect(71, 32767);
  for (const std::uint16_t wrong : Words{0, 49, 32768, 65535}) {
    s.write(71, wrong);
    s.expect(29, 0x0040).expect(39, 71).expect(71, 32767);
    s.clear_errors();
  }
  s.save();
  s.restart();
  s.expect(71, 32767);
}

TEST(Me3CommandInterfaceSdo, S28_MultiRead) {
  RecordProperty("spec", "ME3-CIF-017 ME3-CIF-018 ME3-CIF-020 ME3-OD-003");
  IntelligentScenario s;
  s.power_on();
  Words command(67, 0xAAAA);  // stale data everywhere
  command[0] = 0x0008;
  const auto record = [&](std::size_t number, const Words& words) {
    std::copy(words.begin(), words.end(), command.begin() + static_cast<std::ptrdiff_t>(1 + 8 * number));
  };
  record(0, {0, 0x1000, 0});
  record(1, {0, 0x1018, 4});
  record(2, {0xFFFF});
  s.cif(command);
  s.expect(1000, 0x00F9);
  s.expect(1001, {0, 0x1000, 0, 4, 0x0195, 0, 0, 0});
  s.expect(1009, {0x0F00, 0x1018, 4, 0, 0x0011, 0x0609});
  s.no_tx();
  record(1, {0, 0x1018, 1});
  s.cif(command);
  s.expect(1000, {0x0009, 0, 0x1000, 0, 4, 0x0195, 0, 0, 0});
  s.expect(1009, {0, 0x1018, 1, 4, 0x0071, 0x0000});
  // Eight records need no terminator; the ninth does not exist.
  for (std::size_t i = 0; i < 8; ++i) record(i, {0, 0x1018, static_cast<std::uint16_t>(1 + i % 3)});
  s.cif(command);
  s.expect(1000, 0x0009);
  s.expect(1057, {0, 0x1018, 2, 4, 0xED63, 0x0000});
  // More than eight bytes do not fit into a record.
  record(0, {0, 0x1008, 0});
  record(1, {0xFFFF});
  s.cif(command);
  s.expect(1000, {0x00F9, 0x0F00, 0x1008, 0, 0, 0x0000, 0x6060});
  // A remote record.
  record(0, {2, 0x1000, 0});
  s.write(1000, command);
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x582, {0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x00, 0x08});
  s.expect_x(0x17, true).expect(1000, {0x00F9, 0x0F02, 0x1000, 0, 0, 0x0000, 0x0800}).no_tx();
}

TEST(Me3CommandInterfaceSdo, MultiRead_EightRecords_OfUpToEightBytes) {
  RecordProperty("spec", "ME3-CIF-017 ME3-CIF-020");
  IntelligentScenario s;
  s.power_on();
  Words command{0x0008};
  const auto add = [&](const Words& record) { command.insert(command.end(), record.begin(), record.end()); };
  add({0, 0x1018, 1, 9, 0xAAAA, 0xAAAA, 0xAAAA, 0xAAAA});
  add({2, 0x2000, 1, 9, 0xAAAA, 0xAAAA, 0xAAAA, 0xAAAA});
  add({3, 0x2001, 2, 9, 0xAAAA, 0xAAAA, 0xAAAA, 0xAAAA});
  for (std::uint16_t sub = 0; sub < 4; ++sub) add({0, 0x1018, sub, 0, 0, 0, 0, 0});
  add({127, 0x1017, 0, 0, 0, 0, 0, 0});
  add({0xAAAA, 0xAAAA});
  s.write(1000, command);
  s.y(0x17, true);
  s.advance(1ms);
  // Eight bytes, then five.
  s.tx(0x602, {0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}).rx(0x582, {0x41, 0x00, 0x20, 0x01, 8, 0, 0, 0});
  s.tx(0x602, {0x60, 0, 0, 0, 0, 0, 0, 0}).rx(0x582, {0x00, 1, 2, 3, 4, 5, 6, 7});
  s.tx(0x602, {0x70, 0, 0, 0, 0, 0, 0, 0}).rx(0x582, {0x1D, 8, 0, 0, 0, 0, 0, 0});
  s.expect(1000, 0xFFFF).expect_x(0x17, false);
  s.tx(0x603, {0x40, 0x01, 0x20, 0x02, 0, 0, 0, 0}).rx(0x583, {0x41, 0x01, 0x20, 0x02, 5, 0, 0, 0});
  s.tx(0x603, {0x60, 0, 0, 0, 0, 0, 0, 0}).rx(0x583, {0x05, 0x11, 0x12, 0x13, 0x14, 0x15, 0, 0});
  s.expect_x(0x17, true).no_tx();
  s.expect(1000, {0x0009, 0, 0x1018, 1, 4, 0x0071, 0, 0, 0});
  s.expect(1009, {2, 0x2000, 1, 8, 0x0201, 0x0403, 0x0605, 0x0807});
  s.expect(1017, {3, 0x2001, 2, 5, 0x1211, 0x1413, 0x0015, 0});
  s.expect(1025, {0, 0x1018, 0, 1, 0x0003, 0, 0, 0});
  s.expect(1033, {0, 0x1018, 1, 4, 0x0071, 0, 0, 0});
  s.expect(1041, {0, 0x1018, 2, 4, 0xED63, 0, 0, 0});
  s.expect(1049, {0, 0x1018, 3, 4, 0x0000, 0x0001, 0, 0});
  s.expect(1057, {127, 0x1017, 0, 2, 0, 0, 0, 0, 0, 0});
}

TEST(Me3CommandInterfaceSdo, S29_MultiWrite) {
  RecordProperty("spec", "ME3-CIF-019 ME3-CIF-020 ME3-OD-004");
  IntelligentScenario s;
  s.power_on();
  s.cif({0x0006, 0, 0x1015, 0, 2, 0x03E8, 0, 0, 0, 0, 0x1000, 0, 4, 1, 0, 0, 0, 0xFFFF});
  s.expect(1000, 0x00F7);
  s.expect(1001, {0, 0x1015, 0});
  s.expect(1009, {0x0F00, 0x1000, 0}).expect(1013, {0x0002, 0x0601});
  s.expect_object(0x1015, 0, 1000, 2);
  Words command{0x0006};
  for (std::uint16_t i = 1; i <= 8; ++i) {
    const Words record{0, 0x1F89, 0, 4, i, 0, 0, 0};
    command.insert(command.end(), record.begin(), record.end());
  }
  s.cif(command);
  s.expect(1000, 0x0007).expect(1057, {0, 0x1F89, 0});
  s.expect_object(0x1F89, 0, 8, 4);
  s.cif({0x0006, 0, 0x1F89, 0, 9, 1, 0, 0, 0, 0xFFFF});
  s.expect(1000, {0x00F7, 0x0F00}).expect(1005, {0x0010, 0x0607});
  // What lies behind the end of the list is not written.
  s.cif({0x0006, 0, 0x1F89, 0, 4, 77, 0, 0, 0, 0xFFFF, 0x1F89, 0, 4, 78, 0, 0, 0, 0, 0x1F89, 0, 4, 79, 0});
  s.expect(1000, 0x0007);
  s.expect_object(0x1F89, 0, 77, 4);
  // Reading what can only be written.
  s.cif({0x0004, 0, 0x1F82, 0x80});
  s.expect_abort(0x06010001);
  for (const std::uint16_t sub : Words{1, 0x80}) {
    s.cif({0x0004, 0, 0x1F25, sub});
    s.expect_abort(0x06010001);
  }
}

TEST_P(CommandInterfaceSdo, MultiWrite_ToOtherNodes_OfUpToEightBytes) {
  spec("ME3-CIF-019", "RJ71-SDO-004 RJ71-SDO-007");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.write(1000, {0x0006, 2, 0x2000, 1, 8, 0x0201, 0x0403, 0x0605, 0x0807, 3, 0x1017, 0, 2,
                 0x03E8, 0, 0,      0, 4, 0x2001, 5,      1,      0x0099, 0, 0,      0, 0xFFFF});
  s.y(0x17, true);
  s.advance(1ms);
  s.tx(0x602, {0x21, 0x00, 0x20, 0x01, 8, 0, 0, 0}).rx(0x582, {0x60, 0x00, 0x20, 0x01, 0, 0, 0, 0});
  s.tx(0x602, {0x00, 1, 2, 3, 4, 5, 6, 7}).rx(0x582, {0x20, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x602, {0x1D, 8, 0, 0, 0, 0, 0, 0}).rx(0x582, {0x30, 0, 0, 0, 0, 0, 0, 0});
  s.tx(0x603, {0x2B, 0x17, 0x10, 0x00, 0xE8, 0x03, 0, 0});
  s.rx(0x583, {0x80, 0x17, 0x10, 0x00, 0x30, 0x00, 0x09, 0x06});
  s.expect(1000, 0xFFFF).expect_x(0x17, false);
  s.tx(0x604, {0x2F, 0x01, 0x20, 0x05, 0x99, 0, 0, 0}).rx(0x584, {0x60, 0x01, 0x20, 0x05, 0, 0, 0, 0});
  s.expect_x(0x17, true).no_tx();
  s.expect(1000, {0x00F7, 2, 0x2000, 1});
  s.expect(1009, {0x0F03, 0x1017, 0}).expect(1013, {0x0030, 0x0609});
  s.expect(1017, {4, 0x2001, 5});
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_command_interface_sdo_test
