// Virtual input and output mapping in CANopen 417 mode [FX3U-CAN 5.10.1 to 5.10.3, 8.3].

#include "scenarios/fx3u_can/lift_scenario.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario::fx3u_can_call_controller_test {
namespace {

// T417-10
TEST(FxCallController, InputOfAPanel_ComesWithTheExchange) {
  RecordProperty("spec", "FX3U-VIN-001 FX3U-VIN-003");
  for (std::uint32_t panel = 1; panel <= 64; ++panel) {
    BlockScenario s;
    start_lift_operational(s, 1, 100);
    s.rx(0x480 + panel, {2, 1, 1, 3, 1, 1}).expect(12001, {0, 0, 0, 1});
    s.exchange(0x0200).expect(12001, {0x0102, 0x0301, 0x0101, 0}).expect(3001, {0x0102, 0x0301, 0x0101, 0});
    s.no_tx().expect(29, 0);
  }
}

// T417-11, T417-18
TEST(FxCallController, Inputs_ComeInTheirOrder_OneAnExchange) {
  RecordProperty("spec", "FX3U-VIN-006 FX3U-VIN-007 FX3U-VIN-008 FX3U-VIN-009");
  for (const std::uint16_t bits : Words{0x0200, 0x0001}) {
    BlockScenario s;
    start_lift_operational(s);
    s.rx(0x485, {2, 1, 1, 3, 1, 1}).rx(0x486, {5, 7, 1, 0, 1, 1}).rx(0x485, {2, 1, 1, 3, 1, 0});
    s.expect(12004, 3).expect(3004, 3).expect(12001, {0, 0, 0});
    // An SDO neither sees nor takes them.
    s.cif({0x0004, 0, 0x6010, 0}).expect(1004, {6, 0, 0, 0}).expect(12004, 3);
    s.cif({0x0002, 0, 0x6010, 0, 6, 0x0102, 0x0301, 0x0101}).expect(1000, 0x0003).expect(12004, 3);
    s.exchange(bits).expect(12001, {0x0102, 0x0301, 0x0101, 2});
    s.exchange(bits).expect(12001, {0x0705, 0x0001, 0x0101, 1});
    s.exchange(bits).expect(12001, {0x0102, 0x0301, 0x0001, 0});
    s.exchange(bits).expect(12001, {0, 0, 0, 0}).expect(3001, {0, 0, 0, 0}).no_tx();
  }
}

// T417-12
TEST(FxCallController, RingOf252Messages_TheOldestGivesWay) {
  RecordProperty("spec", "FX3U-VIN-004 FX3U-VIN-005");
  for (const unsigned more : {0U, 1U, 2U, 252U, 300U}) {
    BlockScenario s;
    start_lift_operational(s);
    const auto call = [&s](unsigned number) {
      s.rx(0x481, {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8), 1, 0, 1, 1});
    };
    for (unsigned number = 1; number <= 252 + more; ++number) call(number);
    s.expect(12004, 252).expect(29, 0);
    for (unsigned number = more + 1; number <= 252 + more; ++number) {
      s.exchange(0x0200).expect(12001, static_cast<std::uint16_t>(number));
      s.expect(12004, static_cast<std::uint16_t>(252 + more - number));
    }
    s.exchange(0x0200).expect(12001, {0, 0, 0, 0});
    // A restart forgets what waits.
    call(1);
    s.restart().expect(12004, 0).ignore_tx();
  }
}

// T417-14
TEST(FxCallController, Panels65To127_AreNotHeard) {
  RecordProperty("spec", "FX3U-VIN-002");
  BlockScenario s;
  start_lift_operational(s);
  for (std::uint32_t panel = 65; panel <= 127; ++panel) s.rx(0x480 + panel, {1, 2, 1, 0, 1, 1});
  s.expect(12004, 0).rx(0x4C0, {1, 1, 1, 0, 1, 1}).expect(12004, 1).exchange(0x0200).expect(12001, 0x0101);
}

