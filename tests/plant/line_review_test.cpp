// What `canopus check` says of a bus's length, bit rate and clocks. Its limits are held against a line of controllers
// that has length and clocks.

#include "canopus/sim/bus/line/timed_line.hpp"

#include "plant/plant_review.hpp"

namespace canopus::plant::line_review_test {
namespace {

using namespace plant_review;

using namespace std::chrono_literals;
using ::testing::StartsWith;

class LineReviewTest : public PlantReviewTest {
 protected:
  std::vector<std::string> check_line(const std::string& bit_rate, const std::string& line) {
    write("t.eds", support::device_file(""));
    return check("[[bus]]\nname = \"line1\"\nbit_rate = " + bit_rate + "\n[bus.line]\n" + line + "\n" +
                 device(3, "t.eds"));
  }
};

TEST_F(LineReviewTest, ALineThatIsTooLongForItsBitRate_IsToldWithWhatWouldDo) {
  EXPECT_THAT(
      check_line("1_000_000", "length = 60"),
      ElementsAre(
          "plant.toml:4:1: warning: bus \"line1\": 60 m are too long for 1000 kbit/s: a level takes 420 ns "
          "to the other end, an acknowledgement as long back, and either may be seen a quantum (62.5 ns) "
          "late, but a bit is sampled after 875 ns. At most 57 m, or 800 kbit/s"));
  EXPECT_THAT(check_line("500_000", "length = 1000"), ElementsAre(HasSubstr("At most 138 m, or 50 kbit/s")));
  EXPECT_THAT(check_line("1_000_000", "length = 10\ntransceiver_delay = \"500ns\""),
              ElementsAre(HasSubstr("At most 500 kbit/s")));
  EXPECT_THAT(check_line("10_000", "length = 10000\nnanoseconds_per_metre = 10"),
              ElementsAre(HasSubstr("No bit rate is slow enough")));
}

TEST_F(LineReviewTest, ALineThatTakesOfPhase1_IsToldBeforeItFails) {
  EXPECT_THAT(
      check_line("1_000_000", "length = 40"),
      ElementsAre(
          "plant.toml:4:1: warning: bus \"line1\": 40 m at 1000 kbit/s: there and back takes 640 ns, but the "
          "propagation segment has 500 ns; what it takes of PHASE1 is missing for clocks that differ. At "
          "most "
          "26 m, or 500 kbit/s"));
  EXPECT_THAT(check_line("1_000_000", "length = 20\nstub = 6"), ElementsAre(HasSubstr("At most 14 m")));
}

TEST_F(LineReviewTest, ALineThatWorks_IsNotMentioned) {
  EXPECT_THAT(check_line("1_000_000", "length = 25"), IsEmpty());
  EXPECT_THAT(check_line("250_000", "length = 150\nstub = 5\nclock_ppm = 1500"), IsEmpty());
}

TEST_F(LineReviewTest, ALengthThatCiaDoesNotRecommend_IsMentioned) {
  EXPECT_THAT(
      check_line("1_000_000", "length = 26"),
      ElementsAre("plant.toml:4:1: warning: bus \"line1\": 26 m are more than the 25 m that CiA recommends "
                  "at 1000 kbit/s"));
}

TEST_F(LineReviewTest, ClocksThatDoNotKeepTogether_AreTold) {
  EXPECT_THAT(check_line("125_000", "length = 100\nclock_ppm = 5000"),
              ElementsAre("plant.toml:4:1: warning: bus \"line1\": clocks that are off by 5000 ppm do not "
                          "keep together: with "
                          "PHASE1 5, PHASE2 2 and SJW 2 of 16 quanta at most 4854 ppm do"));
  EXPECT_THAT(check_line("125_000", "length = 100\nclock_ppm = 4854"), IsEmpty());
}

TEST_F(LineReviewTest, WrongKeys_AreErrors) {
  EXPECT_THAT(check_line("125_000", "stub = 1"), ElementsAre(StartsWith("plant.toml:4:1: bus.line: length")));
  EXPECT_THAT(check_line("125_000", "length = 20000"),
              ElementsAre("plant.toml:5:10: length = 20000: expected 0 to 10000 m"));
  EXPECT_THAT(check_line("125_000", "length = 20\nphase1 = 9"),
              ElementsAre("plant.toml:6:10: phase1 = 9: expected 1 to 8 time quanta"));
  EXPECT_THAT(check_line("125_000", "length = 20\njump_width = 3"),
              ElementsAre(HasSubstr("the bit timing cannot be: SJW is not above PHASE1 or PHASE2")));
}

/// Errors of two frames, one each way, between nodes so far apart, whose quanta begin at any moment.
unsigned worst_errors(std::uint32_t bit_rate, double metres) {
  unsigned most = 0;
  const double quantum = 1e9 / bit_rate / sim::BitTiming{}.quanta();
  for (int step = 0; step < 16; ++step) {
    sim::TimedLine line(bit_rate);
    line.add({.driver_delay = 60ns, .receiver_delay = 60ns});
    line.add({.metres = metres,
              .driver_delay = 60ns,
              .receiver_delay = 60ns,
              .start = std::chrono::nanoseconds(static_cast<int>(quantum * step / 16))});
    line.send(0, can::data_frame(0x181, {1, 2, 3}));
    line.send(1, can::data_frame(0x182, {0x55}));
    line.run(std::chrono::nanoseconds(400'000'000'000 / bit_rate));
    most = std::max(most, line.errors());
  }
  return most;
}

TEST_F(LineReviewTest, WhatIsCalledTooLong_FailsOnALineOfControllers_AndTheRestWorks) {
  for (const auto& [bit_rate, longest] : {std::pair{1'000'000U, 57}, std::pair{500'000U, 138}}) {
    const std::string rate = std::to_string(bit_rate);
    EXPECT_THAT(check_line(rate, "length = " + std::to_string(longest)),
                Not(ElementsAre(HasSubstr("too long"))));
    EXPECT_THAT(check_line(rate, "length = " + std::to_string(longest + 1)),
                ElementsAre(HasSubstr("too long")));
    EXPECT_EQ(worst_errors(bit_rate, longest), 0U);
    EXPECT_GT(worst_errors(bit_rate, longest + 1), 0U);
  }
}

}  // namespace
}  // namespace canopus::plant::line_review_test
