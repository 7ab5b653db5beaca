// The command interface's handshake, multiple SDO, abort codes [RJ71CN91 1.3, App. 1 X17, App. 2 CIF].

#include "scenarios/rj71cn91/presets.hpp"

namespace canopus::scenario::rj71cn91_command_interface_test {
namespace {

using namespace rj71cn91_presets;

TEST(Rj71Cif, Handshake_AndTheAreaStaysAsItIs) {
  RecordProperty("spec", "RJ71-CIF-001 RJ71-CIF-002");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  Words command(67, 0xA5A5);
  std::ranges::copy(Words{0x0004, 2, 0x1000, 0}, command.begin());
  s.write(1000, command).advance(1s).expect(1000, command).no_tx();  // words alone execute nothing
  s.y(0x17, true).expect(1000, 0xFFFF).expect_x(0x17, false);
  s.wait_tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0})
      .advance(100ms)
      .expect(1000, 0xFFFF)
      .expect_x(0x17, false);
  s.rx(0x582, {0x43, 0x00, 0x10, 0x00, 0x91, 0x01, 0x0F, 0x00});
  s.expect_x(0x17, true).expect(1000, {0x0005, 2, 0x1000, 0, 4, 0x0191, 0x000F});
  s.advance(10s).expect_x(0x17, true).expect(1000, 0x0005);  // as long as Y17 is ON
  s.y(0x17, false).expect_x(0x17, false).expect(1000, {0x0005, 2, 0x1000, 0, 4, 0x0191, 0x000F});
  // Nothing is cleared: the next command finds the old words, and words behind its own stay.
  s.write(1000, 0x0004).y(0x17, true).wait_tx(0x602, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x582, {0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x02, 0x06});
  s.expect_x(0x17, true).expect(1000, {0x000F, 0x0003, 2, 0x0000, 0x0602}).y(0x17, false);
  // What the program has written is there, and shown by "display current parameter".
  s.write(1066, 0x1234);
  s.cif({0x0004, 0, 0x1017, 0}).expect(1000, {0x0005, 0, 0x1017, 0, 2, 0});
  s.cif({0x0000}).expect(1000, {0x0000, 0, 0x1017, 0}).expect(1066, 0x1234);
  s.cif({0x0004}).expect(1000, {0x0005, 0, 0x1017, 0, 2, 0});
  s.advance(1h).expect(1000, {0x0005, 0, 0x1017, 0, 2, 0}).no_tx();
}

/// Every word of the interface holds A5A5H but for those of `command`, which is executed.
void execute(IntelligentScenario& s, const Words& command, Words& words) {
  words.assign(67, 0xA5A5);
  std::ranges::copy(command, words.begin());
  s.write(1000, words).y(0x17, true).wait_x(0x17, true).y(0x17, false);
}