// T417-15: what a message says is the program's to read.
TEST(FxCallController, DoorByte_InputState_AndEveryCode_ComeAsTheyAre) {
  RecordProperty("spec", "FX3U-VIN-011 FX3U-VIN-012 FX3U-VIN-013");
  BlockScenario s;
  start_lift_operational(s, 0xFF);
  s.rx(0x481, {8, 9, 1, 2, 0x21, 1}).exchange(0x0200).expect(12003, 0x0121);
  s.rx(0x481, {0x0E, 9, 1, 0, 1, 2}).exchange(0x0200).expect(12003, 0x0201);
  s.rx(0x481, {0x0E, 5, 1, 0, 1, 0x81}).exchange(0x0200).expect(12003, 0x8101);
  for (unsigned value = 0; value <= 0xFF; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    const auto word = static_cast<std::uint16_t>(value);
    const auto high = static_cast<std::uint16_t>(value << 8);
    s.rx(0x481, {byte, 0, 0x80, 0, 0, 0}).exchange(0x0200).expect(12001, {word, 0x0080, 0});
    s.rx(0x481, {0, byte, 0x80, 0, 0, 0}).exchange(0x0200).expect(12001, {high, 0x0080, 0});
    s.rx(0x481, {0, 0, 0x80, byte, 0, 0}).exchange(0x0200);
    s.expect(12001, {0, static_cast<std::uint16_t>(high | 0x80), 0});
    s.rx(0x481, {0, 0, 0x80, 0, byte, 0}).exchange(0x0200).expect(12001, {0, 0x0080, word});
    s.rx(0x481, {0, 0, 0x80, 0, 0, byte}).exchange(0x0200).expect(12001, {0, 0x0080, high});
  }
  s.no_tx().expect(29, 0);
}

// T417-20
TEST(FxCallController, InputsOfOtherLifts_AreNotKept) {
  RecordProperty("spec", "FX3U-VIN-010");
  BlockScenario s;
  start_lift_operational(s);
  s.rx(0x485, {2, 1, 2, 3, 1, 1})
      .rx(0x485, {2, 1, 0, 3, 1, 1})
      .rx(0x485, {2, 1, 0xFE, 3, 1, 1})
      .expect(12004, 0);
  s.write(13000, 2).rx(0x485, {2, 1, 2, 3, 1, 1}).rx(0x485, {2, 1, 3, 3, 1, 1}).rx(0x485, {2, 1, 1, 3, 1, 1});
  s.expect(12004, 2).exchange(0x0200).expect(12002, 0x0302).exchange(0x0200).expect(12002, 0x0303);
}

// T417-16
TEST(FxCallController, Output_IsSentWhenItChanges) {
  RecordProperty("spec", "FX3U-VOUT-001 FX3U-VOUT-002 FX3U-VOUT-003 FX3U-VOUT-004 FX3U-VOUT-005");
  BlockScenario s;
  start_lift_operational(s);
  s.expect_object(0x1900, 1, 0x40000400, 4);
  s.write(13001, {0x0102, 0x0301, 0x8101}).no_tx().exchange().tx(0x400, {2, 1, 1, 3, 1, 0x81}).no_tx();
  s.expect(13001, {0x0102, 0x0301, 0x8101}).expect(3001, {0, 0, 0});
  s.exchange().no_tx();
  s.write(13003, 0x0101).exchange().tx(0x400, {2, 1, 1, 3, 1, 1}).no_tx();
  s.write(3001, {0x0540, 0xFF01, 0x010F}).expect(13001, {0x0540, 0xFF01, 0x010F});
  s.cif({0x0004, 0, 0x6011, 0}).expect(1004, {6, 0x0102, 0x0301, 0x0101});  // as it was exchanged
  s.exchange().tx(0x400, {0x40, 5, 1, 0xFF, 0x0F, 1}).no_tx();
  s.cif({0x0004, 0, 0x6011, 0}).expect(1004, {6, 0x0540, 0xFF01, 0x010F});
  s.cif({0x0002, 0, 0x6011, 0, 6, 1, 2, 3}).expect_abort(0x06010002).no_tx();
  // Two are two exchanges: the first is gone when it was overwritten before one.
  s.write(13001, 0x0111).write(13001, 0x0112).exchange().tx(0x400, {0x12, 1, 1, 0xFF, 0x0F, 1}).no_tx();
}

