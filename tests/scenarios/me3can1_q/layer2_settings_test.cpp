// spec/me3can1-q/scenarios.md, section 8: Layer 2 modes - function mode, words, online and offline, saving.

#include "scenarios/me3can1_q/scenario.hpp"

namespace canopus::scenario {
namespace {

CANOPUS_OF_BOTH_MODULES(Layer2Settings);

using module::LedPattern;
constexpr std::size_t can_run_led = 2;

can::Frame extended(std::uint32_t identifier, const Bytes& bytes) {
  can::Frame frame = can::data_frame(0, bytes);
  frame.identifier = identifier;
  frame.extended = true;
  return frame;
}

TEST(Me3Layer2Settings, S06_StartUp_InTheOrderOfTable6_5) {
  RecordProperty("spec", "ME3-L2-001 ME3-PRG-003 ME3-L2-009 ME3-MODE-003");
  IntelligentScenario s;
  s.power_on();
  s.write(21, 11);
  s.save();
  s.expect(37, 2500).expect_bit(25, 8, true);  // still 405: Pre-operational
  s.restart();
  s.expect(21, 11).expect(25, 0);
  s.write(24, 500);
  s.save();
  s.expect(37, 2500);
  s.restart();
  s.expect(37, 5000).expect_x(0x03, false);
  EXPECT_EQ(s.plug_in().leds(s.now())[can_run_led].pattern, LedPattern::off);
  s.write(6000, {0xFFFF, 0x5FFF, 0, 0});
  s.write(6004, {0x0181, 0, 0, 0});
  s.write(10000, {0x0123, 0, 0x0002});
  s.write(8450, {0x0100, 0, 0x0001, 0x0055});
  s.save();
  s.expect(29, 0).no_tx();
  s.online();
  s.expect_x(0x0F, false);
  EXPECT_EQ(s.plug_in().leds(s.now())[can_run_led].pattern, LedPattern::on);
  s.write(10003, 0x2211);
  s.exchange();
  s.tx(0x123, {0x11, 0x22});
  s.offline();
  EXPECT_EQ(s.plug_in().leds(s.now())[can_run_led].pattern, LedPattern::off);
  // All of it is there after the next start.
  s.restart();
  s.expect(6000, {0xFFFF, 0x5FFF, 0, 0, 0x0181, 0, 0, 0}).expect(10000, {0x0123, 0});
  s.expect(8450, {0x0100, 0, 0x0001, 0x0055, 0, 0, 0});
}

TEST_P(Layer2Settings, FunctionMode_TakesEffectWithTheRestart_UnsavedItIsLost) {
  spec("ME3-MODE-001 ME3-MODE-003 ME3-L2-001", "RJ71-MODE-001");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.expect(21, 405);
  s.write(21, 29);
  s.expect(21, 29).expect(29, 0).expect_bit(25, 8, true);
  s.restart();
  s.expect(21, 405).expect_bit(25, 8, true);
  s.write(21, 29);
  s.save();
  s.restart();
  s.expect(21, 29).expect(25, 0);
  s.write(21, 11);
  s.save();
  s.restart();
  s.expect(21, 11).expect(25, 0);
  s.write(21, 12);
  s.expect(21, 11).expect(29, 0x0040).expect(39, 21);
  s.clear_errors();
  s.write(21, 405);
  s.save();
  s.restart();
  s.expect(21, 405).expect_bit(25, 8, true);
}

TEST_P(Layer2Settings, Defaults_DisableEverySlotAndStopMessage) {
  spec("ME3-L2-002 ME3-L2-003 ME3-L2-041 ME3-L2-045", "RJ71-L2-001 RJ71-STOPMSG-001");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  for (module::BufferAddress slot = 0; slot < 42; ++slot) {
    s.expect(6000 + 4 * slot, {0xFFFF, 0xFFFF, 0, 0});
    s.expect(10000 + 7 * slot, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
    s.expect(5001 + slot, 0);
  }
  for (module::BufferAddress message = 0; message < 4; ++message) {
    s.expect(8450 + 7 * message, {0xFFFF, 0xFFFF, 0, 0, 0, 0, 0});
  }
  s.expect(8350, {0, 0, 0}).expect(8400, {0, 0, 0});
  // What follows the 42 slots, and the TPDO words of 405 mode, is system area.
  for (const module::BufferAddress address : {10294U, 11023U, 13000U, 14023U, 6168U, 5043U, 8478U}) {
    s.write(address, 0x1234);
    s.expect(address, 0);
  }
  s.expect(29, 0);
  s.online();
  s.exchange();
  s.rx(0x000).rx(0x7FF, {1}).rx_remote(0x7FF).advance(1s);
  s.cpu(module::CpuState::stop);
  s.no_tx();
}

TEST(Me3Layer2Settings, CanopenIsOff_ItsWordsReadZero) {
  RecordProperty("spec", "ME3-MODE-005 ME3-MODE-007 ME3-SYS-012");
  IntelligentScenario s;
  s.power_on_layer2();
  s.online();
  s.rx(0x081, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.rx(0x702, {0x05}).rx(0x000, {0x01, 0x00}).rx(0x67F, {0x40, 0, 0x10, 0, 0, 0, 0, 0}).rx_remote(0x77F, 1);
  s.rx(0x000, {0x81, 0x00}).rx(0x000, {0x82, 0x7F}).expect(25, 0).expect_x(0x03, true);
  s.rx(0x080).rx(0x100, {0, 0, 0, 0, 0xA2, 0x2B}).error_counters(130, 0).error_counters(0, 0);
  s.advance(2s);
  s.exchange();
  s.no_tx().expect_x(0x10, false).expect_x(0x11, false);
  for (module::BufferAddress address = 401; address <= 527; ++address) s.expect(address, 0);
  for (module::BufferAddress address = 601; address <= 727; ++address) s.expect(address, 0);
  for (module::BufferAddress address = 750; address <= 859; ++address) s.expect(address, 0);
  for (const module::BufferAddress address : {50U, 59U, 70U, 71U, 400U, 401U, 750U}) {
    s.write(address, 1);
    s.expect(address, 0);
  }
  s.expect(29, 0);
  s.write(27, 1);  // the one word of these that reports it
  s.expect(29, 0x0040).expect(39, 27);
}

TEST(Me3Layer2Settings, CommonWordsAndTheCommandInterface_KeepTheirFunction) {
  RecordProperty("spec", "ME3-MODE-006 ME3-IO-027");
  IntelligentScenario s;
  s.power_on_layer2();
  s.expect(24, 250).expect(37, 2500).expect(25, 0);
  s.write(24, 123);
  s.expect(24, 250).expect(29, 0x0040).expect(39, 24).expect_x(0x0F, true);
  s.y(0x0F, true).y(0x0F, false);
  s.expect(29, 0).expect_x(0x0F, false);
  s.error_counters(100, 3);
  s.expect(35, 100).expect(36, 3).expect(25, 0x0002);
  s.error_counters(3, 130);
  s.expect(36, 128).expect(29, 0x4000);
  s.error_counters(256, 0);
  s.expect(35, 256).expect(36, 256).expect(29, 0x0008).expect_x(0x0F, true);
  s.error_counters(0, 0);
  s.cif({0x0004, 0x1111, 0x2222, 0});
  s.expect(1000, {0x000F, 0x0064});
  s.cif({0x0000});
  s.expect(1000, {0x0000, 0x1111, 0x2222, 0});
  s.cif({0xFFFF});
  s.expect(1000, 0x0000);
  // Signals of 405 mode do nothing, the common ones work.
  for (const unsigned number : {0x10U, 0x11U, 0x12U, 0x13U}) {
    s.y(number, true).advance(10ms);
    s.expect_x(number, false);
    s.y(number, false);
  }
  s.exchange();
  s.save();
  s.write(20, 0x1000);
  s.expect(20, 0);
  s.restart();
  s.expect(25, 0).expect(29, 0).no_tx();
}

TEST_P(Layer2Settings, SignalsOfLayer2_DoNothingIn405Mode) {
  spec("ME3-IO-027 ME3-IO-009", "RJ71-IO-008");
  IntelligentScenario s(GetParam());
  s.power_on();
  s.y(0x03, true).y(0x04, true).advance(1s);
  s.expect_x(0x03, false).expect_x(0x04, false);
  s.restart();  // with Y03 and Y04 ON
  s.expect_x(0x03, false).expect_x(0x04, false).expect_bit(25, 8, true);
  s.y(0x03, false).y(0x04, false);
  // 405 mode has its own there.
  s.write(13000, 7);
  s.y(0x13, true);
  s.expect_x(0x13, true);
  s.y(0x12, true);
  s.expect_x(0x12, true);
  s.rx(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  s.expect_x(0x11, true);
  s.y(0x11, true);
  s.expect_x(0x11, false);
}

TEST_P(Layer2Settings, Y03_OnlineAndOffline) {
  spec("ME3-IO-009 ME3-L2-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x7FFF, 0, 0}).write(10000, {0x0123, 0, 1, 0x55});
  s.write(6004, {0x0181, 0, 0, 0});
  s.write(6008, {0xFFFF, 0x5FFF, 2, 1}).write(10014, {0x0222, 0, 0});
  s.expect_x(0x03, false);
  const auto nothing_happens = [&] {
    s.exchange();
    s.rx_remote(0x123, 1).rx(0x181, {0xA1}).advance(1s);
    s.write(8400, 1).y(0x04, true).advance(1s);
    s.expect_x(0x04, false).y(0x04, false).write(8400, 0);
    s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
    s.no_tx();
  };
  nothing_happens();
  s.online();
  s.exchange();  // the message of the offline time was ignored
  s.tx(0x123, {0x55}).expect(10009, 0);
  s.rx_remote(0x123, 1).tx(0x123, {0x55});
  s.advance(100ms);
  for (int i = 0; i < 10; ++i) s.tx(0x222);
  s.rx(0x181, {0xB1});
  s.offline();
  nothing_happens();
  s.expect(10009, 0);
  s.online();
  s.exchange();
  s.tx(0x123, {0x55}).expect(10009, 0);  // what was not exchanged before going offline is lost
  s.ignore_tx();
}

// A data exchange that is under way when the module goes offline, or online, neither sends nor stores.
TEST_P(Layer2Settings, Y03_DuringADataExchange) {
  spec("ME3-IO-009 ME3-L2-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x5FFF, 0, 0}).write(10000, {0x0123, 0, 1, 0x55});
  s.write(6004, {0x0181, 0, 0, 0});
  s.online();
  s.rx(0x181, {0xA1});
  s.y(0x01, true);
  s.offline();
  s.wait_x(0x01, true).no_tx().expect(10009, 0);
  s.y(0x01, false).y(0x01, true);
  s.online();
  s.wait_x(0x01, true).no_tx().expect(10009, 0);
  s.y(0x01, false);
  s.exchange();
  s.tx(0x123, {0x55}).no_tx();
}

TEST_P(Layer2Settings, Y03_LeftOn_GoesOnlineAgainAfterARestart) {
  spec("ME3-IO-009", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.online();
  s.y(0x02, true);
  s.expect_x(0x03, false);
  s.wait_x(0x02, true);
  s.y(0x02, false);
  s.expect_x(0x03, true);
}

TEST(Me3Layer2Settings, S54_ConfigurationWhileOnline_IsRefused) {
  RecordProperty("spec", "ME3-IO-010 ME3-L2-008 ME3-IO-012 ME3-IO-013 ME3-ERR-009");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0x0181, 0, 0, 0});
  s.online();
  s.write(6000, 0x0200);
  s.expect(6000, 0x0181).expect(29, 0x0020).expect(40, 6000).expect(39, 0).expect_x(0x0F, true);
  // Every word of the configuration; the first address stays.
  for (module::BufferAddress address = 6000; address <= 6167; ++address) {
    const std::uint16_t before = s.read(address);
    s.write(address, 1);
    s.expect(address, before);
  }
  for (module::BufferAddress address = 8450; address <= 8477; ++address) {
    const std::uint16_t before = s.read(address);
    s.write(address, 1);
    s.expect(address, before);
  }
  for (module::BufferAddress slot = 0; slot < 42; ++slot) {
    s.write(10000 + 7 * slot, {1, 1});
    s.expect(10000 + 7 * slot, {0xFFFF, 0xFFFF});
  }
  s.expect(29, 0x0020).expect(40, 6000);
  s.offline();
  s.expect(29, 0x0020).expect_x(0x0F, true);  // latched
  s.online();
  s.y(0x0F, true);
  s.expect(29, 0).expect(40, 0).expect_x(0x0F, false);
  s.y(0x0F, false);
  s.write(8452, 1);
  s.expect(29, 0x0020).expect(40, 8452);
  s.write(29, 0);
  s.expect(29, 0).expect(40, 0);
  s.write(10007, 5);
  s.expect(40, 10007);
  s.write(29, 0);
  s.offline();
  s.write(6000, 0x0200).write(8452, 1).write(10007, 5);
  s.expect(6000, 0x0200).expect(8452, 1).expect(10007, 5).expect(29, 0).expect_x(0x0F, false);
}

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

TEST(Me3Layer2Settings, LatchedBits_StayUntilCleared_ByY0FOrBy0) {
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

TEST(Me3Layer2Settings, OtherBits_FollowTheirCause_AndNotEachRaisesX0F) {
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

TEST(Me3Layer2Settings, TriggersDataAndFlags_AreWrittenOnline) {
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

TEST_P(Layer2Settings, GoodValues_OfBothModes) {
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
TEST(Me3Layer2Settings, FirstWrongWord_IsShown_WhicheverOrderTheyWereWrittenIn) {
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
TEST(Me3Layer2Settings, FrameWord_BeforeTheSlotIsSetUp) {
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

TEST_P(Layer2Settings, DisabledSlot_NeitherSendsNorReceives) {
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

TEST(Me3Layer2Settings, Save_KeepsModeRateParametersStopMessagesAndCanIds_NothingElse) {
  RecordProperty("spec", "ME3-SAVE-006 ME3-SAVE-007");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(24, 125);
  for (std::uint16_t slot = 0; slot < 42; ++slot) {
    s.write(6000 + 4U * slot, {0xFFFF, 0x5FFF, 4, static_cast<std::uint16_t>(slot + 1)});
    s.write(10000 + 7U * slot, {static_cast<std::uint16_t>(0x100 + slot), 0, 8, 1, 2, 3, 4});
  }
  for (std::uint16_t message = 0; message < 4; ++message) {
    s.write(8450 + 7U * message, {static_cast<std::uint16_t>(0x10 + message), 0, 8, 1, 2, 3, 4});
  }
  s.write(8400, {1, 1, 1});
  s.write(20, 0x100).write(1000, {0, 7, 8});
  s.save();
  s.supply_off().supply_on();
  s.wait_bit(25, 7, false);
  s.expect(21, 11).expect(24, 125).expect(37, 1250);
  for (std::uint16_t slot = 0; slot < 42; ++slot) {
    s.expect(6000 + 4U * slot, {0xFFFF, 0x5FFF, 4, static_cast<std::uint16_t>(slot + 1)});
    s.expect(10000 + 7U * slot, {static_cast<std::uint16_t>(0x100 + slot), 0, 0, 0, 0, 0, 0});
  }
  for (std::uint16_t message = 0; message < 4; ++message) {
    s.expect(8450 + 7U * message, {static_cast<std::uint16_t>(0x10 + message), 0, 8, 1, 2, 3, 4});
  }
  s.expect(8400, {0, 0, 0}).expect(8350, {0, 0, 0}).expect(5001, 0);
  s.expect(20, 0).expect(22, 0).expect(25, 0).expect(29, 0).expect(35, {0, 0}).expect(39, {0, 0});
  s.expect(1000, {0, 0, 0}).no_tx();
  // G22.1 puts them back to the defaults in the buffer memory, the flash memory keeps its content.
  s.save(2);
  s.expect(6000, {0xFFFF, 0xFFFF, 0, 0}).expect(10000, {0xFFFF, 0xFFFF}).expect(8450, {0xFFFF, 0xFFFF, 0, 0});
  s.expect(24, 250).expect(21, 405);
  s.restart();
  s.expect(6000, {0xFFFF, 0x5FFF, 4, 1}).expect(10000, {0x0100, 0}).expect(21, 11);
}

// G22.1 while online: the words get their defaults, the module goes on with what it went online with.
TEST(Me3Layer2Settings, RestoreWhileOnline_ActsOnTheWords_NotOnTheSlots) {
  RecordProperty("spec", "ME3-SAVE-002 ME3-SAVE-003 ME3-L2-008 ME3-L2-005 ME3-L2-040");
  for (const std::uint16_t bits : Words{2, 3}) {
    IntelligentScenario s;
    s.power_on_layer2();
    s.write(6000, {0xFFFF, 0x7FFF, 0, 0}).write(10000, {0x0123, 0, 1, 0x55});
    s.write(6004, {0x0181, 0, 0, 0});
    s.write(6008, {0xFFFF, 0x5FFF, 2, 10}).write(10014, {0x0124, 0, 1, 0x66});
    s.write(8450, {0x0100, 0, 1, 1}).write(8471, {0x0101, 0, 1, 2});
    s.online();
    s.save(bits);  // 100 ms
    s.tx(0x124, {0x66}).expect(6000, {0xFFFF, 0xFFFF, 0, 0, 0xFFFF, 0xFFFF}).expect(10000, {0xFFFF, 0xFFFF});
    s.expect(8450, {0xFFFF, 0xFFFF, 0, 0}).expect_x(0x03, true).expect(29, 0);
    s.write(10003, 0x77).rx(0x181, {0xA1});
    s.exchange();
    s.tx(0x123, {0x77}).expect(10007, {0x0181, 0, 0x0301, 0x00A1}).no_tx();
    s.rx_remote(0x123, 1).tx(0x123, {0x77});
    s.cpu(module::CpuState::stop).cpu(module::CpuState::run);
    s.tx(0x100, {1}).tx(0x101, {2}).no_tx();
    s.offline().online();  // now with the defaults
    s.exchange();
    s.rx_remote(0x123, 1).cpu(module::CpuState::stop).advance(1s).no_tx();
  }
}

TEST(Me3Layer2Settings, FlagsAndErrorCodes_AreNotSaved) {
  RecordProperty("spec", "ME3-SAVE-007");
  IntelligentScenario s;
  s.power_on_layer2();
  s.write(6000, {0xFFFF, 0x6FFF, 4, 0}).write(10000, {0x0123, 0, 1});
  s.write(6004, {0x0181, 0, 0, 0});
  s.online();
  s.rx_remote(0x123, 1);
  for (int i = 0; i < 20; ++i) s.rx(0x181, {1});
  s.exchange();
  s.write(8400, {1, 1, 1});
  s.expect(8350, 1).expect(5002, 0x2000).expect(10009, 0x0701).expect(29, 0x8000);
  s.save();
  s.supply_off().supply_on();
  s.wait_bit(25, 7, false);
  s.expect(8350, {0, 0, 0}).expect(8400, {0, 0, 0}).expect(5001, {0, 0}).expect(10009, {0, 0}).expect(29, 0);
}

TEST(Me3Layer2Settings, UnsavedWords_OfCanopenModeStartAtTheirDefault) {
  RecordProperty("spec", "ME3-SAVE-007");
  IntelligentScenario s;
  s.power_on_as(1);
  s.write(20, 0x1000).write(50, {2, 20, 5, 6, 7, 8, 9}).write(58, 5).write(400, 3).write(13000, {1, 2});
  s.write(1000, {0, 7, 8});
  s.set_object(0x1016, 1, 0x00020064, 4);
  s.rx(0x702, {0x05}).rx(0x085, {0x30, 0x81, 0x11, 1, 2, 3, 4, 5});
  s.write(20, 0);
  s.exchange();
  s.expect(750, 5);
  s.advance(1s);
  s.expect_bit(402, 7, true);
  s.save();
  s.supply_off().supply_on();
  s.wait_bit(25, 7, false);
  s.ignore_tx();
  s.expect(20, 0).expect(22, 0).expect(25, 0x0100).expect(29, 0).expect(35, {0, 0}).expect(39, {0, 0});
  s.expect(50, {1, 14, 8, 1, 0, 0, 0, 5, 0}).expect(400, 0).expect(750, 0).expect(751, 0);
  for (module::BufferAddress node = 1; node <= 127; ++node) s.expect(400 + node, 0);
  for (module::BufferAddress node = 2; node <= 126; ++node) s.expect(600 + node, 0);
  for (module::BufferAddress word = 1000; word <= 1066; ++word) s.expect(word, 0);
  s.expect(10000, {0, 0}).expect(13000, {0, 0});
}

TEST_P(Layer2Settings, PowerDownMessages_DoNotExist) {
  spec("ME3-L2-043", "");
  IntelligentScenario s(GetParam());
  s.power_on_layer2();
  s.write(8450, {0x0100, 0, 1, 0x55});
  for (module::BufferAddress address = 8478; address < 8600; ++address) {
    s.write(address, 0x0101);
    s.expect(address, 0);
  }
  s.expect(29, 0);
  s.online();
  s.supply_off();
  s.no_tx();
}

}  // namespace
}  // namespace canopus::scenario
