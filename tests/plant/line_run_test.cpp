// A plant whose bus has a length. Where its limits are, canopus check says (line_review_test.cpp).

#include <string>

#include "canopus/can/bus.hpp"

#include "plant/plant_review.hpp"

namespace canopus::plant::line_run_test {
namespace {

using namespace plant_review;

using namespace std::chrono_literals;

class LineRunTest : public PlantReviewTest, public PlantObserver {
 protected:
  /// Two devices with heartbeats that meet in all ways within ten seconds. `line`: keys of [bus.line].
  can::BusLoad run(const std::string& bit_rate, const std::string& line, can::Duration time = 10s) {
    write("t.eds",
          support::device_file("[1017]\nParameterName=H\nDataType=6\nAccessType=rw\nDefaultValue=7\n"));
    plant_ = support::PlantFolder::load("[[bus]]\nname = \"line1\"\nbit_rate = " + bit_rate +
                                            "\n[bus.line]\n" + line + "\n" + device(3, "t.eds") +
                                            device(4, "t.eds", "objects = { \"1017:00\" = 11 }\n"),
                                        *this);
    if (plant_ == nullptr) return {};
    plant_->power_on();
    plant_->timeline().run_until(can::Time(time));
    return plant_->bus(0).load(plant_->timeline().now());
  }
  std::string refusal_of(const std::string& line) {
    write("t.eds", support::device_file(""));
    return support::PlantFolder::refusal(
        "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[bus.line]\n" + line + "\n" + device(3, "t.eds"),
        *this, nullptr);
  }

  std::unique_ptr<Plant> plant_;
};

TEST_F(LineRunTest, At1Mbit_57MetresWorkAnd58DestroyFrames) {
  const can::BusLoad good = run("1_000_000", "length = 57\nclock_ppm = 31\nexact = true");
  EXPECT_EQ(good.error_frames, 0U);
  EXPECT_GT(good.frames, 2300U);
  EXPECT_GT(run("1_000_000", "length = 58\nclock_ppm = 31\nexact = true").error_frames, 0U);
}

TEST_F(LineRunTest, At500kbit_138MetresWorkAnd139DestroyFrames) {
  EXPECT_EQ(run("500_000", "length = 138\nclock_ppm = 20\nexact = true").error_frames, 0U);
  EXPECT_GT(run("500_000", "length = 139\nclock_ppm = 20\nexact = true").error_frames, 0U);
}

TEST_F(LineRunTest, WithoutExact_AnyLengthWorks) {
  EXPECT_EQ(run("1_000_000", "length = 500").error_frames, 0U);
}

TEST_F(LineRunTest, PlacesOfNodes_DecideWhoHearsWhom) {
  const auto with_place = [](const std::string& place) {
    return "length = 100\nclock_ppm = 20\nexact = true\n[[bus.line.node]]\nport = \"t4\"\nplace = " + place;
  };
  EXPECT_EQ(run("1_000_000", with_place("50")).error_frames, 0U);
  EXPECT_GT(run("1_000_000", with_place("100"), 1s).error_frames, 0U);
}

TEST_F(LineRunTest, ClocksThatAreTooFarApart_MakeControllersErrorPassive) {
  const auto with_clocks = [](const std::string& ppm) {
    return "length = 1\nexact = true\n[[bus.line.node]]\nport = \"t3\"\nclock_ppm = " + ppm +
           "\n[[bus.line.node]]\nport = \"t4\"\nclock_ppm = -" + ppm;
  };
  EXPECT_EQ(run("125_000", with_clocks("3_000")).error_frames, 0U);
  EXPECT_GT(run("125_000", with_clocks("30_000")).error_frames, 1'000U);
}

TEST_F(LineRunTest, WrongKeys_AreErrors) {
  EXPECT_THAT(refusal_of("length = 10\n[[bus.line.node]]\nport = \"t3\""), HasSubstr("needs exact = true"));
  EXPECT_THAT(refusal_of("length = 10\nexact = true\n[[bus.line.node]]\nport = \"t3\"\nplace = 11"),
              HasSubstr("plant.toml:9:9: place = 11: expected 0 to 10 m"));
  EXPECT_THAT(refusal_of("length = 10\nexact = true\n[[bus.line.node]]\nport = \"x\""),
              HasSubstr("node: no port \"x\" on bus \"line1\""));
  EXPECT_THAT(refusal_of("length = 10\nexact = true\n[[bus.line.node]]\nplace = 1"), HasSubstr("port"));
}

}  // namespace
}  // namespace canopus::plant::line_run_test
