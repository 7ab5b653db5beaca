// Two modules that the house does not have yet, as far as tables make them: the engine takes both.

#include "scenarios/engine/as_fcopm_sketch.hpp"
#include "scenarios/engine/fx3u_can_sketch.hpp"
#include "scenarios/engine/other_models.hpp"

namespace canopus::scenario {
namespace {

using Fx3uCan = OtherScenario<Fx3uCanSketch>;

void start(ModuleScenario& s, std::uint32_t boot_up = 0x77F) {
  s.supply_on().expect_bit(25, 7, true).wait_bit(25, 7, false).tx(boot_up, {0x00});
}

TEST(Fx3uCanSketch, StartsAsNode127At250KilobitPerSecond_AndHasNoSignals) {
  Fx3uCan s;
  start(s);
  s.expect(30, 7170).expect(21, 405).expect(24, 250).expect(27, 127).expect(25, 1U << 8);
  EXPECT_EQ(s.plug_in().signals(), nullptr);
  EXPECT_EQ(s.plug_in().registers(), nullptr);
  EXPECT_EQ(s.plug_in().buffer_memory_size(), 32768U);
  EXPECT_EQ(s.controller().rate, 250'000U);
}

// One number is two words: FROM 0 reads what RPDO1 brought, TO 0 writes what TPDO1 sends.
TEST(Fx3uCanSketch, FromAndToReachDifferentWords_ExchangedByABitOfBfm20) {
  Fx3uCan s;
  start(s);
  s.rx(0x000, {0x01, 0x00}).rx(0x27F, {0x34, 0x12, 0, 0, 0x78, 0x56, 0, 0});
  s.write(0, 0x5678).write(19, 0x0102).expect(0, 0).expect(11000, 0x5678).expect(11019, 0x0102);
  s.write(20, 1).advance(1ms).expect(20, 0);
  s.expect(0, 0x1234).expect(2, 0x5678).expect(10000, 0x1234).expect(11000, 0x5678);
  s.tx(0x1FF, {0x78, 0x56, 0, 0, 0, 0, 0, 0});
  s.write(100, 0xAAAA).expect(11020, 0xAAAA).expect(100, 0);
}

TEST(Fx3uCanSketch, SavesByBfm22_AndRestartsByBfm25) {
  Fx3uCan s;
  start(s);
  s.write(27, 5).write(22, 1).expect(22, 1).advance(100ms).expect(22, 0);
  s.write(25, 1).tx(0x0FF, {0x00, 0x62, 0x81, '4', '0', '0', 'X', 'F'}).expect_bit(25, 7, true);
  s.wait_bit(25, 7, false).tx(0x705, {0x00}).expect(27, 5);
}

TEST(Fx3uCanSketch, CommandsRunWhenTheirCodeIsWritten) {
  Fx3uCan s;
  start(s);
  s.write(1001, {0, 0x1000, 0}).write(1000, 0x0004).expect(1000, 0xFFFF).advance(1ms);
  s.expect(1000, {0x0005, 0, 0x1000, 0, 4, 405, 0});
}

// Two nodes in a word: the odd one in the low byte, the even one in the high byte.
TEST(Fx3uCanSketch, ErrorControlOfTwoNodesIsOneWord) {
  Fx3uCan s;
  start(s);
  s.write(1001, {0, 0x1016, 1, 4, 200, 6}).write(1000, 0x0002).advance(1ms).expect(1000, 0x0003);
  s.rx(0x706, {0x05}).advance(150ms).expect(902, 0x0200).advance(100ms);
  s.expect(902, 0x8200).expect_bit(29, 10, true).expect_bit(29, 0, true).ignore_tx();
  s.write(29, 0).expect(29, 0).expect(902, 0x0200);
}

// In the Layer 2 modes the same numbers are messages; bit 4 of #25 takes the module online.
TEST(Fx3uCanSketch, InLayer2Mode_TheNumbersFrom100AreMessages) {
  Fx3uCan s;
  start(s);
  s.write(21, 29).write(22, 1).advance(100ms).write(25, 1).ignore_tx().wait_bit(25, 7, false);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::offline);
  // Slot 1: 29-bit identifier, no remote frames, by data exchange, two bytes.
  s.write(1100, {0xFFFF, 0x5FFF, 0, 0}).write(100, {0x5678, 0x1234, 2, 0xBBAA, 0, 0, 0}).expect(103, 0xBBAA);
  s.write(25, 1U << 4);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::online);
  s.ignore_tx().write(20, 1).advance(1ms);
  can::Frame frame;
  frame.identifier = 0x12345678;
  frame.extended = true;
  frame.dlc = 2;
  frame.data = {0xAA, 0xBB};
  s.tx(frame).write(25, 0);
  EXPECT_EQ(s.plug_in().layer2_state(), module::Layer2State::offline);
}

class AsFcopm : public testing::Test, public OtherScenario<AsFcopmSketch> {
 protected:
  void SetUp() override {
    supply_on().advance(2s).wait_tx(0x701, {0x00});
    rx(0x000, {0x01, 0x00}).advance(3ms).tx(0x202, {0, 0, 0, 0, 0, 0, 0, 0});
  }
  std::uint16_t d(std::uint32_t number) {
    return registers().read_register(module::RegisterKind::data, number, now());
  }
  std::uint16_t sr(std::uint32_t number) {
    return registers().read_register(module::RegisterKind::special, number, now());
  }
  void set_d(std::uint32_t number, std::uint16_t value) {
    registers().write_register(module::RegisterKind::data, number, value, now());
  }

