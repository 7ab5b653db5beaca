// Runs of the plant of the first steps, with rules and invariants.

#include "canopus/campaign/plant_run.hpp"

#include "canopus/campaign/shrink.hpp"

#include "campaign_folder.hpp"

namespace canopus::campaign::plant_run_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::string up = "[[invariant]]\nname = \"up\"\nkind = \"operational\"\nwithin = \"8s\"\n";

class PlantRun : public test::CampaignFolder {
 protected:
  std::vector<std::string> failures(const std::string& campaign_text, std::uint64_t seed = 1) {
    const auto campaign = load(campaign_text);
    EXPECT_THAT(err_.text(), IsEmpty());
    if (!campaign) return {"no campaign"};
    result_ = run_or_fail(*campaign, plan_of(*campaign, 0, seed));
    std::vector<std::string> all;
    for (const InvariantFailure& failure : result_.failures) all.push_back(failure.fingerprint());
    return all;
  }
  RunResult result_;
};

TEST_F(PlantRun, WithoutRules_BootsAndFails_Nothing) {
  EXPECT_THAT(failures(text("duration = \"10s\"", up)), IsEmpty());
  ASSERT_TRUE(result_.boot.has_value());
  EXPECT_GT(*result_.boot, std::chrono::milliseconds(100));
  EXPECT_LT(*result_.boot, std::chrono::seconds(8));
  EXPECT_GT(result_.frames, 100U);
}

