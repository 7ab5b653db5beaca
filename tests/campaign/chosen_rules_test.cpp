// What a seed chooses is the same on every machine: the values are written out.

#include "canopus/campaign/chosen_rules.hpp"

#include <rapidcheck/gtest.h>

#include "canopus/campaign/random_stream.hpp"

#include "campaign_folder.hpp"

namespace canopus::campaign::chosen_rules_test {
namespace {

using testing::ElementsAre;

constexpr std::string_view text = R"([campaign]
plant = "p.toml"
duration = "1s"
[[rule]]
name = "noise"
fault = { kind = "noise", bit_error_rate = { choose = [1e-5, 1e-4, 1e-3] }, from = { low = "1s", high = "2s" } }
[[rule]]
name = "slow"
device = "encoder"
chance = 0.25
set = { start = { low = "0ns", high = "999ns" }, transmit_queue = { low = 1, high = 128 } }
[[rule]]
name = "canary"
canary = true
device = "encoder"
power_cut = { at = { low = "1s", high = "3s" } }
[[invariant]]
name = "up"
kind = "operational"
within = "1s"
)";

std::string shown(const std::vector<ChosenRule>& rules) {
  std::string all;
  for (const ChosenRule& chosen : rules) {
    all += chosen.rule->name + ":";
    for (const Knob& knob : chosen.knobs) all += " " + knob.name + "=" + knob.value;
    all += "\n";
  }
  return all;
}

TEST(RandomStream, Numbers_AreThoseOfSplitMix64) {
  // The state is the FNV-1a of 8 octets of the seed and the name, computed by hand in Python.
  RandomStream stream(1, "noise");
  EXPECT_EQ(stream.next(), 6722314589701378397U);
  EXPECT_EQ(stream.next(), 6019887112061344940U);
}

TEST(RandomStream, Between_ReachesBothEndsAndNothingElse) {
  RandomStream stream(3, "x");
  std::set<std::int64_t> found;
  for (int i = 0; i < 200; ++i) found.insert(stream.between(-2, 2));
  EXPECT_THAT(found, ElementsAre(-2, -1, 0, 1, 2));
}

// Worked out by a program in Python that has nothing in common with ours.
TEST(ChosenRules, OfASeed_AreTheSameOnEveryMachine) {
  const CampaignReading reading = read_campaign(text, "c.toml");
  ASSERT_THAT(reading.errors, testing::IsEmpty());
  std::string all;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    all += std::to_string(seed) + "\n" + shown(choose_rules(reading.campaign, seed));
  EXPECT_EQ(all, R"(1
canary: power_cut.at=2415294us
2
slow: set.start=393ns set.transmit_queue=14
3
noise: fault.bit_error_rate=1e-05 fault.from=1952118us
slow: set.start=612ns set.transmit_queue=98
4
slow: set.start=145ns set.transmit_queue=109
5
noise: fault.bit_error_rate=0.0001 fault.from=1105463us
6
noise: fault.bit_error_rate=0.0001 fault.from=1538712us
)");
}

TEST(ChosenRules, OfACanarysSeed_AreTheCanaryAlone) {
  const CampaignReading reading = read_campaign(text, "c.toml");
  const auto rules = choose_rules(reading.campaign, 1);
  ASSERT_EQ(rules.size(), 1U);
  EXPECT_EQ(rules[0].rule->name, "canary");
}

TEST(ChosenRules, NumbersAtTheEndsOfTheirTypes_AreChosen) {
  const CampaignReading reading = read_campaign(
      "[campaign]\nplant = \"p.toml\"\nduration = \"1s\"\n[[rule]]\nname = \"r\"\ndevice = \"d\"\n"
      "set = { small = { low = 5e-324, high = 5e-324 }, whole = { low = 9223372036854775807, high = "
      "9223372036854775807 } }\n"
      "[[invariant]]\nname = \"up\"\nkind = \"operational\"\nwithin = \"1s\"\n",
      "c.toml");
  ASSERT_TRUE(reading.errors.empty()) << reading.errors.front().message;
  EXPECT_EQ(shown(choose_rules(reading.campaign, 1)),
            "r: set.small=4.94066e-324 set.whole=9223372036854775807\n");
}

RC_GTEST_PROP(Knobs, OfAnySeed_LieBetweenTheirEnds,
              (std::uint64_t seed, std::int32_t first, std::int32_t second)) {
  const std::int64_t low = std::min(first, second);
  const std::int64_t high = std::max(first, second);
  const std::string file =
      "[campaign]\nplant = \"p\"\nduration = \"1s\"\n[[rule]]\nname = \"r\"\ndevice = \"d\"\nset = { a = { "
      "low = " +
      std::to_string(low) + ", high = " + std::to_string(high) +
      " }, b = { choose = [1, 2] }, c = { low = 0.5, high = 0.75 } }\n[[invariant]]\nname = \"up\"\nkind = "
      "\"operational\"\nwithin = \"1s\"\n";
  const CampaignReading reading = read_campaign(file, "c.toml");
  RC_ASSERT(reading.errors.empty());
  const ChosenRule chosen = chosen_rule(reading.campaign.rules.front(), seed);
  const std::int64_t a = chosen.values["a"].value_or(INT64_MIN);
  RC_ASSERT(low <= a && a <= high);
  RC_ASSERT(chosen.values["b"].value_or(0) == 1 || chosen.values["b"].value_or(0) == 2);
  const double c = chosen.values["c"].value_or(0.0);
  RC_ASSERT(c >= 0.5 && c <= 0.75);
  RC_ASSERT(chosen.knobs.size() == 3U);
}

TEST(ChosenRules, ChanceOfARule_IsItsShareOfTheSeeds) {
  const CampaignReading reading = read_campaign(text, "c.toml");
  int noise = 0;
  int slow = 0;
  for (std::uint64_t seed = 2; seed < 4002; ++seed) {
    for (const ChosenRule& chosen : choose_rules(reading.campaign, seed))
      ++(chosen.rule->name == "noise" ? noise : slow);
  }
  EXPECT_NEAR(noise, 2000, 150);
  EXPECT_NEAR(slow, 1000, 120);
}

}  // namespace
}  // namespace canopus::campaign::chosen_rules_test
