// What clients of the control server wait for: scans, time, conditions. The test is the loop that runs the plant.

#include "canopus/serve/plant_runs.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/serve/run_control.hpp"

namespace canopus::serve::plant_runs_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::string_view one_plc =
    "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[plc]]\nname = \"plc1\"\nlisten = \"off\"\nscan = \"5ms\"\n"
    "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nbus = \"a\"\nnode = 1\n";

class PlantRunsTest : public ::testing::Test, public plant::PlantObserver {
 protected:
  void start(PlantRuns::Order order, std::string_view text = one_plc) {
    const plant::PlantReading reading = plant::read_plant(text, "plant.toml");
    ASSERT_THAT(reading.errors, IsEmpty());
    auto built = plant::Plant::build(reading.plant, *this);
    ASSERT_TRUE(built.has_value());
    plant_ = std::move(*built);
    plant_->power_on();
    runs_ = std::make_unique<PlantRuns>(*plant_, order, [this] { ++over_; });
    control_ = std::make_unique<RunControl>(*plant_, *runs_);
  }
  /// Answers come into answers_, behind the name of who asked.
  ControlServer::CallOff request(const std::string& line, const std::string& who = "") {
    return control_->answer(line, [this, who](std::string answer) { answers_.push_back(who + answer); });
  }
  std::string answer(const std::string& line) {
    const std::size_t before = answers_.size();
    (void)request(line);
    return answers_.size() == before ? "waits" : answers_.back();
  }
  void run_until(can::Duration time) {
    plant_->timeline().run_until(can::Time{time});
    runs_->report();
  }
  /// As a plant that is driven in step: as far as somebody wants it to.
  void run_in_step() {
    while (runs_->wants_time()) {
      plant_->timeline().run_until(runs_->next());
      runs_->report();
    }
  }
  [[nodiscard]] can::Duration now() const { return plant_->timeline().now().time_since_epoch(); }
  void set_d0(std::uint16_t value) {
    ASSERT_TRUE(plant_->rack(0).write_words(plc::Device::d, 0, {&value, 1}, plant_->timeline().now()));
  }

  std::unique_ptr<plant::Plant> plant_;
  std::unique_ptr<PlantRuns> runs_;
  std::unique_ptr<RunControl> control_;
  std::vector<std::string> answers_;
  int over_ = 0;
};

TEST_F(PlantRunsTest, Scans_EndAtTheEndOfAScan) {
  start(PlantRuns::Order::in_turn);
  EXPECT_EQ(answer(R"({"request":"run","scans":3,"id":7})"), "waits");
  run_in_step();
  EXPECT_EQ(now(), 15ms);
  EXPECT_THAT(answers_, ElementsAre("{\"id\":7,\"ok\":true,\"t\":0.015,\"scans\":3}\n"));
}

TEST_F(PlantRunsTest, ATime_EndsToTheNanosecond_AndTheNextScanOnTheGrid) {
  start(PlantRuns::Order::in_turn);
  (void)request(R"({"request":"run","for":"12ms"})");
  run_in_step();
  EXPECT_EQ(now(), 12ms);
  (void)request(R"({"request":"run","scans":1})");
  run_in_step();
  EXPECT_EQ(now(), 15ms);
  EXPECT_THAT(answers_, ElementsAre(HasSubstr("\"scans\":2}"), HasSubstr("\"scans\":1}")));
}

TEST_F(PlantRunsTest, NoScans_AreOverAtOnce) {
  start(PlantRuns::Order::in_turn);
  (void)request(R"({"request":"run","scans":0})");
  EXPECT_FALSE(runs_->wants_time());
  runs_->report();
  EXPECT_THAT(answers_, ElementsAre(HasSubstr("\"t\":0.0,\"scans\":0}")));
}

TEST_F(PlantRunsTest, ACondition_EndsWithTheScanInWhichItHolds) {
  start(PlantRuns::Order::in_turn);
  (void)request(R"({"request":"run","until":"X0","for":"10s"})");  // the module is ready after its restart
  run_in_step();
  EXPECT_THAT(answers_.back(), HasSubstr("\"met\":true}"));
  EXPECT_EQ(now() % 5ms, 0ms);
  EXPECT_GT(now(), 0ms);
  EXPECT_LT(now(), 10s);
  (void)request(R"({"request":"run","until":"X0"})");
  runs_->report();
  EXPECT_THAT(answers_.back(), HasSubstr("\"scans\":0,\"met\":true}")) << "it holds already";
}

