// PDO mapping modes [FX2N-32CAN 7].

#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario::fx2n_32can_mapping_test {
namespace {

using CobIdOf = std::uint32_t (*)(std::uint32_t n, std::uint32_t node);  // of PDO n, from 1 on

constexpr std::uint32_t off = 0x8000'0000;

void expect_rpdos(Fx2nScenario& s, CobIdOf cob_id, std::uint32_t node, Where where = Where::current()) {
  for (std::uint32_t n = 1; n <= 30; ++n)
    s.expect_object(static_cast<std::uint16_t>(0x13FF + n), 1, cob_id(n, node), 4, where);
}
void expect_tpdos(Fx2nScenario& s, std::uint32_t active, std::uint32_t node, Where where = Where::current()) {
  for (std::uint32_t n = 1; n <= 30; ++n)
    s.expect_object(static_cast<std::uint16_t>(0x17FF + n), 1, n <= active ? 0x80 + 0x100 * n + node : off, 4,
                    where);
}
void expect_mapped_words(Fx2nScenario& s, Where where = Where::current()) {
  for (std::uint32_t n = 1; n <= 30; ++n) {
    for (std::uint32_t k = 1; k <= 4; ++k) {
      const std::uint32_t sub = (4 * (n - 1) + k) << 8;
      s.expect_object(static_cast<std::uint16_t>(0x15FF + n), static_cast<std::uint8_t>(k), 0xA580'0010 + sub,
                      4, where);
      s.expect_object(static_cast<std::uint16_t>(0x19FF + n), static_cast<std::uint8_t>(k), 0xA100'0010 + sub,
                      4, where);
    }
  }
}

// S-60, S-61
TEST(Fx2nMapping, TheFactorys_AndMode0) {
  RecordProperty("spec", "FX2N-MAP-001 FX2N-MAP0-001 FX2N-MAP0-002 FX2N-MAP0-003 FX2N-MAP-006 FX2N-MAP-005");
  Fx2nScenario s;
  s.start(10);
  expect_tpdos(s, 2, 10);
  expect_rpdos(
      s, [](std::uint32_t n, std::uint32_t node) { return n <= 2 ? 0x100 + 0x100 * n + node : off; }, 10);
  expect_mapped_words(s);
  s.set_object(0x1A04, 0, 0, 1)
      .set_object(0x1804, 2, 1, 1)
      .set_object(0x1804, 1, 0x333, 4)
      .set_object(0x1404, 1, 0x334, 4);
  // In Operational, too: that it should be Pre-operational is advice.
  s.nmt(1).ignore_tx().cif({0x8900, 7, 7}).expect(1000, {0x8901, 0, 0}).no_tx().nmt(0x80);
  expect_tpdos(s, 4, 10);
  expect_rpdos(
      s, [](std::uint32_t n, std::uint32_t node) { return n <= 4 ? 0x100 + 0x100 * n + node : off; }, 10);
  expect_mapped_words(s);
  // #0 to #15 are used both ways, the others are not.
  s.nmt(1)
      .write(15, 1)
      .write(16, 2)
      .write(100, 3)
      .write(199, 4)
      .write(20, 1)
      .tx(0x48A, {0, 0, 0, 0, 0, 0, 1, 0})
      .no_tx();
  s.rx(0x50A, {1, 0, 2, 0, 3, 0, 4, 0}).write(20, 1).expect(12, {1, 2, 3, 4}).expect(16, {0, 0, 0, 0});
  // The command leaves the words alone.
  s.nmt(0x80).cif({0x8900}).expect(1000, 0x8901).expect(12, {1, 2, 3, 4});
  // The base of bindings.
  s.nmt(0x80).cif({0x8300, 0x0301, 0x0005, 0xFFFF}).says(3, 0x1800, 1, 0x183).expect(1000, 0x8301);
  s.expect_object(0x1404, 1, 0x183, 4).expect_object(0x1403, 1, 0x50A, 4);
}

// S-62, S-63
TEST(Fx2nMapping, ModeA_PutsEachStationAtItsPlace) {
  RecordProperty("spec",
                 "FX2N-MAPA-001 FX2N-MAPA-003 FX2N-MAPA-004 FX2N-MAPA-005 FX2N-MAPA-006 FX2N-MAP-005");
  std::vector<std::unique_ptr<Fx2nScenario>> stations;
  for (std::uint8_t node = 1; node <= 8; ++node) {
    auto& s = *stations.emplace_back(std::make_unique<Fx2nScenario>());
    s.start(node).cif({0x8200}).expect(1000, 0x8201).no_tx();
    expect_tpdos(s, 4, node);
    expect_rpdos(
        s, [](std::uint32_t n, std::uint32_t) { return 0x180 + 0x100 * ((n - 1) % 4) + (n - 1) / 4 + 1; },
        node);
    expect_mapped_words(s);
    s.nmt(1);
  }
  for (std::uint8_t node = 1; node <= 8; ++node) {
    Fx2nScenario& sender = *stations[node - 1U];
    for (module::BufferAddress word = 0; word < 16; ++word)
      sender.write(word, static_cast<std::uint16_t>(node << 8 | (word + 1)));
    sender.write(16, 0x7777).write(100, 0x7777).write(20, 1);
    EXPECT_EQ(sender.controller().sent.size(), 4U);
    for (const can::Frame& frame : sender.controller().sent)
      for (auto& other : stations)
        if (other.get() != &sender) other->rx(frame);
    sender.ignore_tx();
  }
  for (std::uint8_t own = 1; own <= 8; ++own) {
    Fx2nScenario& s = *stations[own - 1U];
    s.write(20, 1).no_tx();
    for (std::uint16_t node = 1; node <= 8; ++node) {
      for (std::uint16_t word = 0; word < (node == 8 ? 8 : 16); ++word) {
        const std::uint16_t w = static_cast<std::uint16_t>(16 * (node - 1) + word);
        const auto value = static_cast<std::uint16_t>(node == own ? 0 : node << 8 | (word + 1));
        s.expect(w < 20 ? w : w + 80U, value);
      }
    }
  }
}

// S-64
TEST(Fx2nMapping, ModeA_IsForNodes1To8) {
  RecordProperty("spec", "FX2N-MAPA-002");
  for (const std::uint8_t node : Bytes{9, 100, 127}) {
    Fx2nScenario s;
    s.start(node).cif({0x8200}).expect(1000, {0x82FF, 0}).no_tx();
    expect_tpdos(s, 2, node);
    expect_rpdos(
        s, [](std::uint32_t n, std::uint32_t own) { return n <= 2 ? 0x100 + 0x100 * n + own : off; }, node);
  }
}

// S-65
TEST(Fx2nMapping, ModeB_BeginsWithNoRpdo) {
  RecordProperty("spec", "FX2N-MAPB-007 FX2N-MAPB-001");
  Fx2nScenario s;
  s.start(5)
      .cif({0x8200})
      .cif({0x8300, 0, 0, 0xFFFF})
      .expect(1000, 0x8301)
      .expect(1001, Words(66, 0))
      .no_tx();
  expect_tpdos(s, 4, 5);
  expect_rpdos(
      s, [](std::uint32_t, std::uint32_t) { return off; }, 5);
  expect_mapped_words(s);
}

// S-66
TEST(Fx2nMapping, ModeB_BindsTwoOtherNodes) {
  RecordProperty(
      "spec",
      "FX2N-MAPB-001 FX2N-MAPB-003 FX2N-MAPB-004 FX2N-MAPB-005 FX2N-MAPB-006 FX2N-MAPB-012 FX2N-MAPB-013 "
      "FX2N-MAPB-027");
  Fx2nScenario s;
  s.start(1).cif({0x8300, 0x1009, 0x0203, 0xFFFF}).expect(1000, 0xFFFF);
  s.says(0x10, 0x1808, 1, 0x4000'0390)
      .says(2, 0x1402, 1, 0x402)
      .accepts(2, {0x23, 0x02, 0x14, 1, 0x90, 0x03, 0, 0});
  s.no_tx().expect(1000, {0x8301, 0, 0, 0});
  // The local node as source and as destination, by 0 and by its number; what follows FFFFh does not count.
  s.cif({0x8300, 0x0001, 0x0203, 0xFFFF, 0x0300, 0x0300}).says(2, 0x1402, 1, 0x402);
  s.accepts(2, {0x23, 0x02, 0x14, 1, 0x81, 0x01, 0, 0}).expect(1000, {0x8301, 0, 0, 0});
  s.cif({0x8300, 0x0201, 0x0101, 0xFFFF})
      .says(2, 0x1800, 1, 0x182)
      .expect(1000, 0x8301)
      .expect_object(0x1400, 1, 0x182, 4);
}

// S-67
TEST(Fx2nMapping, ModeB_WarnsOfADestinationThatWasOff) {
  RecordProperty("spec", "FX2N-MAPB-024 FX2N-MAPB-005 FX2N-MAPB-026 FX2N-MAPB-002");
  Fx2nScenario s;
  s.start(1).cif({0x8300, 0x1009, 0x0203, 0xFFFF}).says(0x10, 0x1808, 1, 0x390).says(2, 0x1402, 1, off);
  s.accepts(2, {0x23, 0x02, 0x14, 1, 0x90, 0x03, 0, 0}).expect(1000, {0x83FF, 0, 0x0003});
  for (const std::uint16_t own : Words{0x0003, 0x0104}) {
    s.cif({0x8300, 0x1009, own, 0xFFFF}).says(0x10, 0x1808, 1, 0x390).expect(1000, {0x8301, 0, 0});
    s.expect_object(static_cast<std::uint16_t>(0x13FF + (own & 0xFF)), 1, 0x390, 4);
  }
}

// S-68, S-69
TEST(Fx2nMapping, ModeB_TakesCobIdsOfAbsentNodes) {
  RecordProperty("spec", "FX2N-MAPB-015 FX2N-MAPB-016 FX2N-MAPB-017");
  Fx2nScenario s;
  s.start(1)
      .cif({0x8300, 0x7F01, 0x8005, 0xFFFF})
      .expect(1000, {0x8301, 0, 0})
      .no_tx()
      .expect_object(0x1804, 1, 0x1FF, 4);
  s.nmt(1).write(16, {1, 2, 3, 4}).write(20, 1).tx(0x1FF, {1, 0, 2, 0, 3, 0, 4, 0}).nmt(0x80);
  s.cif({0x8300, 0x7E02, 0x8006, 0x7D03, 0x8007, 0x0104, 0x801E, 0xFFFF})
      .expect(1000, {0x8301, 0, 0, 0, 0, 0, 0})
      .no_tx();
  s.expect_object(0x1805, 1, 0x2FE, 4).expect_object(0x1806, 1, 0x3FD, 4).expect_object(0x181D, 1, 0x481, 4);
  s.cif({0x8300, 0x7F05, 0x8005, 0xFFFF}).expect(1000, {0x83FF, 0x7F05, 0xFFFF});
  s.cif({0x8300, 0x0001, 0x8005, 0xFFFF}).expect(1000, {0x83FF, 0x0001, 0xFFFF});
  s.cif({0x8300, 0x8001, 0x8005, 0xFFFF}).expect(1000, {0x83FF, 0x8001, 0xFFFF});
  for (const std::uint16_t own : Words{0x8000, 0x8001, 0x8004, 0x801F, 0x807F})
    s.cif({0x8300, 0x7F01, own, 0xFFFF}).expect(1000, {0x83FF, 0, own});
  s.expect_object(0x1804, 1, 0x1FF, 4).expect_object(0x1800, 1, 0x181, 4).no_tx();
}

// S-70 to S-73
TEST(Fx2nMapping, ModeB_SaysWhichParameterIsWrong) {
  RecordProperty(
      "spec",
      "FX2N-MAPB-002 FX2N-MAPB-014 FX2N-MAPB-018 FX2N-MAPB-019 FX2N-MAPB-020 FX2N-MAPB-021 FX2N-MAPB-022 "
      "FX2N-MAPB-023 FX2N-MAPB-025");
  Fx2nScenario s;
  s.start(1).cif(
      {0x8300, 0x0001, 0x0005, 0x0001, 0x0006, 0x0001, 0x0007, 0x0001, 0x0008, 0x0100, 0x0009, 0xFFFF});
  s.expect(1000, {0x83FF, 0, 0, 0, 0, 0, 0, 0, 0, 0xFFFF, 0xFFFF, 0, 0})
      .expect_object(0x1407, 1, 0x181, 4)
      .no_tx();
  s.cif({0x8300, 0x0901, 0x0001, 0xFFFF}).is_silent(9).expect(1000, {0x83FF, 0x0900, 0xFFFF});
  s.cif({0x8300, 0x0205, 0x0001, 0xFFFF}).says(2, 0x1804, 1, off).expect(1000, {0x83FF, 0x0005, 0xFFFF});
  s.cif({0x8300, 0x0209, 0x0001, 0xFFFF}).aborts(2, {0x40, 0x08, 0x18, 1, 0, 0, 0, 0}, 0x0602'0000);
  s.expect(1000, {0x83FF, 0x0209, 0xFFFF});
  s.cif({0x8300, 0x8001, 0x0001, 0xFFFF}).expect(1000, {0x83FF, 0xFFFF, 0xFFFF}).no_tx();
  for (const std::uint16_t wrong : Words{0x0000, 0x0200, 0x8101, 0xFF01})
    s.cif({0x8300, 0x0001, wrong, 0xFFFF}).expect(1000, {0x83FF, 0, 0xFFFF}).no_tx();
  s.cif({0x8300, 0x0001, 0x0903, 0xFFFF}).is_silent(9).expect(1000, {0x83FF, 0, 0x0900});
  s.cif({0x8300, 0x0001, 0x0209, 0xFFFF}).aborts(2, {0x40, 0x08, 0x14, 1, 0, 0, 0, 0}, 0x0602'0000);
  s.expect(1000, {0x83FF, 0, 0x0209});
  // It may take the question, and not the value.
  s.cif({0x8300, 0x0001, 0x0201, 0xFFFF}).says(2, 0x1400, 1, 0x202);
  s.aborts(2, {0x23, 0x00, 0x14, 1, 0x81, 0x01, 0, 0}, 0x0609'0030).expect(1000, {0x83FF, 0, 0x0201});
  // In Stopped no other node can be reached.
  s.nmt(2).cif({0x8300, 0x0901, 0x0001, 0xFFFF}).expect(1000, {0x83FF, 0x0900, 0xFFFF}).no_tx();
}

// S-74
TEST(Fx2nMapping, ModeB_PreparesInTheFirstPairAlone) {
  RecordProperty("spec", "FX2N-MAPB-008 FX2N-MAPB-009 FX2N-MAPB-011");
  Fx2nScenario s;
  s.start(1)
      .cif({0x8900})
      .cif({0x8300, 0x0201, 0x0005, 0, 0, 0x0001, 0x0006, 0xFFFF})
      .says(2, 0x1800, 1, 0x182);
  s.expect(1000, {0x83FF, 0, 0, 0xFFFF, 0xFFFF, 0, 0}).no_tx();
  s.expect_object(0x1404, 1, 0x182, 4).expect_object(0x1405, 1, 0x181, 4).expect_object(0x1400, 1, 0x201, 4);
  // Again without it: one more binding, one that is changed; with it all are gone.
  s.cif({0x8300, 0x0301, 0x0005, 0x0302, 0x0007, 0xFFFF}).says(3, 0x1800, 1, 0x183).says(3, 0x1801, 1, 0x283);
  s.expect(1000, 0x8301).expect_object(0x1404, 1, 0x183, 4).expect_object(0x1406, 1, 0x283, 4);
  s.expect_object(0x1405, 1, 0x181, 4).cif({0x8300, 0, 0, 0x0001, 0x0002, 0xFFFF}).expect(1000, 0x8301);
  expect_rpdos(
      s, [](std::uint32_t n, std::uint32_t) { return n == 2 ? 0x181 : off; }, 1);
}

// S-75
TEST(Fx2nMapping, ModeB_TakesThirtyThreePairs) {
  RecordProperty("spec", "FX2N-MAPB-010 FX2N-MAPB-001");
  Fx2nScenario s;
  s.start(1);
  Words command{0x8300, 0, 0};
  for (std::uint16_t i = 1; i < 33; ++i) {
    command.push_back(static_cast<std::uint16_t>(1 + i % 4));
    command.push_back(static_cast<std::uint16_t>(1 + i % 30));
  }
  command[65] = 0x0902;
  command[66] = 0x0004;
  s.cif(command)
      .says(9, 0x1801, 1, 0x289)
      .expect(1000, 0x8301)
      .expect(1001, Words(66, 0))
      .expect_object(0x1403, 1, 0x289, 4);
}

TEST(Fx2nMapping, OtherNodes_MayChangeItsPdos) {
  RecordProperty("spec", "FX2N-MAPA-007 FX2N-MAP-006 FX2N-MAPB-026 FX2N-SDO-010");
  Fx2nScenario s;
  s.start(2).cif({0x8200});
  s.rx(0x602, {0x23, 0x00, 0x14, 1, 0xAA, 0x02, 0, 0}).tx(0x582, {0x60, 0x00, 0x14, 1, 0, 0, 0, 0});
  s.rx(0x602, {0x23, 0x00, 0x18, 1, 0xAB, 0x02, 0, 0}).tx(0x582, {0x60, 0x00, 0x18, 1, 0, 0, 0, 0});
  s.nmt(1)
      .rx(0x2AA, Bytes(8, 3))
      .write(0, 5)
      .write(20, 1)
      .expect(0, 0x0303)
      .tx(0x2AB, {5, 0, 0, 0, 0, 0, 0, 0});
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_mapping_test
