// Timers and counters, scan by scan: contact, coil and value.

#include "list_plc.hpp"

namespace canopus::list_timers_test {
namespace {

using list_plc::Family;
using list_plc::ListPlc;

// The clock of a 100 ms timer runs freely: here it ticks at 0.1 s, 0.2 s ... Scans are 10 ms.
TEST(ListTimer, CountsTicksOfItsClock_FromTheSecondExecutionOn) {
  ListPlc plc(Family::q, {"LD M0", "OUT T0 K2", "LD T0", "OUT M1"});
  EXPECT_EQ(plc.run(5), "");  // to 0.05 s
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("TC0"), 1);
  EXPECT_EQ(plc.get("TN0"), 0);
  EXPECT_EQ(plc.run(5), "");  // the scan at 0.1 s is over
  EXPECT_EQ(plc.get("TN0"), 1);
  EXPECT_EQ(plc.get("TS0"), 0);
  EXPECT_EQ(plc.run(9), "");
  EXPECT_EQ(plc.get("TN0"), 1);
  EXPECT_EQ(plc.run(), "");  // that at 0.2 s
  EXPECT_EQ(plc.get("TN0"), 2);
  EXPECT_EQ(plc.get("TS0"), 1);
  EXPECT_EQ(plc.get("M1"), 1);
  EXPECT_EQ(plc.run(20), "");
  EXPECT_EQ(plc.get("TN0"), 2) << "it stays at the setting";
  plc.set("M0", 0);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("TN0"), 0);
  EXPECT_EQ(plc.get("TS0"), 0);
  EXPECT_EQ(plc.get("TC0"), 0);
  EXPECT_EQ(plc.get("M1"), 0);
}

TEST(ListTimer, AContactAboveTheCoil_IsAScanLate) {
  ListPlc plc(Family::q, {"LD T0", "OUT M1", "LD M0", "OUTH T0 K1", "LD T0", "OUT M2"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.get("M1"), 0);
  EXPECT_EQ(plc.get("M2"), 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("M1"), 1);
}

TEST(ListTimer, SettingZero_TimesOutWithTheInstruction) {
  ListPlc plc(Family::q, {"LD M0", "OUT T0 K0", "LD T0", "OUT M1"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("M1"), 1);
}

TEST(ListTimer, ALargerSettingAfterTheTimeOut_ChangesNothing) {
  ListPlc plc(Family::q, {"LD M0", "OUTH T0 D0"});
  plc.set("D0", 2);
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.get("TS0"), 1);
  plc.set("D0", 100);
  EXPECT_EQ(plc.run(5), "");
  EXPECT_EQ(plc.get("TS0"), 1);
  EXPECT_EQ(plc.get("TN0"), 2);
}

TEST(ListTimer, AfterRun_TheTimeInStopDoesNotCount) {
  ListPlc plc(Family::q, {"LD M0", "OUTH T0 K50"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.get("TN0"), 2);
  plc.machine->warm_start();
  plc.now += 10'000'000'000;
  EXPECT_EQ(plc.run(2), "");
  EXPECT_EQ(plc.get("TN0"), 3);
}

TEST(ListTimer, ARetentiveOne_KeepsItsValueUntilReset) {
  ListPlc plc(Family::fx5, {"LD M0", "OUTH ST0 K4", "LD M2", "RST ST0"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.get("STN0"), 2);
  plc.set("M0", 0);
  EXPECT_EQ(plc.run(10), "");
  EXPECT_EQ(plc.get("STN0"), 2);
  EXPECT_EQ(plc.get("STC0"), 0);
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.get("STN0"), 4);
  EXPECT_EQ(plc.get("STS0"), 1);
  plc.set("M0", 0);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("STS0"), 1);
  plc.set("M2", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("STS0"), 0);
  EXPECT_EQ(plc.get("STN0"), 0);
}

// T0 to T199 100 ms, T200 to T245 10 ms, T246 to T249 1 ms retentive, T250 to T255 100 ms retentive, T256 to T511 1 ms.
TEST(ListTimer, OfAnFx3_HasItsUnitByItsNumber) {
  ListPlc plc(Family::fx3,
              {"LD M0", "OUT T199 K1000", "OUT T200 K1000", "OUT T245 K1000", "OUT T246 K1000",
               "OUT T249 K1000", "OUT T250 K1000", "OUT T255 K1000", "OUT T256 K1000", "OUT T511 K1000"});
  plc.set("M0", 1);
  EXPECT_EQ(plc.run(21), "");  // 0 s to 0.2 s
  EXPECT_EQ(plc.get("TN199"), 2);
  EXPECT_EQ(plc.get("TN200"), 20);
  EXPECT_EQ(plc.get("TN245"), 20);
  EXPECT_EQ(plc.get("TN246"), 200);
  EXPECT_EQ(plc.get("TN249"), 200);
  EXPECT_EQ(plc.get("TN250"), 2);
  EXPECT_EQ(plc.get("TN255"), 2);
  EXPECT_EQ(plc.get("TN256"), 200);
  EXPECT_EQ(plc.get("TN511"), 200);
  plc.set("M0", 0);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("TN245"), 0);
  EXPECT_EQ(plc.get("TN246"), 200);
  EXPECT_EQ(plc.get("TN255"), 2);
  EXPECT_EQ(plc.get("TN256"), 0);
}

