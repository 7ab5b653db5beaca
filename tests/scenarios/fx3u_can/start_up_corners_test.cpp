// Clauses of the NMT start-up, of error control and of 1F22H that the other tests pass by [FX3U-CAN 5.6.8, 5.7, 5.8, 6.24].

#include "scenarios/fx3u_can/master_steps.hpp"

namespace canopus::scenario::fx3u_can_start_up_corners_test {
namespace {

using Objects = std::vector<std::tuple<std::uint16_t, std::uint8_t, std::uint32_t, unsigned>>;

TEST(FxBoot, EveryPartOfTheIdentity_IsCompared_ZeroIsSkipped) {
  RecordProperty("spec", "FX3U-IDENT-001 FX3U-IDENT-002");
  const std::array<std::uint32_t, 5> identity{type_of_slave, 0x71, 7170, 0x0001'000C, 1234};
  for (unsigned wrong = 0; wrong <= 5; ++wrong) {
    for (unsigned skipped = 0; skipped <= 5; ++skipped) {
      BlockScenario s;
      Objects objects{{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x0D, 4}};
      for (unsigned i = 0; i < 5; ++i) {
        if (i == skipped) continue;
        objects.emplace_back(static_cast<std::uint16_t>(0x1F84 + i), 3, identity[i], 4);
      }
      prepare_master(s, objects);
      s.tx(0x000, {0x82, 0}).rx(0x703, {0x00});
      bool failed = false;
      for (unsigned i = 0; i < 5 && !failed; ++i) {
        const std::uint32_t value = identity[i] + (i == wrong ? 1 : 0);
        if (i == skipped && i != 0) continue;
        const Bytes ask{0x40, static_cast<std::uint8_t>(i == 0 ? 0x00 : 0x18),
                        0x10, static_cast<std::uint8_t>(i),
                        0,    0,
                        0,    0};
        Bytes answer{0x43, ask[1], ask[2], ask[3]};
        for (const std::uint8_t byte : canopen::little_endian(value, 4)) answer.push_back(byte);
        s.wait_tx(0x603, ask).rx(0x583, answer);
        failed = i == wrong && i != skipped;
      }
      if (failed) {
        s.no_tx().expect(25, 0x8900).expect(901, 0x0010);
      } else {
        s.tx(0x000, {0x01, 3}).no_tx().expect(25, 0x8201).expect(901, 0);
      }
    }
  }
}

TEST(FxBoot, StartAll_ComesAfterTheBootOfTheSlaves_AndAfterTheDelay) {
  RecordProperty("spec", "FX3U-BOOT-003 FX3U-BOOT-007");
  for (const bool slave_is_late : {false, true}) {
    BlockScenario s;
    prepare_master(s, {{0x1F80, 0, 3, 4}, {0x1F81, 3, 0x0D, 4}});
    s.tx(0x000, {0x82, 0});
    if (slave_is_late) s.advance(2s).ignore_tx();
    s.rx(0x703, {0x00}).ignore_tx();
    if (slave_is_late) s.advance(1s);
    s.ignore_tx().rx(0x703, {0x00});
    s.rx(0x583, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0});
    if (!slave_is_late) s.ignore_tx().advance(400ms).no_tx();
    EXPECT_GE(when_first_sent(s, 0x000, {0x01, 0}), can::Time{});
    s.advance(1s).expect(25, 0x8201).ignore_tx();
  }
}

// "Start all remote nodes" while a slave is not booted would start it, too: then each of the others is started [CiA 302-2;
// RJ71CN91 1.2 step 9].
TEST(FxBoot, StartAll_WithAnOptionalSlaveThatIsNotBooted_StartsTheOthersOneByOne) {
  RecordProperty("spec", "FX3U-BOOT-003 FX3U-BOOT-007");
  for (const bool is_absent : {true, false}) {  // else it is another device than expected
    BlockScenario s;
    prepare_master(s, {{0x1F80, 0, 3, 4},
                       {0x1F81, 3, 0x0D, 4},
                       {0x1F81, 4, 0x05, 4},
                       {0x1F81, 5, 0x05, 4},
                       {0x1F84, 5, type_of_slave, 4}});
    s.tx(0x000, {0x82, 0}).rx(0x704, {0x00});
    identify_slave(s, 4, type_of_slave);
    s.rx(0x703, {0x00});
    identify_slave(s, 3, type_of_slave);
    if (!is_absent) {
      s.rx(0x705, {0x00});
      identify_slave(s, 5, 0x12345);
    }
    s.advance(400ms).no_tx();  // not before #70 is over
    s.advance(100ms)
        .tx(0x000, {0x01, 3})
        .tx(0x000, {0x01, 4})
        .no_tx()
        .expect(25, is_absent ? 0xC201 : 0xA201);
    if (!is_absent) continue;
    // When it comes, it is started as the others were.
    s.advance(10s).ignore_tx().rx(0x705, {0x00});
    identify_slave(s, 5, type_of_slave);
    s.tx(0x000, {0x01, 5}).no_tx().expect(25, 0x8201);
  }
  BlockScenario all;
  prepare_master(all, {{0x1F80, 0, 3, 4}, {0x1F81, 3, 0x0D, 4}, {0x1F81, 4, 0x05, 4}});
  all.tx(0x000, {0x82, 0});
  for (const std::uint8_t node : Bytes{4, 3}) {
    all.rx(0x700U + node, {0x00});
    identify_slave(all, node, type_of_slave);
  }
  all.advance(500ms).tx(0x000, {0x01, 0}).advance(10s).no_tx();
}

// "The NMT Master retries every 1s after the request" [5.8.6]: whatever the time-out of the request is, up to 1 s.
TEST(FxBoot, TheQuestionForTheDeviceType_IsRepeatedOneSecondAfterIt) {
  RecordProperty("spec", "FX3U-BOOT-008");
  const Bytes ask{0x40, 0x00, 0x10, 0, 0, 0, 0, 0}, time_out{0x80, 0x00, 0x10, 0, 0x00, 0x00, 0x04, 0x05};
  for (const std::uint32_t assignment : {0x0DU, 0x05U}) {
    for (const std::uint16_t limit : Words{50, 500, 999, 2000}) {
      BlockScenario s;
      s.power_on()
          .write(26, 0)
          .write(71, limit)
          .set_object(0x1F80, 0, 1, 4)
          .set_object(0x1F81, 3, assignment, 4);
      s.store_objects().save().restart();
      const auto period = std::chrono::milliseconds(std::max<unsigned>(1000, limit));
      s.wait_tx(0x603, ask);
      for (int i = 0; i < 5; ++i) {
        const can::Time asked = s.now();
        s.wait_tx(0x603, time_out);
        EXPECT_EQ(s.now() - asked, std::chrono::milliseconds(limit));
        s.wait_tx(0x603, ask).no_tx();
        EXPECT_EQ(std::chrono::floor<std::chrono::milliseconds>(s.now() - asked), period);
      }
      // Until the slave responds.
      s.rx(0x583, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}).tx(0x000, {0x01, 3}).advance(1min).no_tx();
    }
  }
}

TEST(FxBoot, WithoutABootTime_ThereIsNoLimit_AndNobodyIsMissing) {
  RecordProperty("spec", "FX3U-BOOT-009 FX3U-NMT-015 FX3U-COM-009");
  for (const std::uint32_t assignment : {0x0DU, 0x05U}) {
    BlockScenario s;
    prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, assignment, 4}});
    s.advance(1h).ignore_tx().expect_bit(25, 11, false).expect_bit(25, 14, true).expect(29, 0);
    EXPECT_NE(s.read(603), 1) << "missing is shown with the boot time and the mandatory bit alone";
  }
  BlockScenario optional;
  prepare_master(optional, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x05, 4}, {0x1F89, 0, 1000, 4}});
  optional.advance(10s).ignore_tx().expect_bit(25, 11, false);
  EXPECT_NE(optional.read(603), 1);
}