TEST_F(PlantRunsTest, AConditionThatDoesNotComeInTime_IsNoError) {
  start(PlantRuns::Order::in_turn);
  (void)request(R"({"request":"run","until":"D0 == 1","scans":4})");
  run_in_step();
  EXPECT_THAT(answers_, ElementsAre("{\"ok\":true,\"t\":0.02,\"scans\":4,\"met\":false}\n"));
}

TEST_F(PlantRunsTest, ConditionsCompareAsTheyAreWritten) {
  start(PlantRuns::Order::in_turn);
  set_d0(0xFFFF);
  const auto holds = [this](const std::string& condition) {
    (void)request(R"({"request":"run","scans":0,"until":")" + condition + "\"}");
    runs_->report();
    return answers_.back().find("\"met\":true") != std::string::npos;
  };
  for (const char* condition :
       {"D0 == 65535", "d0==-1", "D0 == 0xFFFF", "D0 < -0", "D0 > 5", "D0 >= 65535", "D0 <= -1", "D0 != 3",
        "M5 == OFF", "M5 != 1", "SM400", "Y1F == 0", R"(U0\\G21 == 405)", "U0/G21 >= 405"}) {
    EXPECT_TRUE(holds(condition)) << condition;
  }
  for (const char* condition : {"D0 == 1", "D0 < 5", "D0 > -1", "D0 <= 65534", "M5", "X1F == ON"}) {
    EXPECT_FALSE(holds(condition)) << condition;
  }
}

TEST_F(PlantRunsTest, InTurn_OneWaitsForTheOther) {
  start(PlantRuns::Order::in_turn);
  (void)request(R"({"request":"run","scans":2})", "a ");
  (void)request(R"({"request":"run","scans":1})", "b ");
  run_in_step();
  EXPECT_THAT(answers_,
              ElementsAre(HasSubstr("a {\"ok\":true,\"t\":0.01,"), HasSubstr("b {\"ok\":true,\"t\":0.015,")));
}

TEST_F(PlantRunsTest, SideBySide_TheyBeginAtOnce_AndThePlantGoesOnByItself) {
  start(PlantRuns::Order::side_by_side);
  (void)request(R"({"request":"run","scans":2})", "a ");
  (void)request(R"({"request":"run","scans":1})", "b ");
  (void)request(R"({"request":"run","for":"7ms"})", "c ");
  run_until(5ms);
  EXPECT_THAT(answers_, ElementsAre(HasSubstr("b ")));
  EXPECT_EQ(over_, 1);
  run_until(12ms);
  EXPECT_EQ(answers_.size(), 3U);
}

TEST_F(PlantRunsTest, SideBySide_AConditionThatHeldForOneScan_IsSeenByAPlantThatLags) {
  start(PlantRuns::Order::side_by_side);
  (void)request(R"({"request":"run","until":"SM402 == OFF"})");
  run_until(5s);
  EXPECT_THAT(answers_, ElementsAre(HasSubstr("\"scans\":1,\"met\":true}")));
}

TEST_F(PlantRunsTest, WhoLeaves_WantsNoMoreTime_AndTheNextOneBegins) {
  start(PlantRuns::Order::in_turn);
  const auto call_off = request(R"({"request":"run","for":"1h"})", "a ");
  (void)request(R"({"request":"run","scans":1})", "b ");
  plant_->timeline().run_until(can::Time{20ms});
  call_off();
  run_in_step();
  EXPECT_EQ(now(), 25ms);
  EXPECT_THAT(answers_, ElementsAre(HasSubstr("b ")));
}

TEST_F(PlantRunsTest, TheEndOfThePlant_IsAnErrorForWhoWaits) {
  start(PlantRuns::Order::in_turn);
  (void)request(R"({"request":"run","scans":100})", "a ");
  (void)request(R"({"request":"run","scans":1})", "b ");
  plant_->timeline().run_until(can::Time{20ms});
  runs_->end_all();
  runs_->report();
  EXPECT_THAT(answers_, ElementsAre(HasSubstr("the run of the plant ended first, 4 scans later"),
                                    HasSubstr("the run of the plant ended first, 0 scans later")));
  EXPECT_FALSE(runs_->wants_time());
}