 private:
  module::RegisterAccess& registers() { return *plug_in().registers(); }
};

TEST_F(AsFcopm, HasRegistersAndNothingElse) {
  EXPECT_EQ(plug_in().buffer_memory(), nullptr);
  EXPECT_EQ(plug_in().signals(), nullptr);
  ASSERT_NE(plug_in().registers(), nullptr);
  EXPECT_EQ(plug_in().registers()->registers().size(), 3U);
  EXPECT_EQ(controller().rate, 500'000U);
  set_d(26000, 1);
  EXPECT_EQ(d(26000), 0U) << "not a register of the module";
}

TEST_F(AsFcopm, ProcessDataAreExchangedWithoutBeingAsked) {
  rx(0x182, {0x34, 0x12, 0, 0, 0, 0, 0, 0});
  set_d(25032, 0xBEEF);
  advance(3ms);
  EXPECT_EQ(d(24032), 0x1234U);
  tx(0x202, {0xEF, 0xBE, 0, 0, 0, 0, 0, 0});
}

TEST_F(AsFcopm, EmergenciesOfASlaveAreReadByAMessage_TheLatestFive) {
  for (std::uint8_t n = 1; n <= 6; ++n) rx(0x082, {n, 0x10, 0x01, n, 0, 0, 0, 0});
  EXPECT_EQ(sr(831), 0xE0U);
  EXPECT_EQ(sr(826), 1U << 1);
  set_d(25001, 0);
  set_d(25002, 0x0402);
  set_d(25000, 0x0101);
  EXPECT_EQ(d(24000), 0x0101U) << "ResID 1, success";
  EXPECT_EQ(d(24001), 42U);
  EXPECT_EQ(d(24002), 0x0402U);
  EXPECT_EQ(d(24003), 0x0605U) << "six came, five are stored";
  EXPECT_EQ(d(24004), 0x1006U);
  EXPECT_EQ(d(24005), 0x0601U);
  EXPECT_EQ(d(24020), 0x1002U);
  rx(0x082, {0x00, 0x00, 0x00, 0, 0, 0, 0, 0});
  EXPECT_EQ(sr(831), 0U);
  EXPECT_EQ(sr(826), 0U);
}

TEST_F(AsFcopm, AMessageThatIsNoneIsAnsweredWithItsStatus) {
  set_d(25002, 0x0902);
  set_d(25000, 0x0101);
  EXPECT_EQ(d(24000), 0x0108U) << "illegal type";
  set_d(25000, 0x0202);
  EXPECT_EQ(d(24000), 0x0204U) << "illegal command code";
  set_d(25000, 0x0201);
  EXPECT_EQ(d(24000), 0x0204U) << "the same ReqID asks for nothing";
}

}  // namespace
}  // namespace canopus::scenario
