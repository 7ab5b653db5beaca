// A module that the house does not have yet, as far as tables make it: the engine takes it.

#include "scenarios/engine/as_fcopm_sketch.hpp"
#include "scenarios/engine/other_models.hpp"

namespace canopus::scenario::engine_sketches_test {
namespace {

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
}  // namespace canopus::scenario::engine_sketches_test