TEST(FxBoot, ASlaveThatIsLost_IsBootedAgain_ButNotByAStoppedMaster) {
  RecordProperty("spec", "FX3U-COM-009 FX3U-BOOT-015 FX3U-BOOT-016 FX3U-NMT-013");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x05, 4}, {0x1016, 1, 0x0003'0064, 4}});
  s.tx(0x000, {0x82, 0}).rx(0x703, {0x00});
  identify_slave(s, 3, type_of_slave);
  s.rx(0x703, {0x7F}).tx(0x000, {0x01, 3}).rx(0x703, {0x05}).expect(25, 0x8201).expect(603, 5);
  // A supervised node shows its own state, whatever was asked for.
  s.set_object(0x1F82, 3, 5, 1).tx(0x000, {0x01, 3}).rx(0x703, {0x7F}).expect(603, 0x7F).rx(0x703, {0x05});
  s.advance(100ms)
      .tx(0x0FF, {0x03, 0x8F, 0x11, 0, 0, 0, 0, 0})
      .tx(0x000, {0x82, 3})
      .rx(0x703, {0x00})
      .ignore_tx();
  s.expect_bit(25, 14, true).rx(0x583, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}).rx(0x703, {0x7F});
  s.wait_bit(25, 14, false).expect_bit(25, 0, true).ignore_tx();
  s.set_object(0x1F82, 127, 4, 1).expect(25, 0x8000).ignore_tx().rx(0x703, {0x00}).advance(5s).no_tx();
}

