// Process data: words, exchange, PDOs, network variables [FX2N-32CAN 4.2.1, 4.2.2, 5, 7.4].

#include "scenarios/fx2n_32can/scenario.hpp"

namespace canopus::scenario::fx2n_32can_process_data_test {
namespace {

// S-20
TEST(Fx2nProcessData, WordsGoOut_WithTheControlWrite) {
  RecordProperty(
      "spec",
      "FX2N-DX-003 FX2N-DX-004 FX2N-DX-005 FX2N-DX-009 FX2N-DX-010 FX2N-BFM-005 FX2N-MAP-004 FX2N-GEN-008");
  Fx2nScenario s;
  s.start_operational().write(0, {0x1111, 0x2222, 0x3333, 0x4444}).advance(1s).no_tx();
  s.write(20, 0).no_tx().write(20, 2).no_tx();
  s.write(20, 1).tx(0x181, {0x11, 0x11, 0x22, 0x22, 0x33, 0x33, 0x44, 0x44}).no_tx();
  s.write(20, 1).advance(1s).no_tx();  // nothing has changed
  s.write(4, 0x0102).write(8, 3).write(20, 1);
  s.tx(0x281, {2, 1, 0, 0, 0, 0, 0, 0}).tx(0x381, {3, 0, 0, 0, 0, 0, 0, 0}).no_tx();
}

// S-21
TEST(Fx2nProcessData, NoFrameMixesOldAndNewWords) {
  RecordProperty("spec", "FX2N-DX-005 FX2N-DX-003");
  Fx2nScenario s;
  s.start_operational(1)
      .nmt(0x80)
      .set_object(0x1800, 2, 1, 1)
      .nmt(1)
      .write(0, {1, 2, 3, 4})
      .write(20, 1)
      .ignore_tx();
  const auto sync = [&] { s.rx(0x080); };
  sync();
  s.tx(0x181, {1, 0, 2, 0, 3, 0, 4, 0});
  for (const module::BufferAddress word : {0U, 1U, 2U, 3U}) {
    s.write(word, 0x5555);
    sync();
    s.tx(0x181, {1, 0, 2, 0, 3, 0, 4, 0});
  }
  s.write(20, 1);
  sync();
  s.tx(0x181, Bytes(8, 0x55)).no_tx();
}

// S-22, S-23
TEST(Fx2nProcessData, ReceivedData_AreHeldUntilTheNextControlWrite) {
  RecordProperty("spec",
                 "FX2N-DX-001 FX2N-DX-002 FX2N-DX-006 FX2N-DX-007 FX2N-BFM-004 FX2N-GEN-012 FX2N-MAP-004");
  Fx2nScenario s;
  s.start_operational().rx(0x201, {1, 2, 3, 4, 5, 6, 7, 8}).expect(0, {0, 0, 0, 0});
  s.write(20, 1).expect(20, 1).expect(0, {0x0201, 0x0403, 0x0605, 0x0807});
  s.rx(0x201, Bytes(8, 0xAA)).advance(1s).expect(0, {0x0201, 0x0403, 0x0605, 0x0807});
  s.rx(0x201, Bytes(8, 0xFF)).expect(0, 0x0201).write(20, 1).expect(0, {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF});
  // FROM and TO are two words.
  s.write(0, 0x1111).write(199, 0x2222).expect(0, 0xFFFF).expect(199, 0).write(20, 1).expect(0, 0xFFFF);
  s.tx(0x181, {0x11, 0x11, 0, 0, 0, 0, 0, 0}).no_tx();
}

// S-24
TEST(Fx2nProcessData, OutsideOfOperational_NothingIsExchanged) {
  RecordProperty("spec", "FX2N-DX-001 FX2N-DX-008");
  Fx2nScenario s;
  s.start_operational().expect(20, 1).nmt(0x80, 1).expect(25, 0x0101).expect(20, 0);
  s.write(0, 4).write(20, 1).write(0, 5).write(20, 1).write(0, 6).advance(1s).no_tx();
  s.rx(0x201, Bytes(8, 7)).write(20, 1).expect(0, 0);
  s.nmt(2).expect(20, 0).write(0, 8).no_tx();
  // What the last control write took is sent when it is Operational again.
  s.nmt(1).tx(0x181, {6, 0, 0, 0, 0, 0, 0, 0}).no_tx().expect(20, 1);
}

// S-26, S-27: every row of both tables.
TEST(Fx2nProcessData, EveryNetworkVariable_ShowsItsWords) {
  RecordProperty("spec", "FX2N-OD-001 FX2N-OD-002 FX2N-OD-003 FX2N-OD-004 FX2N-OD-005");
  Fx2nScenario s;
  s.start_operational();
  const auto address = [](std::uint16_t w) {
    return static_cast<module::BufferAddress>(w < 20 ? w : w + 80);
  };
  const auto value = [](std::uint16_t w) {
    return static_cast<std::uint16_t>(0x8100 * w + 0x37 * w + 0x1234);
  };
  for (std::uint16_t w = 0; w < 120; ++w) s.write(address(w), value(w));
  s.write(20, 1).ignore_tx();
  const canopen::ObjectDictionary& objects = s.plug_in().node().dictionary();
  const auto check = [&](std::uint16_t i8, std::uint16_t u8, std::uint16_t i16, std::uint16_t u16,
                         std::vector<std::uint16_t> of_32) {
    for (std::uint16_t w = 0; w < 120; ++w) {
      const auto low = static_cast<std::uint8_t>(2 * w + 1);
      for (const std::uint16_t index : {i8, u8}) {
        ASSERT_EQ(objects.get<std::uint8_t>(index, low), value(w) & 0xFF) << w;
        ASSERT_EQ(objects.get<std::uint8_t>(index, static_cast<std::uint8_t>(low + 1)), value(w) >> 8) << w;
      }
      for (const std::uint16_t index : {i16, u16})
        ASSERT_EQ(objects.get<std::uint16_t>(index, static_cast<std::uint8_t>(w + 1)), value(w)) << w;
      if (w % 2 != 0) continue;
      const std::uint32_t both = value(w) | std::uint32_t{value(static_cast<std::uint16_t>(w + 1))} << 16;
      for (const std::uint16_t index : of_32)
        ASSERT_EQ(objects.get<std::uint32_t>(index, static_cast<std::uint8_t>(w / 2 + 1)), both) << w;
    }
  };
  check(0xA000, 0xA040, 0xA0C0, 0xA100, {0xA1C0, 0xA200, 0xA240});
  // Received: one object of each type fills the words, and all the others show them.
  for (const std::uint16_t index : Words{0xA480, 0xA4C0, 0xA540, 0xA580, 0xA640, 0xA680, 0xA6C0}) {
    const unsigned size = index < 0xA540 ? 1 : index < 0xA640 ? 2 : 4;
    for (std::uint16_t w = 0; w < 120; ++w) {
      if (size == 1) {
        s.set_object(index, static_cast<std::uint8_t>(2 * w + 1), value(w) & 0xFFU, 1);
        s.set_object(index, static_cast<std::uint8_t>(2 * w + 2), value(w) >> 8, 1);
      } else if (size == 2) {
        s.set_object(index, static_cast<std::uint8_t>(w + 1), value(w), 2);
      } else if (w % 2 == 0) {
        s.set_object(index, static_cast<std::uint8_t>(w / 2 + 1),
                     value(w) | std::uint32_t{value(static_cast<std::uint16_t>(w + 1))} << 16, 4);
      }
    }
    check(0xA480, 0xA4C0, 0xA540, 0xA580, {0xA640, 0xA680, 0xA6C0});
    s.write(20, 1);
    for (std::uint16_t w = 0; w < 120; ++w) ASSERT_EQ(s.read(address(w)), value(w)) << w;
    for (std::uint16_t w = 0; w < 120; ++w) s.set_object(0xA580, static_cast<std::uint8_t>(w + 1), 0, 2);
  }
  // By SDO, and beyond the last.
  s.write(0, 0x1234).write(1, 0xABCD).write(20, 1).ignore_tx();
  s.expect_object(0xA100, 1, 0x1234, 2).expect_object(0xA040, 1, 0x34, 1).expect_object(0xA040, 2, 0x12, 1);
  for (const std::uint16_t index : Words{0xA1C0, 0xA200, 0xA240}) s.expect_object(index, 1, 0xABCD'1234, 4);
  s.expect_object(0xA100, 0x78, value(119), 2).expect_object(0xA040, 0xF0, value(119) >> 8, 1);
  s.expect_object(0xA200, 0x0A, value(18) | std::uint32_t{value(19)} << 16, 4);
  s.expect_object(0xA200, 0x0B, value(20) | std::uint32_t{value(21)} << 16, 4);
  for (const auto& [index, sub] : std::vector<std::pair<std::uint16_t, std::uint16_t>>{{0xA000, 0xF1},
                                                                                       {0xA040, 0xF1},
                                                                                       {0xA0C0, 0x79},
                                                                                       {0xA100, 0x79},
                                                                                       {0xA1C0, 0x3D},
                                                                                       {0xA200, 0x3D},
                                                                                       {0xA240, 0x3D},
                                                                                       {0xA480, 0xF1},
                                                                                       {0xA4C0, 0xF1},
                                                                                       {0xA540, 0x79},
                                                                                       {0xA580, 0x79},
                                                                                       {0xA640, 0x3D},
                                                                                       {0xA680, 0x3D},
                                                                                       {0xA6C0, 0x3D}})
    s.cif({0x0004, 0, index, sub}).expect_abort(0x0609'0011);
}

// All rows of Tables 7.4 and 7.5.
TEST(Fx2nProcessData, EveryPdo_HasItsFourWords) {
  RecordProperty("spec", "FX2N-MAP-003 FX2N-MAP-004 FX2N-GEN-004 FX2N-BFM-004 FX2N-BFM-005 FX2N-MAP-002");
  Fx2nScenario s;
  s.start_operational().nmt(0x80);
  for (std::uint16_t n = 1; n <= 30; ++n) {
    s.set_object(static_cast<std::uint16_t>(0x1400 + n - 1), 1, 0x300U + n, 4);
    s.set_object(static_cast<std::uint16_t>(0x1800 + n - 1), 1, 0x200U + n, 4);
  }
  s.nmt(1).ignore_tx();
  for (std::uint16_t n = 1; n <= 30; ++n) {
    const auto first = static_cast<module::BufferAddress>(n <= 5 ? 4 * (n - 1) : 100 + 4 * (n - 6));
    const auto b = static_cast<std::uint8_t>(n);
    s.write(first, {n, static_cast<std::uint16_t>(n + 256), 3, 4});
    s.rx(0x300U + n, {b, 1, b, 2, b, 3, b, 4}).write(20, 1);
    s.tx(0x200U + n, {b, 0, b, 1, 3, 0, 4, 0}).no_tx();
    const canopen::ObjectDictionary& objects = s.plug_in().node().dictionary();
    EXPECT_EQ(objects.get<std::uint8_t>(0xA4C0, static_cast<std::uint8_t>(8 * (n - 1) + 1)), b);
    const auto word = [&](unsigned high) { return static_cast<std::uint16_t>(high << 8 | n); };
    s.expect(first, {word(1), word(2), word(3), word(4)});
  }
  // Switched off neither sends nor receives. There is no PDO 31.
  s.set_object(0x1800, 1, 0x8000'0201, 4).set_object(0x1400, 1, 0x8000'0301, 4).write(0, 9);
  s.rx(0x301, Bytes(8, 0x77)).write(20, 1).no_tx().expect(0, 0x0101);
  for (const std::uint16_t index : Words{0x141E, 0x161E, 0x181E, 0x1A1E})
    s.cif({0x0004, 0, index, 1}).expect_abort(0x0602'0000);
}

TEST(Fx2nProcessData, AProducerIsTriggered_ByASyncOrByARemoteFrame) {
  RecordProperty("spec", "FX2N-OD-008 FX2N-NMT-004 FX2N-L2-004 FX2N-DX-010 FX2N-GEN-014");
  Fx2nScenario s;
  s.start_operational().write(0, 0x0102).write(20, 1).ignore_tx();
  s.rx_remote(0x181, 8).tx(0x181, {2, 1, 0, 0, 0, 0, 0, 0}).no_tx();
  s.nmt(0x80).rx_remote(0x181, 8).no_tx();
  // Every second SYNC.
  s.set_object(0x1800, 2, 2, 1).nmt(1).rx(0x080).no_tx().rx(0x080).tx(0x181, {2, 1, 0, 0, 0, 0, 0, 0});
  // 1005H makes it the producer, 1006H says how often, 1007H how long a synchronous PDO counts.
  s.expect_object(0x1005, 0, 0x80, 4).set_object(0x1006, 0, 10'000, 4).advance(1s).no_tx();
  s.set_object(0x1005, 0, 0x4000'0080, 4)
      .advance(10ms)
      .tx(0x080)
      .advance(10ms)
      .tx(0x080)
      .tx(0x181, {2, 1, 0, 0, 0, 0, 0, 0});
  s.set_object(0x1400, 2, 0, 1).set_object(0x1007, 0, 2'000, 4).advance(10ms).ignore_tx();
  s.advance(3ms).rx(0x201, Bytes(8, 9)).advance(10ms).ignore_tx();
  s.write(20, 1).ignore_tx().expect(0, 0).rx(0x201, Bytes(8, 9)).advance(20ms).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx2n_32can_process_data_test