TEST(ListTimer, ValueIsAWord_AndContactABit) {
  ListPlc plc(Family::q, {"LD SM400", "OUTH T0 K3", "MOV T0 D0", "LD> T0 K1", "OUT M1", "LDI T0", "OUT M2"});
  plc.set("SM400", 1);
  EXPECT_EQ(plc.run(3), "");
  EXPECT_EQ(plc.get("D0"), 2);
  EXPECT_EQ(plc.get("M1"), 1);
  EXPECT_EQ(plc.get("M2"), 1);
}

TEST(ListCounter, CountsRisingEdges_UpToItsSetting) {
  ListPlc plc(Family::q, {"LD M0", "OUT C0 K2", "LD M2", "RST C0", "LD C0", "OUT M1"});
  for (int edge = 1; edge <= 3; ++edge) {
    plc.set("M0", 1);
    EXPECT_EQ(plc.run(2), "");
    EXPECT_EQ(plc.get("CN0"), std::min(edge, 2));
    EXPECT_EQ(plc.get("CC0"), 1);
    EXPECT_EQ(plc.get("M1"), edge >= 2 ? 1 : 0);
    plc.set("M0", 0);
    EXPECT_EQ(plc.run(), "");
    EXPECT_EQ(plc.get("CC0"), 0);
  }
  plc.set("M2", 1);
  EXPECT_EQ(plc.run(), "");
  EXPECT_EQ(plc.get("CN0"), 0);
  EXPECT_EQ(plc.get("M1"), 0);
}

TEST(ListCounter, OfAnFx3From200On_Has32BitsAndCountsDownToo) {
  ListPlc plc(Family::fx3, {"LD M0", "OUT C200 K65537", "DMOV C200 D0", "LD C200", "OUT M1"});
  const auto edge = [&] {
    plc.set("M0", 1);
    EXPECT_EQ(plc.run(), "");
    plc.set("M0", 0);
    EXPECT_EQ(plc.run(), "");
  };
  plc.set("CN200", 65535);
  edge();
  EXPECT_EQ(plc.double_word("D", 0), 65536);
  EXPECT_EQ(plc.get("M1"), 0);
  edge();
  EXPECT_EQ(plc.double_word("D", 0), 65537);
  EXPECT_EQ(plc.get("M1"), 1);
  plc.set("M8200", 1);
  edge();
  EXPECT_EQ(plc.double_word("D", 0), 65536);
  EXPECT_EQ(plc.get("M1"), 0);
}

}  // namespace
}  // namespace canopus::list_timers_test
