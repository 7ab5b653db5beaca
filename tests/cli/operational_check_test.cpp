// A run that is asked whether the network came up.

#include "canopus/cli/run/operational_check.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/app/command_line.hpp"
#include "canopus/plant/slave_boot.hpp"

#include "paths.hpp"

namespace canopus::cli::operational_check_test {
namespace {

using canopen::NmtState;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

constexpr can::Time at(can::Duration time) { return can::Time{} + time; }

plant::NodeStatus node(std::uint8_t node_id, NmtState state, bool is_on = true) {
  plant::NodeStatus status;
  status.label = {"line1", "device", node_id};
  status.state = state;
  status.is_on = is_on;
  return status;
}

const std::vector<plant::NodeStatus> up{node(2, NmtState::operational), node(3, NmtState::operational)};
const std::vector<plant::NodeStatus> down{node(2, NmtState::operational), node(3, NmtState::pre_operational)};

TEST(OperationalCheck, WithoutATimeOnlyTheEndCounts) {
  OperationalCheck check(std::nullopt, true);
  EXPECT_FALSE(check.over(up, at(1s)));
  EXPECT_FALSE(check.met(down, at(2s)));
  EXPECT_TRUE(check.met(up, at(2s)));
}

TEST(OperationalCheck, ANodeThatTakesNoPartInItsBus_IsNotInOperationWhateverItsNmtState) {
  plant::NodeStatus cut_off = node(3, NmtState::operational);
  cut_off.is_cut_off = true;
  plant::NodeStatus bus_off = node(4, NmtState::operational);
  bus_off.error_state = can::ErrorState::bus_off;
  EXPECT_FALSE(all_operational({up[0], cut_off}));
  EXPECT_FALSE(all_operational({up[0], bus_off}));
  EXPECT_THAT(not_operational({up[0], cut_off, bus_off}, {}, at(1s)),
              ElementsAre(HasSubstr("is cut off from its bus"), HasSubstr("is bus-off")));
}

TEST(OperationalCheck, WithATimeTheRunEndsWhenAllAreOperational) {
  OperationalCheck check(5s, false);
  EXPECT_FALSE(check.over(down, at(1s)));
  EXPECT_TRUE(check.over(up, at(2s)));
  EXPECT_TRUE(check.met(up, at(2s)));
}

TEST(OperationalCheck, WithATimeTheRunEndsWhenItIsTooLate) {
  OperationalCheck check(5s, true);
  EXPECT_FALSE(check.over(down, at(4'999ms)));
  EXPECT_TRUE(check.over(down, at(5s)));
  EXPECT_FALSE(check.met(down, at(5s)));
}

TEST(OperationalCheck, ARunWithAnEndOfItsOwnGoesOnAndIsJudgedAtTheEnd) {
  OperationalCheck check(5s, true);
  EXPECT_FALSE(check.over(up, at(2s)));
  EXPECT_FALSE(check.over(down, at(6s))) << "they were, in time";
  EXPECT_FALSE(check.met(down, at(10s)));
  EXPECT_TRUE(check.met(up, at(10s)));
}

TEST(OperationalCheck, TooLateIsNotMet) {
  OperationalCheck check(5s, true);
  EXPECT_FALSE(check.met(up, at(6s)));
}

TEST(NotOperational, NamesTheNodesAndTheirStates) {
  EXPECT_THAT(not_operational({node(2, NmtState::operational), node(3, NmtState::stopped),
                               node(4, NmtState::operational, false)},
                              {}, at(1s)),
              ElementsAre("line1 node 3 (device) is stopped", "line1 node 4 (device) is off"));
}

TEST(NotOperational, ASlaveThatIsNotStartedHasTheSlaveThatFailedAsItsReason) {
  plant::SlaveBoot boot{.slave = {"line1", "device", 3}, .master = {"line1", "master", 1}, .record = {}};
  boot.record.step = manager::BootStep::booted;
  EXPECT_THAT(not_operational(down, {boot}, at(1s)), ElementsAre("line1 node 3 (device) is pre-operational"));
  boot.record.halted_by = 5;
  EXPECT_THAT(
      not_operational(down, {boot}, at(1s)),
      ElementsAre("line1 node 3 (device) is pre-operational: booted, 1.0 s ago. Not started: the boot of the "
                  "mandatory slave 5 failed, which ended the start-up."));
}

struct Said {
  int code;
  std::string out, error;
};

Said run(const std::string& example, std::vector<std::string> options) {
  std::vector<std::string> words{"run", CANOPUS_SOURCE_DIR "/examples/" + example, "--virtual"};
  words.insert(words.end(), options.begin(), options.end());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(ExpectOperational, ANetworkThatComesUpEndsTheRunWithZero) {
  const Said said = run("first-plant/plant.toml", {"--expect-operational=30s"});
  EXPECT_EQ(said.code, 0);
  EXPECT_THAT(said.out, HasSubstr("ran 1.600 s of plant time"));
  EXPECT_THAT(said.out, HasSubstr("all 4 nodes operational"));
  EXPECT_EQ(said.error, "");
}

TEST(ExpectOperational, WithAnEndOfItsOwnItRunsToThatEnd) {
  const Said said = run("first-plant/plant.toml", {"--expect-operational=30s", "--for", "4s"});
  EXPECT_EQ(said.code, 0);
  EXPECT_THAT(said.out, HasSubstr("ran 4.000 s of plant time"));
}

TEST(ExpectOperational, ANetworkThatIsTooLateEndsTheRunWithThreeAndTheReasons) {
  const Said said = run("first-plant/plant.toml", {"--expect-operational=1200ms", "--quiet"});
  EXPECT_EQ(said.code, 3);
  EXPECT_THAT(said.error, HasSubstr("canopus: line1 node 3 (encoder) is pre-operational: "));
  EXPECT_THAT(said.error, HasSubstr("waiting for its first heartbeat"));
}

TEST(ExpectOperational, SlavesThatAreStuckAreNamedWithTheReason) {
  const Said said = run("stuck-slave/plant.toml", {"--expect-operational", "--for", "4s", "--quiet"});
  EXPECT_EQ(said.code, 3);
  EXPECT_THAT(said.error,
              HasSubstr("canopus: line1 node 3 (encoder) is pre-operational: failed (M, product code differs "
                        "from 1F86H)"));
  EXPECT_THAT(said.error, HasSubstr("canopus: line1 node 9: asking for 1000H"));
  EXPECT_THAT(said.error, Not(HasSubstr("node 2 (")));
}

TEST(ExpectOperational, WithoutItNothingIsExpected) {
  EXPECT_EQ(run("stuck-slave/plant.toml", {"--for", "4s", "--quiet"}).code, 0);
}

TEST(ExpectOperational, AWrongTimeIsUsage) {
  const Said said = run("first-plant/plant.toml", {"--expect-operational=soon"});
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.error, HasSubstr("\"soon\" is not a duration"));
}

}  // namespace
}  // namespace canopus::cli::operational_check_test
