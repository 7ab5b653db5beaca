// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - settings that are wrong, and their errors.

#include "scenarios/me3can1_q/layer2_frames.hpp"

namespace canopus::scenario::me3can1_q_layer2_setting_errors_test {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2SettingErrors);

using module::LedPattern;
constexpr std::size_t can_run_led = 2;

// Slot 1 sends 123H, slot 2 receives 181H; online.
void two_slots(IntelligentScenario& s) {
  s.write(6000, {0xFFFF, 0x5FFF, 0, 0}).write(10000, {0x0123, 0, 1});
  s.write(6004, {0x0181, 0, 0, 0});
  s.online();
}

void make_error(IntelligentScenario& s, unsigned bit) {
  switch (bit) {
    case 5: s.write(6000, 1); break;
    case 6: s.write(24, 1); break;
    case 8:
      s.controller().accepts = false;
      s.exchange();
      s.controller().accepts = true;
      break;
    default:
      for (int i = 0; i < 20; ++i) s.rx(0x181, {1});
      s.write(5002, 0);  // the cause is gone at once
      break;
  }
}

TEST(Me3Layer2SettingErrors, LatchedBits_StayUntilCleared_ByY0FOrBy0) {
  RecordProperty("spec", "ME3-ERR-009 ME3-IO-012 ME3-IO-013 ME3-ERR-008");
  for (const unsigned bit : {5U, 6U, 8U, 15U}) {
    IntelligentScenario s;
    s.power_on_layer2();
    two_slots(s);
    for (const bool by_signal : {true, false}) {
      s.expect(29, 0).expect_x(0x0F, false);
      make_error(s, bit);
      s.advance(10s);
      s.expect(29, static_cast<std::uint16_t>(1U << bit)).expect_x(0x0F, true);
      s.expect(39, bit == 6 ? 24 : 0).expect(40, bit == 5 ? 6000 : 0);
      if (by_signal) {
        s.y(0x0F, true);
        s.expect(29, 0).expect_x(0x0F, false).expect(39, 0).expect(40, 0);
        make_error(s, bit);  // cleared at once
        s.expect(29, 0).expect_x(0x0F, false).expect(39, 0).expect(40, 0);
        s.y(0x0F, false);
      } else {
        s.write(29, static_cast<std::uint16_t>(~(1U << bit)));
        s.expect(29, 0).expect_x(0x0F, false).expect(39, 0).expect(40, 0);
      }
    }
    s.ignore_tx();
  }
}

TEST(Me3Layer2SettingErrors, OtherBits_FollowTheirCause_AndNotEachRaisesX0F) {
  RecordProperty("spec", "ME3-ERR-009 ME3-IO-012 ME3-IO-013");
  IntelligentScenario s;
  s.power_on_layer2();
  s.error_counters(256, 0);
  s.expect(29, 0x0008).expect_x(0x0F, true);
  s.y(0x0F, true);
  s.expect(29, 0x0008).expect_x(0x0F, true);
  s.y(0x0F, false).write(29, 0);
  s.expect(29, 0x0008);
  s.error_counters(200, 0);
  s.expect(29, 0x4000).expect_x(0x0F, false);  // error passive is no error of the module
  s.y(0x0F, true).y(0x0F, false).write(29, 0);
  s.expect(29, 0x4000);
  s.error_counters(0, 0);
  s.expect(29, 0).expect_x(0x0F, false);
  // A save that was cut off: bit 4 until the next start.
  s.write(22, 1).y(0x1F, true).advance(1ms);
  s.supply_off().supply_on();
  s.wait_bit(25, 7, false);
  s.expect(29, 0x0010).expect_x(0x0F, true);
  s.y(0x0F, true);
  s.expect(29, 0x0010).expect_x(0x0F, true);
  s.restart();
  s.expect(29, 0).expect_x(0x0F, false);
}

TEST(Me3Layer2SettingErrors, TriggersDataAndFlags_AreWrittenOnline) {
  RecordProperty("spec", "ME3-IO-010 ME3-L2-033");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 4, 0}).write(10000, {0x0123, 0, 1});
  s.write(6004, {0x0181, 0, 0, 0});
  s.online();
  s.write(8400, {1, 2, 3}).write(10002, 2).write(10003, {0x1111, 0x2222, 0x3333, 0x4444});
  s.expect(8400, {1, 2, 3}).expect(10002, {2, 0x1111, 0x2222, 0x3333, 0x4444}).expect(29, 0);
  s.rx(0x181, {0xA1, 0xA2});
  s.exchange();
  s.expect(10009, 0x0302);
  s.write(10009, 0x0300);  // the DLC is the module's
  s.expect(10009, 0x0302);
  s.write(10009, 0x0202);
  s.expect(10009, 0x0202);
  s.write(10009, 0xFFFF);  // a flag cannot be set
  s.expect(10009, 0x0202);
  s.write(10009, 0x0000);
  s.expect(10009, 0x0002);
  s.write(10010, 0x9999);  // received data are read only
  s.expect(10010, 0xA2A1).expect(29, 0);
}

