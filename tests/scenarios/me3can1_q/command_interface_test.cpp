// spec/me3can1-q/scenarios.md, section 6: command interface.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

CANOPUS_OF_BOTH_MODULES(CommandInterface);

// Active NMT master, node 1, no slaves assigned, own state Pre-operational.
void become_master(IntelligentScenario& s) {
  s.power_on_as(1);
  s.set_object(0x1F80, 0, 0x0000000D, 4);  // stays Pre-operational, starts no slave
  s.store_objects();
  s.restart();
  s.advance(5s);
  s.ignore_tx();
  s.expect_bit(25, 15, true).expect_bit(25, 8, true);
}

TEST(Me3CommandInterface, S24_RequestNmtToAllNodes_StartsTheNetwork) {
  RecordProperty("spec", "ME3-RQN-002");
  IntelligentScenario s;
  become_master(s);
  s.write(1000, {0x0002, 0, 0x1F82, 0x0080, 1, 0x0005});
  s.y(0x17, true);
  s.expect(1000, 0xFFFF).expect_x(0x17, false);
  s.wait_x(0x17, true);
  s.tx(0x000, {0x01, 0x00});
  s.expect(1000, {0x0003, 0, 0x1F82, 0x0080});
  s.expect_bit(25, 0, true).expect_bit(25, 8, false).expect_bit(25, 9, true);
  s.y(0x17, false);
  s.expect_x(0x17, false);
  const std::map<std::uint16_t, std::uint8_t> services{{4, 0x02}, {5, 0x01}, {0x7F, 0x80}, {5, 0x01}};
  for (const auto& [value, command] : services) {
    s.cif({0x0002, 0, 0x1F82, 0x0080, 1, value});
    s.expect(1000, 0x0003);
    s.tx(0x000, {command, 0x00});
    s.expect(601, value);
  }
  s.no_tx();
  for (const auto& [value, command] : std::map<std::uint16_t, std::uint8_t>{{6, 0x81}, {7, 0x82}}) {
    s.cif({0x0002, 0, 0x1F82, 0x0080, 1, value});
    s.tx(0x000, {command, 0x00});
    s.wait_bit(25, 7, true);
    s.wait_bit(25, 7, false);
    s.expect_bit(25, 6, true);
    s.advance(5s);
    s.ignore_tx();
  }
}

TEST_P(CommandInterface, RequestNmtToOneNode_SendsOneFrame) {
  spec("ME3-RQN-001 ME3-NST-003",
       "RJ71-NODECTL-001 RJ71-NODECTL-002 RJ71-NODECTL-003 RJ71-NODECTL-004 RJ71-NODECTL-005 "
       "RJ71-NODECTL-011");
  IntelligentScenario s(GetParam());
  become_master(s);
  s.expect(602, 0);
  const std::vector<std::pair<std::uint16_t, std::uint8_t>> services{
      {4, 0x02}, {5, 0x01}, {6, 0x81}, {7, 0x82}, {0x7F, 0x80}};
  for (const auto& [value, command] : services) {
    s.cif({0x0002, 0, 0x1F82, 2, 1, value});
    s.expect(1000, 0x0003);
    s.tx(0x000, {command, 0x02}).no_tx();
    if (value == 4 || value == 5 || value == 0x7F) s.expect(602, value);
  }
  s.expect_bit(25, 8, true);  // the own state is untouched
}

TEST_P(CommandInterface, RequestNmt_ReservedValues_AreRefused) {
  spec("ME3-RQN-004", "");
  IntelligentScenario s(GetParam());
  become_master(s);
  const std::vector<std::uint16_t> good{4, 5, 6, 7, 0x7F, 0x84, 0x85, 0x86, 0x87, 0x8F};
  for (std::uint16_t value = 0; value <= 0xFE; ++value) {
    if (std::find(good.begin(), good.end(), value) != good.end()) continue;
    for (const std::uint16_t sub : Words{1, 2, 127, 0x80}) {
      s.cif({0x0002, 0, 0x1F82, sub, 1, value});
      s.expect_abort(0x06090030);
    }
  }
  s.no_tx().expect_bit(25, 8, true);  // nor is the own state changed
}

TEST_P(CommandInterface, RequestNmt_AsSlave_SendsNothing) {
  spec("ME3-NMT-010", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.cif({0x0002, 0, 0x1F82, 2, 1, 5});
  s.expect_abort(0x08000022).no_tx();
  s.cif({0x0002, 0, 0x1F82, 0x80, 1, 5});
  s.expect_abort(0x08000022).no_tx();
}

TEST(Me3CommandInterface, S25_SdoRead_LocalAndRemote) {
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

TEST_P(CommandInterface, OwnNodeId_IsTheOwnDictionary_WithoutBusTraffic) {
  spec("ME3-CIF-016", "");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.cif({0x0004, 127, 0x1000, 0});
  s.expect(1000, {0x0005, 127, 0x1000, 0, 4, 0x0195, 0}).no_tx();
}

TEST_P(CommandInterface, NodeZero_IsTheOwnDictionary_WhateverTheNodeId) {
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

TEST_P(CommandInterface, S26_SdoWrite_Remote) {
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
TEST_P(CommandInterface, SdoWriteAndRead_124Bytes_LowByteFirst) {
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

TEST_P(CommandInterface, SdoRead_MoreThan124Bytes_FailsAtTheStart) {
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

TEST_P(CommandInterface, S27_SdoFailures_ShowClassNodeAndAbortCode) {
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
    s.expect_x(0x17, true).expect(1000, {0x000F, 0x0003, 2, words[0], words[1], 0}).no_tx();
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

TEST(Me3CommandInterface, S28_MultiRead) {
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

TEST(Me3CommandInterface, MultiRead_EightRecords_OfUpToEightBytes) {
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

TEST(Me3CommandInterface, S29_MultiWrite) {
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

TEST_P(CommandInterface, MultiWrite_ToOtherNodes_OfUpToEightBytes) {
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
    s.expect(1000, {0x000F, 0x0064, 0});
    s.expect(1003, Words(64, 0));
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
    s.expect(1000, command);
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
  s.expect(1000, {0x0000, 0}).no_tx();
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
}  // namespace canopus::scenario