// T417-17
TEST(FxCallController, TypicalOutputs) {
  RecordProperty("spec", "FX3U-VOUT-006 FX3U-VOUT-007 FX3U-VOUT-008 FX3U-VOUT-009 FX3U-VOUT-010");
  struct Row {
    Words words;
    Bytes frame;
  };
  BlockScenario s;
  start_lift_operational(s);
  for (const Row& row : std::vector<Row>{
           {{0x0100, 0xFF01, 0x010F},
            {0x00, 0x01, 0x01, 0xFF, 0x0F, 0x01}},  // all active hall calls, all floors
           {{0x0200, 0xFF01, 0x010F}, {0x00, 0x02, 0x01, 0xFF, 0x0F, 0x01}},  // all special inputs
           {{0x0141, 0x0301, 0x0101}, {0x41, 0x01, 0x01, 0x03, 0x01, 0x01}},  // hall lantern up, floor 3
           {{0x2242, 0x0001, 0x0101}, {0x42, 0x22, 0x01, 0x00, 0x01, 0x01}},  // moving down, arrow down, car
           {{0x0343, 0x0001, 0x5701}, {0x43, 0x03, 0x01, 0x00, 0x01, 0x57}},  // overload sign, flashing 1 Hz
           {{0xFF47, 0x0001, 0x0101}, {0x47, 0xFF, 0x01, 0x00, 0x01, 0x01}},  // announce the floor
           {{0x024A, 0xFF01, 0x010F}, {0x4A, 0x02, 0x01, 0xFF, 0x0F, 0x01}},  // lift operational
           {{0x0040, 0x0001, 0x0001}, {0x40, 0x00, 0x01, 0x00, 0x01, 0x00}},  // position cleared
           {{0xFE40, 0xFE01, 0x0001}, {0x40, 0xFE, 0x01, 0xFE, 0x01, 0x00}},  // position: floor 254
           {{0x0344, 0x0101, 0x0101}, {0x44, 0x03, 0x01, 0x01, 0x01, 0x01}},  // both arrows
           {{0x1142, 0x0101, 0x0101}, {0x42, 0x11, 0x01, 0x01, 0x01, 0x01}},  // arrow up, moving up
       }) {
    s.write(13001, row.words).exchange().tx(0x400, row.frame).no_tx();
  }
  // Property in bits 1 to 3, its parameter in bits 4 to 6: flashing at 1 Hz is 3 and 5.
  for (std::uint16_t property = 0; property < 8; ++property) {
    for (std::uint16_t parameter = 0; parameter < 8; ++parameter) {
      const auto data = static_cast<std::uint8_t>(1U | property << 1U | parameter << 4U);
      s.write(13001, {0x0143, 0x0001, static_cast<std::uint16_t>(data << 8U | 1U)}).exchange();
      s.tx(0x400, {0x43, 0x01, 0x01, 0x00, 0x01, data});
    }
  }
  s.no_tx().expect(29, 0);
}

// Every code of the manual's tables, and those it reserves, both ways.
TEST(FxCallController, EveryCode_GoesThrough) {
  RecordProperty("spec", "FX3U-VIN-013 FX3U-VOUT-011");
  BlockScenario s;
  start_lift_operational(s);
  std::vector<std::pair<std::uint8_t, std::uint8_t>> codes;  // basic function, sub-function
  const auto number = [](const std::string& text) {
    return static_cast<std::uint8_t>(std::stoul(text.substr(0, 4), nullptr, 16));
  };
  unsigned rows = 0;
  for (const SpecRow& row : spec_rows("fx3u-can", "lift-codes.csv")) {
    const std::string& field = row["field"];
    if (!row["value"].starts_with("0x")) continue;
    if (field == "vin.basic" || field == "vout.basic") {
      codes.emplace_back(number(row["value"]), std::uint8_t{1});
    } else if (field.starts_with("vin.sub[") || field.starts_with("vout.sub[")) {
      const std::size_t bracket = field.find('[') + 1;
      codes.emplace_back(number(field.substr(bracket)), number(row["value"]));
    } else {
      continue;
    }
    ++rows;
  }
  EXPECT_GT(rows, 150U);
  std::pair<std::uint8_t, std::uint8_t> sent{0, 0};
  for (const auto& [basic, sub] : codes) {
    const auto word = static_cast<std::uint16_t>(sub << 8 | basic);
    s.rx(0x485, {basic, sub, 1, 3, 1, 1}).exchange(0x0200).expect(12001, {word, 0x0301, 0x0101});
    s.write(13001, {word, 0x0301, 0x0101}).exchange(0x0100);
    if (sent != std::pair(basic, sub)) s.tx(0x400, {basic, sub, 1, 3, 1, 1});
    s.no_tx();
    sent = {basic, sub};
  }
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_call_controller_test
