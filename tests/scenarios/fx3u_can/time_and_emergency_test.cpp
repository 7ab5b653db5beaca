// Clock, SYNC, received emergency messages [FX3U-CAN 5.6.7, 5.6.10, 5.6.13, 6.19, 6.23].

#include "scenarios/fx3u_can/scenario.hpp"

namespace canopus::scenario::fx3u_can_time_and_emergency_test {
namespace {

/// An emergency message's bytes; nothing of the maker's.
Bytes emergency(std::uint16_t code, std::uint8_t error_register = 1) {
  return {static_cast<std::uint8_t>(code & 0xFF),
          static_cast<std::uint8_t>(code >> 8),
          error_register,
          0,
          0,
          0,
          0,
          0};
}

/// Active NMT master without slaves, Operational, frames gone by.
void master(BlockScenario& s) {
  s.power_on_as_master(1).advance(2s).ignore_tx();
  s.expect_bit(25, 15, true);
}

// S040
TEST(FxSync, TheActiveMasterProducesIt_InStepsOfAMillisecond) {
  RecordProperty("spec", "FX3U-SYNC-001 FX3U-SYNC-002 FX3U-SYNC-003 FX3U-SYNC-004 FX3U-SYNC-005");
  BlockScenario s;
  master(s);
  s.set_object(0x1006, 0, 10000, 4).advance(100ms).no_tx().set_object(0x1005, 0, 0x4000'0080, 4).ignore_tx();
  const auto count = [&](can::Duration time) {
    s.ignore_tx().advance(time);
    const std::size_t frames = s.controller().sent.size();
    for (const can::Frame& frame : s.controller().sent) EXPECT_EQ(text(frame), "080 []");
    s.ignore_tx();
    return frames;
  };
  EXPECT_EQ(count(1s), 100U);
  for (const auto& [period, frames] : std::vector<std::pair<std::uint32_t, std::size_t>>{
           {500, 1000}, {1, 1000}, {999, 1000}, {1500, 1000}, {2000, 500}, {0, 0}, {5000, 200}}) {
    s.set_object(0x1006, 0, period, 4);
    EXPECT_EQ(count(1s), frames) << period;
  }
  s.set_object(0x1005, 0, 0xC000'0080, 4);
  EXPECT_EQ(count(1s), 200U) << "bit 31 has no effect";
  s.set_object(0x1F82, 1, 0x7F, 1);
  EXPECT_EQ(count(1s), 200U) << "pre-operational";
  s.cif({0x0002, 0, 0x1F82, 1, 1, 4});
  EXPECT_EQ(count(1s), 0U) << "stopped";
  BlockScenario slave;
  slave.power_on_operational()
      .set_object(0x1006, 0, 1000, 4)
      .set_object(0x1005, 0, 0x4000'0080, 4)
      .advance(1s)
      .no_tx();
}

TEST(FxSync, AnUnexpectedLength_IsReported) {
  RecordProperty("spec", "FX3U-SYNC-006");
  BlockScenario s;
  s.power_on_operational().rx(0x080, {1, 2}).advance(1ms).tx(0x0FF, {0x40, 0x82, 0x11, 0, 0, 0, 0, 0});
}

// S041
TEST(FxClock, AProducer_SendsTheTime_WhenTheIntervalIsWritten) {
  RecordProperty("spec", "FX3U-TIME-005 FX3U-TIME-006 FX3U-TIME-010 FX3U-TIME-012");
  BlockScenario s;
  master(s);
  s.write(50, 2)
      .expect_object(0x1012, 0, 0x4000'0100, 4)
      .write(51, {12, 3, 1, 0, 0})
      .write(56, 0)
      .advance(500ms)
      .no_tx();
  s.expect(57, 4).write(58, 1).advance(1ms).tx(0x100, {0, 0, 0, 0, 0x2F, 0x28}).advance(59s).no_tx();
  s.advance(1s)
      .tx(0x100, {0x60, 0xEA, 0, 0, 0x2F, 0x28})
      .advance(1min)
      .tx(0x100, {0xC0, 0xD4, 1, 0, 0x2F, 0x28});
  s.write(58, 0).advance(1h).no_tx().write(58, 1440).advance(1ms).ignore_tx().advance(24h).tx(
      0x100, {0x40, 0xC3, 0x38, 0, 0x30, 0x28});
}

TEST(FxClock, TheProgramReadsTheTime_AndWhoOnlyPeeks_ChangesNothingOfWhatItReads) {
  RecordProperty("spec", "FX3U-TIME-005");
  BlockScenario s;
  s.power_on_operational().write(50, 2).write(51, {12, 3, 1, 0, 0, 0}).advance(5s);
  const auto seconds = [&] { return s.plug_in().peek(56, s.now()); };
  EXPECT_EQ(s.plug_in().peek(51, s.now()), 12);
  EXPECT_EQ(seconds(), 0) << "as it was written";
  EXPECT_EQ(s.read(51), 12);
  EXPECT_EQ(seconds(), 5) << "as the program has read it";
}

TEST(FxClock, OnlyTheActiveMasterSendsIt_AndNotWhenStopped) {
  RecordProperty("spec", "FX3U-TIME-006");
  BlockScenario s;
  s.power_on_operational()
      .write(50, 2)
      .write(51, {12, 3, 1, 0, 0, 0})
      .write(58, 1)
      .advance(5min)
      .no_tx()
      .expect(29, 0);
  BlockScenario stopped;
  master(stopped);
  stopped.write(50, 2)
      .write(51, {12, 3, 1, 0, 0, 0})
      .cif({0x0002, 0, 0x1F82, 1, 1, 0x7F})
      .ignore_tx()
      .write(58, 1)
      .advance(1ms);
  stopped.tx(0x100, {0, 0, 0, 0, 0x2F, 0x28})
      .cif({0x0002, 0, 0x1F82, 1, 1, 4})
      .ignore_tx()
      .advance(5min)
      .no_tx();
}

// S042, S043
TEST(FxClock, ADateThatIsNone_IsRefused_AndOnlyTwoDigitsOfTheYearCount) {
  RecordProperty("spec", "FX3U-TIME-007 FX3U-TIME-008 FX3U-TIME-014");
  struct Row {
    Words words;  // #51 to #56
    std::uint16_t bad;
  };
  for (const Row& row :
       {Row{{12, 4, 31, 0, 0, 0}, 53}, Row{{12, 0, 1, 0, 0, 0}, 52}, Row{{12, 13, 1, 0, 0, 0}, 52},
        Row{{13, 2, 29, 0, 0, 0}, 53}, Row{{12, 2, 30, 0, 0, 0}, 53}, Row{{12, 1, 0, 0, 0, 0}, 53},
        Row{{12, 1, 1, 24, 0, 0}, 54}, Row{{12, 1, 1, 0, 60, 0}, 55}, Row{{12, 1, 1, 0, 0, 60}, 56}}) {
    BlockScenario s;
    master(s);
    s.write(50, 2)
        .write(51, {20, 5, 6, 7, 8, 9})
        .expect(29, 0)
        .write(51, row.words)
        .expect_bit(29, 6, true)
        .expect(39, row.bad);
    s.expect(51, {20, 5, 6, 7, 8, 9}).write(29, 0).expect(29, 0);
  }
  BlockScenario s;
  master(s);
  s.write(50, 2).write(51, {1984, 2, 29, 12, 0, 0}).expect(29, 0).write(58, 1).advance(1ms);
  s.tx(0x100, {0x00, 0x2E, 0x93, 0x02, 0xE8, 0x8E})
      .expect(51, {84, 2, 29, 12, 0, 0});  // 2084-02-29: day 36584
}

// S044
TEST(FxClock, AConsumer_RunsFromTheFirstTimeObjectOn_AndTakesNoWords) {
  RecordProperty(
      "spec",
      "FX3U-TIME-001 FX3U-TIME-003 FX3U-TIME-004 FX3U-TIME-009 FX3U-TIME-011 FX3U-COM-007 FX3U-TIME-014");
  BlockScenario s;
  s.power_on()
      .expect_object(0x1012, 0, 0x8000'0100, 4)
      .advance(24h)
      .expect(51, {12, 3, 1, 0, 0, 0, 4})
      .ignore_tx();
  s.rx(0x100, {0, 0, 0, 0, 0x2F, 0x28})
      .expect_bit(25, 12, true)
      .advance(3661s)
      .expect(51, {12, 3, 1, 1, 1, 1, 4});
  s.write(51, 20)
      .write(52, 5)
      .write(58, 7)
      .write(59, 30)
      .expect(51, {12, 3, 1, 1, 1, 1, 4, 0, 0})
      .expect(29, 0);
  s.write(25, 0).expect_bit(25, 12, false);
  // The words stand still until #51 is read.
  s.advance(10s).expect(56, 1).expect(51, 12).expect(56, 11);
  s.rx(0x100, {0, 0, 0, 0, 0xD3, 0x16}).expect(51, {0, 1, 1, 0, 0, 0, 6});
  // 2099-12-31 23:59:59 is day 42368.
  s.rx(0x100, {0x18, 0x58, 0x26, 0x05, 0x80, 0xA5})
      .expect(51, {99, 12, 31, 23, 59, 59})
      .advance(1s)
      .expect(51, {0, 1, 1, 0, 0, 0});
  // 2096-02-28 23:59:59, a leap year.
  s.rx(0x100, {0x18, 0x58, 0x26, 0x05, 0x06, 0xA0})
      .expect(51, {96, 2, 28, 23, 59, 59})
      .advance(1s)
      .expect(51, {96, 2, 29, 0, 0, 0});
  s.nmt(0x81).wait_bit(25, 7, false).ignore_tx().restart().advance(10s).expect(51, {12, 3, 1, 0, 0, 0, 4});
}

TEST(FxClock, WithoutTheConsumersBit_ATimeObjectIsNotTaken) {
  RecordProperty("spec", "FX3U-COM-007 FX3U-TIME-002");
  BlockScenario s;
  s.power_on()
      .write(50, 0)
      .rx(0x100, {0, 0, 0, 0, 0x2F, 0x28})
      .expect_bit(25, 12, false)
      .advance(10s)
      .expect(51, {12, 3, 1, 0, 0, 0});
}

// S045
TEST(FxClock, TheRoleIs1012h) {
  RecordProperty("spec", "FX3U-TIME-002");
  BlockScenario s;
  s.power_on();
  constexpr std::array<std::uint32_t, 4> cob_ids{0x100, 0x8000'0100, 0x4000'0100, 0xC000'0100};
  for (std::uint16_t role = 0; role < 4; ++role) s.write(50, role).expect_object(0x1012, 0, cob_ids[role], 4);
  for (std::uint16_t role = 0; role < 4; ++role) s.set_object(0x1012, 0, cob_ids[role], 4).expect(50, role);
  s.write(50, 4).expect(50, 3).expect(29, 0x0041).expect(39, 50);
}

TEST(FxClock, DailyCorrection_IsSaved_AndSpreadOverTheDay) {
  RecordProperty("spec", "FX3U-TIME-013 FX3U-TIME-015");
  BlockScenario s;
  master(s);
  s.write(50, 2)
      .write(59, 60)
      .write(51, {12, 3, 1, 0, 0, 0})
      .advance(24h)
      .expect(51, {12, 3, 2, 0, 1, 0})
      .ignore_tx();
  s.write(59, 0xFFC4)
      .write(51, {12, 3, 1, 0, 0, 0})
      .advance(24h)
      .expect(51, {12, 3, 1, 23, 59, 0})
      .ignore_tx();
  for (const std::uint16_t bad : Words{61, 0xFFC3})
    s.write(59, bad).expect(59, 0xFFC4).expect_bit(29, 6, true).expect(39, 59).write(29, 0);
  s.save()
      .restart()
      .expect(59, 0xFFC4)
      .expect(51, {12, 3, 1, 0, 0, 0, 4})
      .advance(1h)
      .expect(51, {12, 3, 1, 0, 0, 0, 4});
}

// S060
TEST(FxEmergency, TheFirstElevenStay_AndTheRingKeepsTheLatest) {
  RecordProperty("spec", "FX3U-EMCY-005 FX3U-EMCY-006 FX3U-EMCY-007 FX3U-EMCY-008 FX3U-EMCY-009 FX3U-DX-007");
  BlockScenario s;
  s.power_on().rx(0x085, {0x00, 0x10, 0x01, 0xA1, 0xA2, 0xA3, 0xA4, 0xA5}).expect(750, 0);
  s.write(20, 0x1000).advance(1ms).expect(750, {5, 0x1000, 0xA101, 0xA3A2, 0xA5A4});
  for (std::uint8_t n = 2; n <= 23; ++n) s.rx(0x085, emergency(static_cast<std::uint16_t>(0x1000 + n)));
  s.write(20, 0x1000).advance(1ms);
  for (unsigned n = 1; n <= 11; ++n)
    s.expect(750 + 5 * (n - 1), {5, static_cast<std::uint16_t>(n == 1 ? 0x1000 : 0x1000 + n)});
  for (unsigned n = 0; n < 11; ++n) s.expect(805 + 5 * n, {5, static_cast<std::uint16_t>(0x100D + n)});
  s.write(750, 0)
      .expect(750, Words(110, 0))
      .rx(0x083, emergency(0x2000, 2))
      .write(20, 0x1000)
      .advance(1ms)
      .expect(750, {3, 0x2000, 2});
  s.set_object(0x1028, 7, 0x8000'0087, 4)
      .rx(0x087, emergency(0x3000, 2))
      .set_object(0x1028, 8, 0x8000'0188, 4)
      .set_object(0x1028, 8, 0x188, 4)
      .rx(0x188, emergency(0x4000, 2));
  s.write(20, 0x1000).advance(1ms).expect(755, {8, 0x4000}).expect(760, 0);
}

TEST(FxEmergency, OfAnAssignedSlave_SetsItsBit) {
  RecordProperty("spec", "FX3U-ERR-009 FX3U-ERR-001 FX3U-ERR-002 FX3U-ERR-004");
  BlockScenario s;
  s.power_on().set_object(0x1F81, 5, 1, 4).rx(0x086, emergency(0x1000, 1)).expect(29, 0);
  s.rx(0x085, emergency(0x1000, 1)).expect(29, 1U << 13);  // which is no general error
  s.write(29, 0xFFFF).expect(29, 1U << 13).write(29, 0xDFFF).expect(29, 0);
}

// S050 to S055
TEST(FxErrorControl, HeartbeatsOfOthers) {
  RecordProperty(
      "spec",
      "FX3U-HB-002 FX3U-HB-003 FX3U-HB-004 FX3U-HB-005 FX3U-ERR-008 FX3U-ERR-004 FX3U-NMT-013 FX3U-NG-008");
  for (const std::uint32_t behaviour : {0U, 1U, 2U}) {
    BlockScenario s;
    s.power_on()
        .set_object(0x1029, 1, behaviour, 1)
        .set_object(0x1016, 1, 0x0005'0258, 4)
        .nmt(1)
        .ignore_tx()
        .advance(10s)
        .expect(605, 0)
        .expect(29, 0)
        .expect(902, 0);
    s.rx(0x705, {0x05})
        .expect(902, 0x0002)
        .expect(605, 5)
        .advance(599ms)
        .expect(29, 0)
        .rx(0x705, {0x7F})
        .expect(605, 0x7F);
    s.advance(599ms)
        .expect(29, 0)
        .advance(1ms)
        .expect(902, 0x0082)
        .expect(29, 0x0401)
        .tx(0x0FF, {0x05, 0x8F, 0x11, 0, 0, 0, 0, 0});
    s.expect(25, behaviour == 0 ? 0x0100 : behaviour == 1 ? 0x0201 : 0);
    s.rx(0x705, {0x00})
        .expect(605, 0x7F)
        .ignore_tx()
        .write(902, 0)
        .expect(902, 0x0002)
        .expect(29, 0x0401)
        .write(29, 0)
        .expect(29, 0);
  }
  BlockScenario s;
  s.power_on()
      .set_object(0x1016, 1, 0x0005'0064, 4)
      .set_object(0x1016, 2, 0x0006'0064, 4)
      .rx(0x705, {5})
      .rx(0x706, {5})
      .advance(100ms)
      .ignore_tx();
  s.expect(902, 0x8282).write(902, 0x0080).expect(902, 0x0282).expect(29, 0x0401);  // node 6 alone
  s.write(29, 0).expect(29, 0).expect(902, 0x0202);
}

TEST(FxErrorControl, OwnHeartbeat) {
  RecordProperty("spec", "FX3U-HB-001");
  BlockScenario s;
  s.power_on()
      .set_object(0x1017, 0, 500, 2)
      .ignore_tx()
      .advance(500ms)
      .tx(0x77F, {0x7F})
      .nmt(1)
      .advance(500ms)
      .tx(0x77F, {0x05});
  s.nmt(2)
      .advance(500ms)
      .tx(0x77F, {0x04})
      .no_tx()
      .nmt(1)
      .set_object(0x1017, 0, 0, 2)
      .ignore_tx()
      .advance(10s)
      .no_tx();
}

TEST(FxErrorControl, GuardedAsASlave) {
  RecordProperty("spec", "FX3U-NG-001 FX3U-NG-002 FX3U-NG-003");
  BlockScenario s;
  s.power_on().set_object(0x100D, 0, 3, 1).set_object(0x100C, 0, 100, 2).advance(10s).no_tx();
  s.rx_remote(0x77F)
      .tx(0x77F, {0x7F})
      .rx_remote(0x77F)
      .tx(0x77F, {0xFF})
      .nmt(1)
      .rx_remote(0x77F)
      .tx(0x77F, {0x05});
  s.advance(299ms)
      .expect(963, 0)
      .advance(1ms)
      .expect(963, 0x0040)
      .expect(29, 0x0401)
      .expect(25, 0x0100)
      .ignore_tx();
  BlockScenario off;
  off.power_on().set_object(0x100C, 0, 100, 2).rx_remote(0x77F).ignore_tx().advance(10s).expect(29, 0);
}

// S053, S054
TEST(FxErrorControl, GuardsItsSlaves) {
  RecordProperty("spec", "FX3U-NG-004 FX3U-NG-005 FX3U-NG-008 FX3U-NG-009");
  BlockScenario s;
  s.power_on_as(1)
      .set_object(0x1F80, 0, 1, 4)
      .set_object(0x1F81, 3, 0x00C8'0301, 4)
      .store_objects()
      .ignore_tx();
  s.write(25, 1).ignore_tx().wait_bit(25, 7, false).tx(0x701, {0x00}).tx(0x000, {0x82, 0x00});
  s.rx(0x703, {0x00}).tx_remote(0x703).rx(0x703, {0x7F}).expect(901, 1).expect(29, 0);
  s.advance(200ms).tx_remote(0x703).rx(0x703, {0xFF}).expect(901, 1).expect(29, 0).no_tx();
  s.expect_object(0x1F83, 3, 1, 1).set_object(0x1F83, 3, 0, 1).expect_object(0x1F83, 3, 0, 1);
  s.expect(901, 0).advance(5s).no_tx();
  s.set_object(0x1F83, 0x80, 1, 1).tx_remote(0x703).rx(0x703, {0x7F}).expect_object(0x1F83, 3, 1, 1);
  s.advance(400ms).expect_bit(901, 2, true).expect_bit(29, 10, true);
  s.advance(600ms).expect_bit(901, 3, true).ignore_tx();
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_time_and_emergency_test