TEST_F(PlantRun, SameSeed_GivesTheSameFramesAndBytes_AndAnotherSeedOthers) {
  const auto campaign = load(text("duration = \"9s\"", up + R"([[rule]]
name = "drops"
chance = 1
fault = { kind = "drop", probability = { low = 0.01, high = 0.2 } }
)"));
  ASSERT_TRUE(campaign) << err_.text();
  const auto line = [&](std::uint64_t seed) {
    const RunPlan plan = plan_of(*campaign, 0, seed);
    return to_json(campaign->file, run_or_fail(*campaign, plan), plan.rules).dump();
  };
  const std::string first = line(5);
  EXPECT_EQ(line(5), first);
  EXPECT_NE(line(6).substr(line(6).find("checksum")), first.substr(first.find("checksum")));
}

TEST_F(PlantRun, PowerCutOfADevice_FailsWhenItDoesNotReturnInTime) {
  const std::string rule = R"([[rule]]
name = "cut"
chance = 1
device = "encoder"
power_cut = { at = "9s", for = "500ms" }
)";
  EXPECT_THAT(failures(text("duration = \"20s\"", up + rule)), IsEmpty());
  EXPECT_THAT(failures(text("duration = \"20s\"", rule + R"([[invariant]]
name = "up"
kind = "operational"
after = "9s"
within = "1ms"
)")),
              testing::Contains("up: line1 node 3 (encoder): pre-operational"));
}

TEST_F(PlantRun, CutWire_IsANodeThatIsCutOff) {
  EXPECT_THAT(failures(text("duration = \"20s\"", up + R"([[rule]]
name = "cut"
chance = 1
fault = { kind = "cut", ports = ["encoder"], from = "8s" }
)")),
              testing::Contains(HasSubstr("up: line1 node 3 (encoder): ")));
}

TEST_F(PlantRun, ValueOfAnObject_HasToBeInItsRange) {
  const auto with = [&](const std::string& range) {
    return failures(text("duration = \"12s\"",
                         "[[invariant]]\nname = \"position\"\nkind = \"value\"\ndevice = \"encoder\"\n"
                         "object = \"6004:00\"\n" +
                             range));
  };
  EXPECT_THAT(with("low = 0\nhigh = 4095"), IsEmpty());
  EXPECT_THAT(with("high = 2000"), ElementsAre("position: encoder 6004:00: above its range"));
  EXPECT_THAT(with("expect = \"never\"\nlow = 4000"), ElementsAre("position: encoder 6004:00: in the range"));
  EXPECT_THAT(with("expect = \"sometimes\"\nlow = 4000"), IsEmpty());
  EXPECT_THAT(result_.reached, ElementsAre("position"));
  EXPECT_THAT(with("changes_within = \"100ms\"\nafter = \"8s\""), IsEmpty());
}

TEST_F(PlantRun, WordThatStands_FailsTheInvariantOfItsChange) {
  const auto with = [&](const std::string& word) {
    return failures(
        text("duration = \"12s\"", "[[invariant]]\nname = \"inputs\"\nkind = \"value\"\nword = '" + word +
                                       "'\nchanges_within = \"500ms\"\nafter = \"9s\"\n"));
  };
  EXPECT_THAT(with("U0\\G10000"), IsEmpty());
  EXPECT_THAT(with("D5"), ElementsAre("inputs: D5: does not change"));
}

TEST_F(PlantRun, WriteOfAnOperator_IsInTheWord) {
  EXPECT_THAT(failures(text("duration = \"2s\"", R"([[rule]]
name = "operator"
chance = 1
write = { at = "1s", word = "D5", value = 7 }
[[invariant]]
name = "seven"
kind = "value"
word = "D5"
high = 6
)")),
              ElementsAre("seven: D5: above its range"));
  EXPECT_EQ(result_.failures.front().at, can::Time{} + std::chrono::milliseconds(1000));
}

TEST_F(PlantRun, FramesThatMustNeverBeSeen_AreAFailureByNodeAndService) {
  EXPECT_THAT(failures(text("duration = \"12s\"", R"([[invariant]]
name = "silent encoder"
kind = "frames"
filter = "service=pdo node=3"
)")),
              ElementsAre("silent encoder: line1 node 3 (encoder): TPDO1"));
}

TEST_F(PlantRun, FramesExpectedSometimes_AreReached) {
  EXPECT_THAT(failures(text("duration = \"12s\"", R"([[invariant]]
name = "heartbeats"
kind = "frames"
expect = "sometimes"
filter = "service=error-control node=2"
)")),
              IsEmpty());
  EXPECT_THAT(result_.reached, ElementsAre("heartbeats"));
}

TEST_F(PlantRun, Reaction_IsMeasuredAndJudged) {
  const auto with = [&](const std::string& within) {
    return failures(text("duration = \"12s\"",
                         "[[invariant]]\nname = \"answer\"\nkind = \"reaction\"\nfrom = \"id=603\"\n"
                         "to = \"id=583\"\nwithin = \"" +
                             within + "\"\n"));
  };
  EXPECT_THAT(with("100ms"), IsEmpty());
  EXPECT_EQ(result_.reactions["answer"].count(), 3U);  // the master reads 1000H and two of 1018H
  EXPECT_THAT(with("10us"), ElementsAre("answer: reaction too late"));
}

TEST_F(PlantRun, RuleThatFitsNoPlant_IsAMistakeWithItsPlace) {
  EXPECT_FALSE(load(text("duration = \"1s\"", up + R"([[rule]]
name = "cut"
device = "pump"
power_cut = { at = "1s" }
)")));
  EXPECT_THAT(
      err_.text(),
      HasSubstr(
          "campaign.toml:10:10: rule \"cut\": device = \"pump\": the plant has no device of this name"));
}

TEST_F(PlantRun, FaultWithAMissingKey_IsAMistakeWithThePlaceOfItsTable) {
  EXPECT_FALSE(load(text("duration = \"1s\"", up + R"([[rule]]
name = "noise"
fault = { kind = "noise", rate = 1 }
)")));
  EXPECT_THAT(err_.text(), HasSubstr("campaign.toml:10:9: rule \"noise\": "));
}

TEST_F(PlantRun, Shrinking_FindsTheRuleTheTimeAndTheDevices) {
  std::string rules = R"([[rule]]
name = "guilty"
chance = 1
device = "encoder"
power_cut = { at = "9s", for = "3s" }
)";
  for (int i = 0; i < 9; ++i) {
    rules += "[[rule]]\nname = \"harmless " + std::to_string(i) +
             "\"\nchance = 1\nfault = { kind = \"duplicate\", identifier = " + std::to_string(0x182 + i) +
             ", first = 3, count = 1 }\n";
  }
  const auto campaign = load(text("duration = \"25s\"", rules + R"([[invariant]]
name = "inputs"
kind = "frames"
after = "8s"
filter = "service=error-control boot-up"
)"));
  ASSERT_TRUE(campaign) << err_.text();
  const RunPlan plan = plan_of(*campaign, 0, 1);
  ASSERT_THAT(plan.rules, SizeIs(10));
  const RunResult result = run_or_fail(*campaign, plan);
  ASSERT_THAT(result.failures, testing::Not(IsEmpty()));
  const auto shrunk = shrink(*campaign, plan, result.failures.front().fingerprint());
  ASSERT_TRUE(shrunk);
  ASSERT_THAT(shrunk->plan.rules, SizeIs(1));
  EXPECT_EQ(shrunk->plan.rules[0].rule->name, "guilty");
  EXPECT_LE(shrunk->plan.duration, std::chrono::milliseconds(12'100));
  EXPECT_THAT(shrunk->plan.without_devices, ElementsAre("io-block", "drive"));
  EXPECT_LT(shrunk->runs, 40U);
}

// Which frames a fault by chance hits depends on all frames before: without the other rules it hits others.
TEST_F(PlantRun, Shrinking_MakesAFaultByChanceCertain) {
  const auto campaign = load(text("duration = \"12s\"", R"([[rule]]
name = "drops"
chance = 1
fault = { kind = "drop", sender = "drive", probability = 0.6 }
[[rule]]
name = "harmless 1"
chance = 1
fault = { kind = "drop", sender = "encoder", probability = 0.5, from = "9s" }
[[rule]]
name = "harmless 2"
chance = 1
fault = { kind = "drop", sender = "encoder", from = "10s" }
[[rule]]
name = "harmless 3"
chance = 1
device = "io-block"
set = { start = "10ms" }
[[invariant]]
name = "up"
kind = "operational"
nodes = ["drive"]
within = "7s"
)"));
  ASSERT_TRUE(campaign) << err_.text();
  std::optional<ShrunkFailure> shrunk;
  for (std::uint64_t seed = 1; seed <= 20 && !shrunk; ++seed) {
    shrunk = shrink(*campaign, plan_of(*campaign, 0, seed), "up: line1 node 4 (drive): pre-operational");
  }
  ASSERT_TRUE(shrunk);
  ASSERT_THAT(shrunk->plan.rules, SizeIs(1));
  EXPECT_EQ(shrunk->plan.rules[0].rule->name, "drops");
  ASSERT_FALSE(shrunk->plan.rules[0].knobs.empty());
  EXPECT_EQ(shrunk->plan.rules[0].knobs.back().name, "fault.probability");
  EXPECT_EQ(shrunk->plan.rules[0].knobs.back().value, "1");
}

TEST_F(PlantRun, ShrinkingThatIsEnded_GivesNothing) {
  const auto campaign = load(text("duration = \"10s\"", R"([[invariant]]
name = "never"
kind = "frames"
filter = "service=nmt"
)"));
  ASSERT_TRUE(campaign) << err_.text();
  const RunPlan plan = plan_of(*campaign, 0, 1);
  const RunResult result = run_or_fail(*campaign, plan);
  ASSERT_THAT(result.failures, testing::Not(IsEmpty()));
  int asked = 0;
  EXPECT_FALSE(shrink(*campaign, plan, result.failures.front().fingerprint(), [&] { return ++asked > 2; }));
}

}  // namespace
}  // namespace canopus::campaign::plant_run_test