TEST_F(PlantRunsTest, WrongRequests_AreAnsweredInWords) {
  start(PlantRuns::Order::in_turn);
  const auto wrong = [this](const std::string& fields) {
    return answer("{\"request\":\"run\"" + fields + "}");
  };
  EXPECT_THAT(wrong(""), HasSubstr(R"(expected \"scans\", \"for\" or \"until\")"));
  EXPECT_THAT(wrong(",\"scans\":-1"), HasSubstr("scans: expected a number from 0 on"));
  EXPECT_THAT(wrong(",\"scans\":1.5"), HasSubstr("scans: expected a number from 0 on"));
  EXPECT_THAT(wrong(",\"scans\":\"1\""), HasSubstr("scans: expected a number from 0 on"));
  EXPECT_THAT(wrong(",\"for\":3"), HasSubstr("\"error\":\"for: expected a string\""));
  EXPECT_THAT(wrong(",\"for\":\"0s\""), HasSubstr("for: expected more than 0"));
  EXPECT_THAT(wrong(",\"scan\":3"), HasSubstr(R"(\"scan\" is no field of this request)"));
  EXPECT_THAT(wrong(",\"plc\":\"plc2\",\"scans\":1"),
              HasSubstr(R"(no PLC \"plc2\"; did you mean \"plc1\"?)"));
  EXPECT_THAT(wrong(",\"until\":\"Q1\""), HasSubstr("until: 'Q1' is no device"));
  EXPECT_THAT(wrong(",\"until\":\"D0\""), HasSubstr("is a word and needs a comparison"));
  EXPECT_THAT(wrong(",\"until\":\"D0 = 1\""), HasSubstr("has none of == != < <= > >="));
  EXPECT_THAT(wrong(",\"until\":\"D0 == 70000\""), HasSubstr("'70000' is no 16-bit value"));
  EXPECT_THAT(wrong(",\"until\":\"M0 == 2\""), HasSubstr("'2' is no bit"));
  EXPECT_THAT(wrong(",\"until\":\"D18432 == 1\""), HasSubstr("D18432 is beyond the CPU's last one"));
  EXPECT_THAT(wrong(",\"until\":\"ST0 == 1\""), HasSubstr("expected a device"));
  EXPECT_THAT(wrong(",\"until\":\"U2/G0 == 1\""), HasSubstr("there is no module at this head address"));
  EXPECT_FALSE(runs_->wants_time());
  EXPECT_THAT(answer(R"({"request":"walk"})"), HasSubstr("\\\"walk\\\" is unknown"));
}

TEST_F(PlantRunsTest, WithoutAPlc_TimeAloneCanBeWaitedFor) {
  start(PlantRuns::Order::in_turn, "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n");
  EXPECT_THAT(answer(R"({"request":"run","scans":1})"), HasSubstr("the plant has no PLC"));
  (void)request(R"({"request":"run","for":"1ms"})");
  run_in_step();
  EXPECT_EQ(answers_.back(), "{\"ok\":true,\"t\":0.001}\n");
}

TEST_F(PlantRunsTest, OfSeveralPlcs_OneIsNamed) {
  start(PlantRuns::Order::in_turn,
        "[[bus]]\nname = \"a\"\nbit_rate = 250_000\n[[plc]]\nname = \"one\"\nlisten = \"off\"\n"
        "[[plc]]\nname = \"two\"\nlisten = \"off\"\nscan = \"1ms\"\n");
  EXPECT_THAT(answer(R"({"request":"run","scans":1})"), HasSubstr("plc is missing; expected one or two"));
  (void)request(R"({"request":"run","scans":3,"plc":"two"})");
  (void)request(R"({"request":"run","scans":1,"plc":"one"})");
  (void)request(R"({"request":"run","for":"1ms"})");
  run_in_step();
  EXPECT_THAT(answers_, ElementsAre(HasSubstr("one or two"), HasSubstr("\"t\":0.003"),
                                    HasSubstr("\"t\":0.01,"), HasSubstr("\"t\":0.011}")));
  EXPECT_THAT(
      answer(R"({"request":"list"})"),
      HasSubstr(R"({"name":"two","cpu":"R04CPU","family":"iQ-R","state":"run","scan":0.001,"scans":11})"));
}

}  // namespace
}  // namespace canopus::serve::plant_runs_test