// Address and value that a transmit slot 1, a receive slot 2 and the first stop message do not take.
struct BadValue {
  std::uint16_t mode;
  module::BufferAddress address;
  std::uint16_t value;
};

class Me3Layer2BadValue : public testing::TestWithParam<BadValue> {};

TEST_P(Me3Layer2BadValue, SetsG29Bit6_AndLeavesTheWord) {
  RecordProperty("spec", "ME3-L2-006 ME3-L2-007 ME3-L2-038 ME3-L2-036 ME3-L2-037 ME3-L2-042");
  const BadValue bad = GetParam();
  IntelligentScenario s;
  s.power_on_layer2(bad.mode);
  s.write(6000, {0xFFFF, 0x5FFF, 4, 0}).write(10000, {0x0123, 0, 1});
  s.write(6004, {0x0181, 0, 6, 0});
  s.write(6008, {0xFFFF, 0x6FFF, 0, 0}).write(10014, {0x0124, 0, 1});
  s.write(6012, {0xFFFF, 0x7FFF, 0, 0}).write(10021, {0x0125, 0, 1});
  s.expect(29, 0);
  const std::uint16_t before = s.read(bad.address);
  s.write(bad.address, bad.value);
  s.expect(bad.address, before).expect(29, 0x0040).expect(39, static_cast<std::uint16_t>(bad.address));
  s.expect_x(0x0F, true);
}

INSTANTIATE_TEST_SUITE_P(
    Words, Me3Layer2BadValue,
    testing::Values(BadValue{11, 6004, 0x0800}, BadValue{11, 6005, 1}, BadValue{11, 6005, 0x4FFF},
                    BadValue{29, 6005, 0x2000}, BadValue{29, 6005, 0x8000}, BadValue{11, 6002, 5},
                    BadValue{29, 6002, 5}, BadValue{11, 10000, 0x0800}, BadValue{11, 10001, 1},
                    BadValue{29, 10001, 0x2000}, BadValue{11, 10002, 9}, BadValue{11, 10002, 0x00FF},
                    BadValue{11, 10002, 0x9001}, BadValue{11, 10002, 0x1001}, BadValue{11, 10016, 0x8001},
                    BadValue{11, 10023, 0x8001}, BadValue{11, 10023, 0x9001}, BadValue{11, 6001, 0x6FFE},
                    BadValue{11, 6001, 0x7FFE}, BadValue{11, 6001, 0xFFFE}, BadValue{29, 6005, 0x5FFE},
                    BadValue{11, 10007, 0x0800}, BadValue{29, 10008, 0x2000}, BadValue{11, 8471, 0x0800},
                    BadValue{29, 8472, 0x2000}, BadValue{11, 8473, 0x0101}, BadValue{11, 8450, 0x0800},
                    BadValue{11, 8451, 1}, BadValue{29, 8451, 0x2000}, BadValue{11, 8452, 9},
                    BadValue{11, 8452, 0x8001}, BadValue{11, 5001, 1}));

