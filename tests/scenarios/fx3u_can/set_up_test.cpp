// Commands that set up nodes and PDOs [FX3U-CAN 7.2, 10.3, 10.4, 10.6, 10.7].

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::fx3u_can_set_up_test {
namespace {

/// A node answers the write of an SDO: index and sub-index of the request.
void accept(BlockScenario& s, std::uint8_t node, const Bytes& request, Where where = Where::current()) {
  s.tx(0x600U + node, request, where);
  s.rx(0x580U + node, {0x60, request[1], request[2], request[3], 0, 0, 0, 0});
}
/// It aborts.
void refuse(BlockScenario& s, std::uint8_t node, const Bytes& request, std::uint32_t code,
            Where where = Where::current()) {
  s.tx(0x600U + node, request, where);
  Bytes answer{0x80, request[1], request[2], request[3], 0, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) answer[4 + i] = static_cast<std::uint8_t>(code >> (8 * i));
  s.rx(0x580U + node, answer);
}
/// It is asked for a COB-ID, and says this.
void set_cob_id(BlockScenario& s, std::uint8_t node, std::uint16_t index, std::uint32_t cob_id,
                Where where = Where::current()) {
  const auto low = static_cast<std::uint8_t>(index & 0xFF), high = static_cast<std::uint8_t>(index >> 8);
  s.tx(0x600U + node, {0x40, low, high, 1, 0, 0, 0, 0}, where);
  Bytes answer{0x43, low, high, 1, 0, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) answer[4 + i] = static_cast<std::uint8_t>(cob_id >> (8 * i));
  s.rx(0x580U + node, answer);
}

/// Something else than the factory's in PDOs 1, 5 and 80, and in the data words.
void disturb(BlockScenario& s) {
  s.set_object(0x1400, 1, 0x8000'0000, 4).set_object(0x1600, 0, 0, 1).set_object(0x1600, 1, 0xA4C0'0108, 4);
  s.set_object(0x1600, 0, 1, 1).set_object(0x1400, 2, 1, 1).set_object(0x1400, 1, 0x123 + 0x100, 4);
  s.set_object(0x1804, 3, 100, 2).set_object(0x1804, 1, 0x4000'0345, 4);
  s.set_object(0x184F, 5, 1000, 2).set_object(0x184F, 1, 0x4000'0346, 4);
  s.set_object(0x144F, 1, 0x347, 4);
  s.nmt(1)
      .rx(0x347, {1, 2, 3, 4, 5, 6, 7, 8})
      .write(11000, {1, 2, 3})
      .write(11319, 9)
      .exchange()
      .nmt(0x80)
      .ignore_tx();
  s.expect(10316, 0x0201);
}
void expect_factory_but_cob_ids(BlockScenario& s, Where where = Where::current()) {
  for (const std::uint16_t number : Words{0, 4, 79}) {
    const auto at = [number](unsigned first) { return static_cast<std::uint16_t>(first + number); };
    for (const unsigned communication : {0x1400U, 0x1800U}) {
      s.expect_object(at(communication), 2, 0xFE, 1, where);
      s.expect_object(at(communication), 3, 0, 2, where);
      s.expect_object(at(communication), 5, 0, 2, where);
    }
    const std::uint32_t place = number / 30U << 16 | (4U * number % 120 + 1) << 8 | 16;
    s.expect_object(at(0x1600), 0, 4, 1, where).expect_object(at(0x1600), 1, 0xA580'0000 + place, 4, where);
    s.expect_object(at(0x1A00), 0, 4, 1, where).expect_object(at(0x1A00), 1, 0xA100'0000 + place, 4, where);
  }
  s.expect(10000, Words(320, 0), where).expect(11000, Words(320, 0), where);
}
void expect_factory_tpdos(BlockScenario& s, std::uint32_t node, Where where = Where::current()) {
  for (std::uint32_t i = 0; i < 80; ++i) {
    s.expect_object(static_cast<std::uint16_t>(0x1800 + i), 1,
                    i < 4 ? 0x4000'0180 + 0x100 * i + node : 0xC000'0000, 4, where);
  }
}

// S100
TEST(FxMapping, Mode0_IsTheFactorys) {
  RecordProperty("spec", "FX3U-M0-001 FX3U-M0-002");
  BlockScenario s;
  s.power_on();
  disturb(s);
  s.cif({0x8900}).expect(1000, 0x8901).no_tx();
  expect_factory_but_cob_ids(s);
  expect_factory_tpdos(s, 127);
  for (std::uint32_t i = 0; i < 80; ++i) {
    s.expect_object(static_cast<std::uint16_t>(0x1400 + i), 1, i < 4 ? 0x200 + 0x100 * i + 127 : 0x8000'0000,
                    4);
  }
}

// S101
TEST(FxMapping, ModeA_ReceivesTheFirstFourPdosOfNodes1To8) {
  RecordProperty("spec", "FX3U-MA-001 FX3U-MA-002 FX3U-MA-003");
  BlockScenario s;
  s.power_on_as(2).ignore_tx();
  s.set_object(0x1804, 1, 0x4000'0345, 4).nmt(1).write(11000, 5).exchange().nmt(0x80).ignore_tx();
  s.cif({0x8200}).expect(1000, 0x8201).no_tx();
  expect_factory_but_cob_ids(s);
  expect_factory_tpdos(s, 2);
  for (std::uint32_t i = 0; i < 80; ++i) {
    s.expect_object(static_cast<std::uint16_t>(0x1400 + i), 1,
                    i < 32 ? 0x180 + 0x100 * (i % 4) + i / 4 + 1 : 0x8000'0000, 4);
  }
  // Node 3's third PDO is at words 40 to 43; the own block stays as it is.
  s.nmt(1)
      .rx(0x383, {1, 0, 2, 0, 3, 0, 4, 0})
      .write(11000, 7)
      .exchange()
      .expect(10040, {1, 2, 3, 4})
      .expect(10016, Words(16, 0));
  s.tx(0x182, {7, 0, 0, 0, 0, 0, 0, 0});
  BlockScenario other;
  other.power_on_as(9).ignore_tx();
  other.cif({0x8200}).expect(1000, 0x82FF).expect_object(0x1404, 1, 0x8000'0000, 4);
}

// S102
TEST(FxMapping, ModeB_Reset_DisablesAllRpdos) {
  RecordProperty("spec", "FX3U-MB-001");
  BlockScenario s;
  s.power_on();
  disturb(s);
  s.cif({0x8300, 0, 0, 0xFFFF}).expect(1000, {0x8301, 0, 0, 0}).no_tx();
  expect_factory_but_cob_ids(s);
  expect_factory_tpdos(s, 127);
  for (std::uint32_t i = 0; i < 80; ++i)
    s.expect_object(static_cast<std::uint16_t>(0x1400 + i), 1, 0x8000'0000, 4);
}

// S103
TEST(FxMapping, ModeB_Binds_TwoRemoteNodes) {
  RecordProperty("spec", "FX3U-MB-002 FX3U-MB-004");
  BlockScenario s;
  s.power_on().cif({0x8300, 0x1009, 0x0203, 0xFFFF}).expect(1000, 0xFFFF);
  set_cob_id(s, 0x10, 0x1808, 0x4000'0390);
  set_cob_id(s, 2, 0x1402, 0x402);
  accept(s, 2, {0x23, 0x02, 0x14, 1, 0x90, 0x03, 0, 0x80});  // off first: it was valid
  accept(s, 2, {0x23, 0x02, 0x14, 1, 0x90, 0x03, 0, 0x00});
  s.no_tx().expect(1000, {0x8301, 0, 0, 0});
}

TEST(FxMapping, ModeB_BindsTheLocalNode_InBothRoles) {
  RecordProperty("spec", "FX3U-MB-002 FX3U-MB-003 FX3U-MB-008");
  for (const std::uint16_t own : Words{0, 127}) {
    BlockScenario s;
    s.power_on().cif({0x8300, 0x0301, static_cast<std::uint16_t>(own << 8 | 6), 0xFFFF});
    set_cob_id(s, 3, 0x1800, 0x183);
    s.no_tx().expect(1000, {0x8301, 0, 0});  // it was disabled: no warning of the local node
    s.expect_object(0x1405, 1, 0x183, 4);
    s.cif({0x8300, static_cast<std::uint16_t>(own << 8 | 1), 0x0501, 0xFFFF});
    set_cob_id(s, 5, 0x1400, 0x8000'0000);
    accept(s, 5, {0x23, 0x00, 0x14, 1, 0xFF, 0x01, 0, 0});
    s.expect(1000, {0x83FF, 0, 0x0001});  // the destination was disabled: bound, with a warning
  }
}

// S104
TEST(FxMapping, ModeB_GivesTheLocalNodeFurtherTpdos) {
  RecordProperty("spec", "FX3U-MB-005 FX3U-MB-006");
  BlockScenario s;
  s.power_on_as(5).ignore_tx();
  s.cif({0x8300, 0x7F01, 0x8005, 0x0304, 0x8050, 0xFFFF, 0xFFFF}).expect(1000, {0x8301, 0, 0, 0, 0}).no_tx();
  s.expect_object(0x1804, 1, 0x4000'01FF, 4).expect_object(0x184F, 1, 0x4000'0483, 4);
  // All three in one call.
  s.cif({0x8300, 0, 0, 0x0601, 0x0001, 0x0702, 0x8006, 0xFFFF});
  set_cob_id(s, 6, 0x1800, 0x186);
  s.expect(1000, {0x8301, 0, 0, 0, 0, 0, 0});
  s.expect_object(0x1804, 1, 0xC000'0000, 4)
      .expect_object(0x1805, 1, 0x4000'0287, 4)
      .expect_object(0x1400, 1, 0x186, 4);
  // The local node as source, TPDO 5 of a source, TPDO 4 and 81 of the local node.
  s.cif({0x8300, 0x0501, 0x8006, 0x0305, 0x8006, 0x0301, 0x8004, 0x0301, 0x8051, 0x8101, 0x8007, 0xFFFF});
  s.expect(1000, {0x83FF, 0x0501, 0xFFFF, 0x0305, 0xFFFF, 0, 0x8004, 0, 0x8051, 0x8101, 0xFFFF}).no_tx();
}

// S105
TEST(FxMapping, ModeB_SaysWhichParameterIsWrong) {
  RecordProperty("spec", "FX3U-MB-007 FX3U-MB-008");
  BlockScenario s;
  s.power_on().cif({0x8300, 0x0301, 0x0001, 0xFFFF}).tx(0x603, {0x40, 0, 0x18, 1, 0, 0, 0, 0});
  s.advance(500ms).expect(1000, {0x83FF, 0x0300, 0xFFFF}).ignore_tx();
  // A silent destination, a disabled source, a node 128, a PDO 0; what comes after is carried out.
  s.cif({0x8300, 0x0001, 0x0402, 0x0205, 0x0001, 0x8001, 0x0001, 0x0300, 0x0001, 0x0001, 0x8101, 0x0102,
         0x0005, 0xFFFF});
  s.tx(0x604, {0x40, 0x01, 0x14, 1, 0, 0, 0, 0}).advance(500ms);
  while (s.read(1000) == 0xFFFF) {
    s.ignore_tx();
    s.rx(0x582, {0x43, 0x04, 0x18, 1, 0, 0, 0, 0x80})
        .rx(0x581, {0x43, 0x01, 0x18, 1, 0x81, 2, 0, 0x40})
        .advance(10ms);
  }
  s.expect(1000, {0x83FF, 0, 0x0400, 0x0005, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0, 0xFFFF, 0, 0})
      .ignore_tx();
  s.expect_object(0x1404, 1, 0x281, 4);
  // A source and a destination without that PDO.
  s.cif({0x8300, 0x0609, 0x0001, 0x0001, 0x0709, 0xFFFF});
  refuse(s, 6, {0x40, 0x08, 0x18, 1, 0, 0, 0, 0}, 0x0602'0000);
  refuse(s, 7, {0x40, 0x08, 0x14, 1, 0, 0, 0, 0}, 0x0602'0000);
  s.expect(1000, {0x83FF, 0x0609, 0xFFFF, 0, 0x0709});
}

TEST(FxMapping, ModeB_TakesThirtyThreePairs) {
  RecordProperty("spec", "FX3U-MB-002");
  BlockScenario s;
  s.power_on();
  Words command{0x8300};
  for (std::uint16_t i = 0; i < 33; ++i) {
    command.push_back(static_cast<std::uint16_t>(0x0001 + i % 4));
    command.push_back(static_cast<std::uint16_t>(5 + i));
  }
  s.cif(command).expect(1000, 0x8301).expect(1001, Words(66, 0)).expect_object(0x1404 + 32, 1, 0x1FF, 4);
}

// S117
TEST(FxSetUp, HeartbeatProducing_OfManyNodes) {
  RecordProperty("spec", "FX3U-HB-006");
  BlockScenario s;
  s.power_on().cif({0x7410, 5, 1000, 0, 300, 127, 301, 0xFFFF}).expect(1000, 0xFFFF);
  accept(s, 5, {0x2B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0});
  s.expect(1000, {0x7411, 0, 0, 0, 0, 0, 0, 0}).expect_object(0x1017, 0, 301, 2).ignore_tx();
  // A node that refuses, one that is silent, a number that is none.
  s.set_object(0x1017, 0, 0, 2).cif({0x7410, 6, 10, 7, 20, 128, 30, 0, 0, 0xFFFF});
  refuse(s, 6, {0x2B, 0x17, 0x10, 0, 10, 0, 0, 0}, 0x0609'0030);
  s.tx(0x607, {0x2B, 0x17, 0x10, 0, 20, 0, 0, 0}).advance(500ms);
  s.expect(1000, {0x741F, 0, 0xFFFF, 0xFFFF, 0, 0xFFFF, 0, 0, 0});
  Words all{0x7410};
  for (int i = 0; i < 33; ++i) all.insert(all.end(), {0, static_cast<std::uint16_t>(2000 + i)});
  s.ignore_tx().cif(all).expect(1000, 0x7411).expect_object(0x1017, 0, 2032, 2);
}

TEST(FxSetUp, HeartbeatConsuming_OfOneNode) {
  RecordProperty("spec", "FX3U-HB-007");
  BlockScenario s;
  s.power_on().cif({0x7400, 3, 5, 1500, 6, 1600, 0xFFFF});
  accept(s, 3, {0x23, 0x16, 0x10, 1, 0xDC, 0x05, 5, 0});
  accept(s, 3, {0x23, 0x16, 0x10, 2, 0x40, 0x06, 6, 0});
  s.expect(1000, {0x7401, 0, 0, 0, 0, 0}).no_tx();
  Words all{0x7400, 0};
  for (std::uint16_t i = 1; i <= 32; ++i) all.insert(all.end(), {i, static_cast<std::uint16_t>(100 * i)});
  s.cif(all)
      .expect(1000, 0x7401)
      .expect_object(0x1016, 1, 0x0001'0064, 4)
      .expect_object(0x1016, 32, 0x0020'0C80, 4);
  s.cif({0x7400, 128, 5, 1500, 0xFFFF}).expect(1000, {0x740F, 0xFFFF, 0, 0});
  s.cif({0x7400, 0, 128, 100, 0xFFFF}).expect(1000, {0x740F, 0, 0xFFFF, 0});
  s.cif({0x7400, 9, 5, 1500, 6, 1600, 0xFFFF})
      .tx(0x609, {0x23, 0x16, 0x10, 1, 0xDC, 0x05, 5, 0})
      .advance(500ms)
      .ignore_tx();
  s.expect(1000, {0x740F, 0xFFFF, 0, 0, 0, 0}).no_tx();
  s.cif({0x7400, 9, 5, 1500, 6, 1600, 0xFFFF});
  refuse(s, 9, {0x23, 0x16, 0x10, 1, 0xDC, 0x05, 5, 0}, 0x0604'0043);
  accept(s, 9, {0x23, 0x16, 0x10, 2, 0x40, 0x06, 6, 0});
  s.expect(1000, {0x740F, 0, 0, 0xFFFF, 0, 0});
}

// S118
TEST(FxSetUp, SlaveAssignment_AndGuarding) {
  RecordProperty("spec", "FX3U-BOOT-019 FX3U-BOOT-013");
  BlockScenario s;
  s.power_on().cif({0x8400, 3, 1, 200, 3, 0xFFFF}).expect(1000, {0x000F, 0x0F0F}).no_tx();
  s.set_object(0x1F80, 0, 1, 4).cif({0x8400, 3, 1, 200, 3, 0xFFFF});
  accept(s, 3, {0x2B, 0x0C, 0x10, 0, 0xC8, 0, 0, 0});
  accept(s, 3, {0x2F, 0x0D, 0x10, 0, 3, 0, 0, 0});
  s.expect(1000, {0x8401, 0, 0, 0, 0}).expect_object(0x1F81, 3, 0x00C8'0301, 4).no_tx();
  // A number that is none, a retry factor above 255, bits that do not exist.
  s.cif({0x8400, 200, 1, 100, 3, 4, 1, 100, 256, 5, 0x22, 100, 3, 0xFFFF});
  s.expect(1000, {0x84FF, 200, 0, 0, 0, 0, 0, 0, 256, 0, 0xFFFF, 0, 0}).no_tx();
  s.expect_object(0x1F81, 4, 0, 4).expect_object(0x1F81, 5, 0, 4);
  // A slave without guarding, one that is silent.
  s.cif({0x8400, 6, 5, 100, 3, 7, 5, 100, 3, 0xFFFF});
  refuse(s, 6, {0x2B, 0x0C, 0x10, 0, 100, 0, 0, 0}, 0x0602'0000);
  s.tx(0x607, {0x2B, 0x0C, 0x10, 0, 100, 0, 0, 0}).advance(500ms);
  s.expect(1000, {0x84FF, 6, 5, 100, 3, 0, 0, 0xFFFF, 0})
      .expect_object(0x1F81, 6, 0x0064'0305, 4)
      .ignore_tx();
}

// S150, S151
TEST(FxSetUp, StoreAndRestore_OfManyNodes) {
  RecordProperty("spec", "FX3U-STO-001 FX3U-STO-004 FX3U-STO-006 FX3U-STO-007 FX3U-OD-004");
  BlockScenario s;
  s.power_on().set_object(0x1017, 0, 200, 2).cif({0x6000, 0, 5, 0xFFFF}).ignore_tx();
  s.rx(0x585, {0x60, 0x10, 0x10, 1, 0, 0, 0, 0})
      .expect(1000, {0x6001, 0, 0, 0})
      .restart()
      .expect_object(0x1017, 0, 200, 2);
  s.cif({0x6010, 127, 0xFFFF}).expect(1000, {0x6011, 0}).expect_object(0x1017, 0, 200, 2).restart();
  s.expect_object(0x1017, 0, 0, 2);
  // Stored between: the old settings are back.
  s.set_object(0x1017, 0, 200, 2).store_objects().cif({0x6010, 0, 0xFFFF}).expect(1000, 0x6011);
  s.store_objects().restart().expect_object(0x1017, 0, 200, 2).set_object(0x1017, 0, 0, 2).ignore_tx();
  s.cif({0x6010, 6, 7, 128, 0xFFFF});
  refuse(s, 6, {0x23, 0x11, 0x10, 1, 'l', 'o', 'a', 'd'}, 0x0800'0020);
  s.tx(0x607, {0x23, 0x11, 0x10, 1, 'l', 'o', 'a', 'd'})
      .advance(500ms)
      .expect(1000, {0x601F, 0xFFFF, 0xFFFF, 0xFFFF, 0});
  s.ignore_tx().cif({0x6000, 8, 0xFFFF}).tx(0x608, {0x23, 0x10, 0x10, 1, 's', 'a', 'v', 'e'}).advance(500ms);
  s.expect(1000, {0x600F, 0xFFFF}).ignore_tx();
  s.cif({0x6000, 0xFFFF}).expect(1000, {0x600F, 0xFFFF});
}

TEST(FxSetUp, InTheWrongState_NothingIsSent) {
  RecordProperty("spec", "FX3U-CIF-008");
  BlockScenario s;
  s.power_on().nmt(2).cif({0x7410, 5, 1000, 0xFFFF}).expect(1000, {0x000F, 0x0F0F}).no_tx();
  s.cif({0x7410, 0, 0, 0xFFFF}).expect(1000, 0x7411);
  s.cif({0x8300, 0x0301, 0x0001, 0xFFFF}).expect(1000, {0x000F, 0x0F0F}).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_set_up_test