// "The area will not be cleared after command execution."
TEST(Rj71Cif, Result_OverwritesItsWords_AndNoOther) {
  RecordProperty("spec", "RJ71-CIF-002 RJ71-CIF-004 RJ71-CIF-008 RJ71-CIF-010");
  struct Row {
    Words command;
    Words result;  // the first words
  };
  IntelligentScenario s(rj71cn91);
  s.power_on_as(1);
  const Words read_1017{0, 0x1017, 0, 0x1111, 0x2222, 0x3333, 0x4444, 0x5555};
  const Words none{0xFFFF, 0x1000, 0, 0x1111, 0x2222, 0x3333, 0x4444, 0x5555};
  const Words read_1008{1, 0x1008, 0, 0x1111, 0x2222, 0x3333, 0x4444, 0x5555};
  const Words missing{0, 0x2FFF, 1, 0x1111, 0x2222, 0x3333, 0x4444, 0x5555};
  const auto records = [](std::uint16_t code, const std::vector<Words>& parts) {
    Words words{code};
    for (const Words& part : parts) words.insert(words.end(), part.begin(), part.end());
    while (words.size() < 65) words.push_back((words.size() - 1) % 8 == 0 ? 0xFFFF : 0x7777);
    return words;
  };
  const std::vector<Row> rows{
      {{0x0004, 0, 0x1017, 0xAB00}, {0x0005, 0, 0x1017, 0, 2, 0}},
      {{0x0004, 1, 0x1001, 0}, {0x0005, 1, 0x1001, 0, 1, 0}},
      {{0x0004, 0, 0x1008, 0}, {0x0005, 0, 0x1008, 0, 8, 0x4A52, 0x3137, 0x4E43, 0x3139}},
      {{0x0002, 0, 0x1017, 0, 2, 0x0101}, {0x0003, 0, 0x1017, 0}},
      {{0x0002, 0, 0x1017, 0, 3, 0x0101}, {0x000F, 0x0003, 0, 0x0012, 0x0607}},
      {{0x0004, 0, 0x2FFF, 1}, {0x000F, 0x0003, 0, 0x0000, 0x0602}},
      {{0x0004, 200, 0x1000, 0}, {0x000F, 0x0003, 200, 0x0001, 0x0504}},
      {{0x1234, 5, 6}, {0x000F, 0x0064}},
      {{0x000A, 0xFF00, 0x0081, 0, 0}, {0x000B, 0x0000}},
      {{0xFFFF, 5, 6}, {0x0000}},
      {records(0x0008, {read_1017, none, read_1008, missing}),
       records(0x00F9, {{0, 0x1017, 0, 2, 0x0101, 0x3333, 0x4444, 0x5555},
                        none,
                        {1, 0x1008, 0, 8, 0x4A52, 0x3137, 0x4E43, 0x3139},
                        {0x0F00, 0x2FFF, 1, 0, 0x0000, 0x0602, 0x4444, 0x5555}})},
      {records(0x0006, {{0, 0x1017, 0, 2, 0x0202, 0x3333, 0x4444, 0x5555}, none, missing}),
       records(0x00F7, {{0, 0x1017, 0, 2, 0x0202, 0x3333, 0x4444, 0x5555},
                        none,
                        {0x0F00, 0x2FFF, 1, 0x1111, 0x0010, 0x0607, 0x4444, 0x5555}})},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(testing::PrintToString(row.command));
    Words words;
    execute(s, row.command, words);
    std::ranges::copy(row.result, words.begin());
    s.expect(1000, words).advance(1h).expect(1000, words).ignore_tx();
    // A write changes its word, and brings nothing back.
    s.write(1033, 0x1234);
    words[33] = 0x1234;
    s.expect(1000, words);
  }
  // Altered while it runs: the error is stored over two words, the others stay; FFFFH stores one.
  Words words(67, 0xA5A5);
  std::ranges::copy(Words{0x0004, 5, 0x1000, 0}, words.begin());
  s.write(1000, words).y(0x17, true).advance(1ms).write(1010, 7).ignore_tx();
  words[0] = 0x000F;
  words[1] = 0xFFFF;
  s.expect(1000, words).wait_x(0x17, true).expect(1000, words).y(0x17, false).ignore_tx();
  s.write(1000, 0xFFFF).y(0x17, true).wait_x(0x17, true).y(0x17, false);
  words[0] = 0x0000;
  s.expect(1000, words).no_tx();
}

TEST(Rj71Cif, ResultOfAFrame_OverwritesItsWords_AndNoOther) {
  RecordProperty("spec", "RJ71-CIF-002 RJ71-CIF-011 RJ71-L2CIF-001 RJ71-L2CIF-002 RJ71-L2CIF-003");
  IntelligentScenario s(rj71cn91);
  s.power_on_layer2(11);
  s.online();
  Words words;
  execute(s, {0x000C, 0x0123, 0, 0, 2, 0x0201}, words);
  words[0] = 0x000D;
  s.expect(1000, words).tx(0x123, {1, 2}).no_tx();
  execute(s, {0x000C, 0x0123, 1, 0, 9, 0x0201}, words);
  std::ranges::copy(Words{0xF00C, 0, 1, 0, 9}, words.begin());
  s.expect(1000, words).no_tx();
  s.controller().completes = false;
  execute(s, {0x000C, 0x0123, 0, 0, 2, 0x0201}, words);
  std::ranges::copy(Words{0x000F, 0x000F, 0x2002}, words.begin());
  s.expect(1000, words).ignore_tx();
}