TEST_P(Layer2SettingErrors, GoodValues_OfBothModes) {
  spec("ME3-L2-006 ME3-L2-007 ME3-L2-044", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2(29);
  s.write(6000, {0xFFFF, 0x1FFF, 0xFFFF, 0xFFFF});  // a receive slot: 1FFFFFFFH, any
  s.write(6004, {0x0000, 0x0000, 5, 9});
  s.write(10000, {0xFFFF, 0x1FFF});
  s.write(8450, {0xFFFF, 0x1FFF, 8});
  s.expect(29, 0);
  s.online();
  s.rx(extended(0x00ABCDEF, {7}));
  s.exchange();
  s.expect(10000, {0xCDEF, 0x00AB, 0x0301, 0x0007});
}

// What no single write shows: it keeps the module offline.
struct BadSetting {
  module::BufferAddress first;
  Words words;
  std::uint16_t shown;  // G39
};

class Me3Layer2BadSetting : public testing::TestWithParam<BadSetting> {};

TEST_P(Me3Layer2BadSetting, KeepsTheModuleOffline_AndIsShown) {
  RecordProperty("spec", "ME3-L2-006 ME3-L2-007 ME3-IO-009");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(GetParam().first, GetParam().words);
  s.expect(29, 0);
  s.y(0x03, true);
  s.expect_x(0x03, false).expect(29, 0x0040).expect(39, GetParam().shown).expect_x(0x0F, true);
  s.y(0x03, false);
  s.write(29, 0);
  s.write(6000, {0xFFFF, 0xFFFF, 0, 0}).write(8450, {0xFFFF, 0xFFFF});
  s.online();
  s.expect(29, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Words, Me3Layer2BadSetting,
    testing::Values(BadSetting{6000, {0x0181, 0xFFFF, 0, 0}, 6001},   // half an identifier
                    BadSetting{6000, {0xFFFF, 0x0000, 0, 0}, 6000},   // FFFFH is no 11-bit one
                    BadSetting{6000, {0xFFFF, 0x5FFF, 0, 0}, 10000},  // no CAN-ID
                    BadSetting{8450, {0x0100}, 8451}));

// What was no error for the slot as it was then is one at Y03, and for every slot and message, first to last.
TEST(Me3Layer2SettingErrors, FirstWrongWord_IsShown_WhicheverOrderTheyWereWrittenIn) {
  RecordProperty("spec", "ME3-L2-007 ME3-IO-009");
  IntelligentScenario s;
  s.power_on_layer2();
  const auto refused = [&](std::uint16_t address) {
    s.y(0x03, true).expect_x(0x03, false).expect(29, 0x0040).expect(39, address).y(0x03, false);
    s.write(29, 0).expect(39, 0);
  };
  s.write(8471, 0x0100);  // message 4: half an identifier
  refused(8472);
  s.write(6166, 5).write(6164, {0xFFFF, 0x5FFF}).write(10287, {0x0123, 0});  // type 5: written before A and B
  refused(6166);
  s.write(6004, 0x0181);  // slot 2: half an identifier
  refused(6005);
  s.write(6000, {0xFFFF, 0x7FFF, 4, 0}).write(10000, 0x0181);  // slot 1: half a CAN-ID
  refused(10001);
  s.write(10001, 0);
  refused(6005);
  s.write(6005, 0);
  refused(6166);
  s.write(6166, 4);
  refused(8472);
  s.write(8472, 0);
  s.online().expect(29, 0);
}

// RTR/new/DLC of a slot that is not used yet: only its DLC can be wrong; what goes with B is seen at Y03.
TEST(Me3Layer2SettingErrors, FrameWord_BeforeTheSlotIsSetUp) {
  RecordProperty("spec", "ME3-L2-036 ME3-L2-037 ME3-L2-038");
  IntelligentScenario s;
  s.power_on_layer2();
  for (const std::uint16_t good : Words{0x1002, 0x8002, 0x0008})
    s.write(10002, good).expect(10002, good).expect(29, 0);
  s.write(10002, 0x0009).expect(10002, 0x0008).expect(29, 0x0040).expect(39, 10002).write(29, 0);
  s.write(10002, 0x1002).write(10000, {0x0123, 0}).write(6000, {0xFFFF, 0x5FFF});  // bit 12 needs an answer
  s.y(0x03, true).expect_x(0x03, false).expect(29, 0x0040).expect(39, 10002);
  s.y(0x03, false).write(29, 0);
  s.write(6001, 0x6FFF).y(0x03, true).expect_x(0x03, true).expect(29, 0).no_tx();
}

TEST_P(Layer2SettingErrors, DisabledSlot_NeitherSendsNorReceives) {
  spec("ME3-L2-004 ME3-L2-005 ME3-L2-006", "RJ71-L2-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  for (const std::uint16_t b : Words{0x7FFF, 0x6FFF, 0x5FFF}) {
    s.write(6000, {0xFFFF, b, 0, 0}).write(10000, {0x0123, 0, 1, 0x44});
    s.online();
    s.exchange();
    s.tx(0x123, {0x44});
    s.rx(0x123, {0x99});  // a transmit slot does not receive
    s.exchange();
    s.tx(0x123, {0x44}).expect(10003, 0x0044).expect(10002, 1);
    s.offline();
  }
  s.write(6000, {0xFFFF, 0xFFFF, 0, 0});
  s.online();
  s.exchange();
  s.rx_remote(0x123, 1).rx(0x123, {0x99});
  s.write(8400, 1).y(0x04, true);
  s.expect(8400, 0).expect_x(0x04, true);
  s.exchange();
  s.no_tx().expect(10002, {1, 0x44}).expect(8350, 0);
  s.offline();
  s.write(6000, {0x0123, 0x0000, 0, 0});
  s.online();
  s.rx(0x123, {0x99});
  s.exchange();
  s.expect(10002, {0x0301, 0x0099}).no_tx();
}

}  // namespace
}  // namespace canopus::scenario::me3can1_q_layer2_setting_errors_test