TEST(FxBoot, AssignmentBits_ThatDoNotExist_AreRefused) {
  RecordProperty("spec", "FX3U-BOOT-013 FX3U-EB-005");
  BlockScenario s;
  s.power_on();
  for (unsigned bit = 0; bit < 8; ++bit) {
    const bool is_good = bit == 0 || bit == 2 || bit == 3 || bit == 4;
    const auto value = static_cast<std::uint16_t>(1U << bit);
    s.cif({0x0002, 0, 0x1F81, 3, 4, value, 0});
    is_good ? s.expect(1000, 0x0003).expect_object(0x1F81, 3, value, 4) : s.expect_abort(0x0609'0030);
  }
  for (std::uint16_t value = 3; value <= 0xFF; ++value)
    s.cif({0x0002, 0, 0x1029, 1, 1, value}).expect_abort(0x0609'0030);
}

TEST(FxNmt, Lss_NeedsAllOfItsConditions) {
  RecordProperty("spec", "FX3U-LSS-001");
  const Objects whole{{0x1F80, 0, 1, 4},  {0x1F81, 10, 0x0D, 4}, {0x1F89, 0, 2000, 4}, {0x1F84, 10, 1, 4},
                      {0x1F85, 10, 2, 4}, {0x1F86, 10, 3, 4},    {0x1F87, 10, 4, 4},   {0x1F88, 10, 5, 4}};
  for (std::size_t missing = 1; missing <= whole.size(); ++missing) {
    Objects objects = whole;
    if (missing < whole.size()) objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(missing));
    BlockScenario s;
    prepare_master(s, objects);
    s.advance(2100ms).ignore_tx().expect_bit(25, 10, missing == whole.size());
    if (missing < whole.size()) s.advance(20s).expect_bit(25, 10, false).ignore_tx();
  }
  for (const std::uint32_t assignment : {0x0CU, 0x09U, 0x05U}) {  // one of the bits 0, 2, 3 is 0
    Objects objects = whole;
    std::get<2>(objects[1]) = assignment;
    BlockScenario s;
    prepare_master(s, objects);
    for (int second = 0; second < 20; ++second) s.advance(1s).ignore_tx().expect_bit(25, 10, false);
  }
}

TEST(FxErrorControl, AToggleBit_AState_AndUnusedEntries) {
  RecordProperty("spec", "FX3U-NG-005 FX3U-HB-002 FX3U-NG-001");
  const auto guarded = [](BlockScenario& s) {
    prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x0064'0301, 4}});
    s.tx(0x000, {0x82, 0}).rx(0x703, {0x00}).tx_remote(0x703).rx(0x703, {0x7F}).expect(901, 1);
    s.advance(100ms).tx_remote(0x703);
  };
  BlockScenario toggle;
  guarded(toggle);
  toggle.rx(0x703, {0x7F}).expect_bit(901, 2, true).expect(29, 0x0401).ignore_tx();  // 7FH again, not FFH
  BlockScenario state;
  guarded(state);
  state.rx(0x703, {0xFF}).set_object(0x1F82, 3, 5, 1).tx(0x000, {0x01, 3}).advance(100ms).ignore_tx();
  state.rx(0x703, {0x05}).expect(901, 1).advance(100ms).ignore_tx().rx(0x703, {0x84});  // stopped by nobody
  state.expect_bit(901, 5, true).expect_bit(29, 10, true).ignore_tx();
  // Time 0, node 0, a node above 127.
  BlockScenario unused;
  unused.power_on().set_object(0x1016, 1, 0x0005'0000, 4).set_object(0x1016, 2, 0x0000'0064, 4);
  unused.cif({0x0002, 0, 0x1016, 3, 4, 0x0064, 0x0080}).ignore_tx().rx(0x705, {0x05}).rx(0x700, {0x05});
  unused.advance(10s).no_tx().expect(900, Words(64, 0)).expect(29, 0);
}

TEST(FxCommand, AnSdoToANodeThatIsBeingBooted_Fails) {
  RecordProperty("spec", "FX3U-SDO-004");
  BlockScenario s;
  prepare_master(s, {{0x1F80, 0, 1, 4}, {0x1F81, 3, 0x05, 4}});
  s.tx(0x000, {0x82, 0}).rx(0x703, {0x00}).tx(0x603, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  s.cif({0x0004, 3, 0x1018, 1}).expect_abort(0x060A'0023, 3).expect_bit(25, 14, true).no_tx();
  s.cif({0x7410, 3, 100, 0xFFFF}).expect(1000, {0x741F, 0, 0xFFFF}).no_tx();
  s.rx(0x583, {0x43, 0x00, 0x10, 0, 0x91, 0x01, 0x0F, 0}).tx(0x000, {0x01, 3});
  s.cif({0x0004, 3, 0x1018, 1}).tx(0x603, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0});
  s.rx(0x583, {0x43, 0x18, 0x10, 1, 0x71, 0, 0, 0}).expect(1000, {0x0005, 3, 0x1018, 1, 4, 0x71, 0});
}

TEST(FxConfiguration, SixtyConciseDcfs_OfUpTo65531Bytes) {
  RecordProperty("spec", "FX3U-CM-001 FX3U-CM-002");
  BlockScenario s;
  s.power_on();
  // By the SDO server, in segments: one byte too many, and as many as there may be.
  for (const unsigned size : {65'532U, 65'531U}) {
    Bytes request{0x21, 0x22, 0x1F, 1};
    for (const std::uint8_t byte : canopen::little_endian(size, 4)) request.push_back(byte);
    s.rx(0x67F, request).tx(0x5FF, {0x60, 0x22, 0x1F, 1, 0, 0, 0, 0});
    for (unsigned left = size, segment = 0; left != 0; ++segment) {
      const unsigned bytes = std::min(left, 7U);
      left -= bytes;
      const unsigned command = segment % 2 << 4 | (7 - bytes) << 1 | (left == 0 ? 1U : 0U);
      const auto first = static_cast<std::uint8_t>(segment == 0 ? 1 : 0);  // one entry
      s.rx(0x67F, {static_cast<std::uint8_t>(command), first, 0, 0, 0, 0, 0, 0});
      if (left == 0 && size == 65'532) {
        s.tx(0x5FF, {0x80, 0x22, 0x1F, 1, 0x10, 0x00, 0x07, 0x06});
      } else {
        s.tx(0x5FF, {static_cast<std::uint8_t>(0x20 | segment % 2 << 4), 0, 0, 0, 0, 0, 0, 0});
      }
    }
  }
  const auto write = [&](std::uint16_t node) -> BlockScenario& {
    return s.cif({0x0002, 0, 0x1F22, node, 13, 1, 0, 0x1017, 0x0200, 0, 0xF400, 0x0001});
  };
  for (std::uint16_t node = 2; node <= 60; ++node) write(node).expect(1000, 0x0003);
  write(61).expect(1000, {0x000F, 0x0003});
  write(60).expect_abort(0x0601'0002);
  write(1).expect_abort(0x0601'0002);
}

}  // namespace
}  // namespace canopus::scenario::fx3u_can_start_up_corners_test