TEST(Rj71Cif, MultiRead_EightRecords_AndFailuresAmongThem) {
  RecordProperty("spec", "RJ71-SDO-003 RJ71-SDO-006");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  for (const bool third_fails : {false, true}) {
    Words command{0x0008};
    const auto add = [&](const Words& record) {
      command.insert(command.end(), record.begin(), record.end());
    };
    add({0, 0x1018, 1, 9, 0xAAAA, 0xAAAA, 0xAAAA, 0xAAAA});
    add({2, 0x2000, 1, 9, 0xAAAA, 0xAAAA, 0xAAAA, 0xAAAA});
    add({126, 0x2001, 2, 9, 0xAAAA, 0xAAAA, 0xAAAA, 0xAAAA});
    for (std::uint16_t sub = 0; sub < 4; ++sub) add({0, 0x1018, sub, 0, 0, 0, 0, 0});
    add({127, 0x1017, 0, 0, 0, 0, 0, 0});
    s.write(1000, command).y(0x17, true).advance(1ms);
    s.tx(0x602, {0x40, 0x00, 0x20, 0x01, 0, 0, 0, 0}).rx(0x582, {0x41, 0x00, 0x20, 0x01, 8, 0, 0, 0});
    s.tx(0x602, {0x60, 0, 0, 0, 0, 0, 0, 0}).rx(0x582, {0x00, 1, 2, 3, 4, 5, 6, 7});
    s.tx(0x602, {0x70, 0, 0, 0, 0, 0, 0, 0}).rx(0x582, {0x1D, 8, 0, 0, 0, 0, 0, 0});
    s.expect(1000, 0xFFFF).tx(0x67E, {0x40, 0x01, 0x20, 0x02, 0, 0, 0, 0});
    if (third_fails) {
      s.rx(0x5FE, {0x80, 0x01, 0x20, 0x02, 0x30, 0x00, 0x09, 0x06});
    } else {
      s.rx(0x5FE, {0x4F, 0x01, 0x20, 0x02, 0x5A, 0, 0, 0});
    }
    s.expect_x(0x17, true).no_tx().expect(1000, third_fails ? 0x00F9 : 0x0009);
    s.expect(1001, {0, 0x1018, 1, 4, 0x01D0, 0, 0xAAAA, 0xAAAA})  // behind the data nothing is cleared
        .expect(1009, {2, 0x2000, 1, 8, 0x0201, 0x0403, 0x0605, 0x0807});
    if (third_fails) {
      s.expect(1017, {0x0F7E, 0x2001, 2, 0, 0x0030, 0x0609});
    } else {
      s.expect(1017, {126, 0x2001, 2, 1, 0x005A, 0xAAAA, 0xAAAA, 0xAAAA});
    }
    s.expect(1025, {0, 0x1018, 0, 1, 0x0003, 0, 0, 0}).expect(1033, {0, 0x1018, 1, 4, 0x01D0, 0, 0, 0});
    s.expect(1041, {0, 0x1018, 2, 4, 0x0100, 0, 0, 0}).expect(1049, {0, 0x1018, 3, 4, 0, 0x0001, 0, 0});
    s.expect(1057, {127, 0x1017, 0, 2, 0, 0, 0, 0, 0, 0}).y(0x17, false);
  }
  // Each record by itself: first and last one, all; a time-out; more than 8 bytes.
  s.cif({0x0008, 0, 0x1000, 1, 0, 0, 0, 0, 0, 0, 0x1000, 0, 0, 0, 0, 0, 0, 0, 0x3000, 0});
  s.expect(1000, {0x00F9, 0x0F00, 0x1000, 1, 0, 0x0011, 0x0609}).expect(1009, {0, 0x1000, 0, 4, 0x0195, 0});
  s.expect(1017, {0x0F00, 0x3000, 0, 0, 0x0000, 0x0602});
  s.cif({0x0008, 3, 0x1000, 0}).ignore_tx().expect(1000, {0x00F9, 0x0F03, 0x1000, 0, 0, 0x0000, 0x0504});
  s.write(1000, {0x0008, 4, 0x1008, 0})
      .y(0x17, true)
      .advance(1ms)
      .tx(0x604, {0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  s.rx(0x584, {0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0}).wait_x(0x17, true).ignore_tx();
  s.expect(1000, {0x00F9, 0x0F04, 0x1008, 0, 0, 0x0000, 0x6060}).y(0x17, false);
}

TEST(Rj71Sdo, AccessRights_ByTheCommandInterface_AndByOtherNodes) {
  RecordProperty("spec", "RJ71-SDO-013 RJ71-SDO-014");
  struct Object {
    std::uint16_t index;
    std::uint8_t sub;
    std::uint8_t length;  // 0: read
  };
  const std::vector<Object> rows{{0x1F25, 0x01, 0}, {0x1F25, 0x7F, 0}, {0x1F25, 0x80, 0}, {0x1F82, 0x80, 0},
                                 {0x1F83, 0x80, 0}, {0x1000, 0x00, 4}, {0x1001, 0x00, 1}, {0x1014, 0x00, 4},
                                 {0x102A, 0x00, 2}, {0xA100, 0x01, 2}, {0xA242, 0x04, 4}, {0x1018, 0x01, 4}};
  for (const std::uint8_t node : Bytes{1, 127}) {
    IntelligentScenario s(rj71cn91);
    s.power_on_as(node);
    for (const Object& row : rows) {
      const std::uint32_t code = row.length == 0 ? 0x06010001 : 0x06010002;
      if (row.length == 0) {
        s.cif({0x0004, 0, row.index, row.sub});
      } else {
        s.cif({0x0002, 0, row.index, row.sub, row.length, 1, 0});
      }
      s.expect_abort(code).no_tx();
      const auto low = static_cast<std::uint8_t>(row.index), high = static_cast<std::uint8_t>(row.index >> 8);
      const std::uint8_t specifier =
          row.length == 0 ? 0x40 : static_cast<std::uint8_t>(0x23 | (4 - row.length) << 2);
      s.rx(0x600U + node,
           {specifier, low, high, row.sub, static_cast<std::uint8_t>(row.length != 0), 0, 0, 0});
      s.tx(0x580U + node,
           {0x80, low, high, row.sub, static_cast<std::uint8_t>(row.length == 0 ? 1 : 2), 0, 0x01, 0x06});
    }
  }
}

TEST(Rj71Sdo, ValuesOutOfRange) {
  RecordProperty("spec", "RJ71-SDO-017");
  IntelligentScenario s(rj71cn91);
  s.power_on();
  // Of its own objects: an invalid value.
  for (const auto& [index, sub, length, value] :
       std::vector<std::tuple<std::uint16_t, std::uint16_t, std::uint16_t, std::uint16_t>>{
           {0x1029, 1, 1, 3},
           {0x1F90, 3, 2, 3},
           {0x1F81, 5, 4, 0x0002},
           {0x1F80, 0, 4, 0x0080},
           {0x1003, 0, 1, 1},
           {0x1804, 2, 1, 0xF1},
           {0x1404, 2, 1, 0xFD}}) {
    s.cif({0x0002, 0, index, sub, length, value, 0});
    s.expect_abort(0x06090030).no_tx();
  }
  // Those of other nodes come as they are.
  for (const std::uint32_t code : {0x06090030U, 0x06090031U, 0x06090032U}) {
    s.write(1000, {0x0002, 5, 0x6000, 1, 2, 0xFFFF})
        .y(0x17, true)
        .wait_tx(0x605, {0x2B, 0x00, 0x60, 0x01, 0xFF, 0xFF, 0, 0});
    Bytes answer{0x80, 0x00, 0x60, 0x01};
    for (const std::uint8_t byte : canopen::little_endian(code, 4)) answer.push_back(byte);
    s.rx(0x585, answer).expect_x(0x17, true).y(0x17, false);
    s.expect_abort(code, 5).no_tx();
  }
}

}  // namespace
}  // namespace canopus::scenario::rj71cn91_command_interface_test
