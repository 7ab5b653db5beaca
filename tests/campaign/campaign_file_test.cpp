// What a campaign file may say, and the place of each mistake.

#include "canopus/campaign/campaign_file.hpp"

#include "campaign_folder.hpp"

namespace canopus::campaign::campaign_file_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> errors_of(const std::string& text) {
  std::vector<std::string> lines;
  for (const text::FileError& error : read_campaign(text, "c.toml").errors)
    lines.push_back(text::describe(error, "c.toml"));
  return lines;
}

const std::string good = R"([campaign]
name = "night"
plant = "plant.toml"
duration = "20s"
seeds = 500
first_seed = 7

[[rule]]
name = "noise"
fault = { kind = "noise", bit_error_rate = { choose = [1e-5, 1e-4] }, from = { low = "1s", high = "2s" } }

[[rule]]
name = "canary"
canary = true
device = "encoder"
power_cut = { at = "3s" }

[[invariant]]
name = "up"
kind = "operational"
within = "8s"

[[invariant]]
name = "emergencies"
kind = "frames"
expect = "sometimes"
filter = "service=emcy"
)";

TEST(CampaignFile, GoodFile_IsReadWithItsDefaults) {
  const CampaignReading reading = read_campaign(good, "c.toml");
  ASSERT_THAT(reading.errors, IsEmpty());
  const CampaignFile& campaign = reading.campaign;
  EXPECT_EQ(campaign.name, "night");
  EXPECT_EQ(campaign.seeds, 500U);
  EXPECT_EQ(campaign.first_seed, 7U);
  EXPECT_EQ(campaign.duration, std::chrono::seconds(20));
  EXPECT_EQ(campaign.sample_interval, std::chrono::milliseconds(10));
  ASSERT_EQ(campaign.variants.size(), 1U);
  EXPECT_EQ(campaign.variants[0].plant, "plant.toml");
  ASSERT_EQ(campaign.rules.size(), 2U);
  EXPECT_EQ(campaign.rules[0].kind, RuleKind::fault);
  EXPECT_DOUBLE_EQ(campaign.rules[0].chance, 0.5);
  EXPECT_EQ(campaign.rules[1].kind, RuleKind::power_cut);
  EXPECT_EQ(campaign.canary_of(7), &campaign.rules[1]);
  EXPECT_EQ(campaign.canary_of(8), nullptr);
  ASSERT_EQ(campaign.invariants.size(), 2U);
  EXPECT_EQ(campaign.invariants[0].expectation, Expectation::always);
  EXPECT_EQ(campaign.invariants[1].expectation, Expectation::sometimes);
}

struct Mistake {
  std::string name;
  std::string from;  ///< of the good file
  std::string to;
  std::string error;
};

class CampaignMistake : public testing::TestWithParam<Mistake> {};

TEST_P(CampaignMistake, IsReportedWithItsPlace) {
  std::string text = good;
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, GetParam().from.size(), GetParam().to);
  EXPECT_THAT(errors_of(text), testing::Contains(HasSubstr(GetParam().error)));
}

INSTANTIATE_TEST_SUITE_P(
    Each, CampaignMistake,
    testing::Values(
        Mistake{"Seeds", "seeds = 500", "seeds = 0", "c.toml:5:9: seeds = 0: expected 1 to 10000000"},
        Mistake{"Duration", "duration = \"20s\"", "duration = 20",
                "c.toml:4:12: duration = 20: expected a time with a unit in quotes"},
        Mistake{"NoDuration", "duration = \"20s\"\n", "", "campaign: duration is missing"},
        Mistake{"UnknownKey", "seeds = 500", "sedes = 500", "unknown key sedes; did you mean seeds?"},
        Mistake{"TwoKinds", "power_cut = { at = \"3s\" }",
                "power_cut = { at = \"3s\" }\ncpu_stop = { at = \"1s\" }",
                "expected one of the keys fault, set, script, power_cut, cpu_stop or write; found 2"},
        Mistake{"NoKind", "power_cut = { at = \"3s\" }\n", "", "found 0"},
        Mistake{"KnobOrder", "{ low = \"1s\", high = \"2s\" }", "{ low = \"2s\", high = \"1s\" }",
                "c.toml:10:78: expected { low = 1, high = 5 } or"},
        Mistake{"KnobThatIsNoNumber", "{ low = \"1s\", high = \"2s\" }", "{ low = 1.0, high = inf }",
                "c.toml:10:78: expected { low = 1, high = 5 } or"},
        Mistake{"KnobWiderThanADouble", "{ low = \"1s\", high = \"2s\" }", "{ low = -1e308, high = 1e308 }",
                "c.toml:10:78: expected { low = 1, high = 5 } or"},
        Mistake{"KnobOfALargeWholeNumber", "{ low = \"1s\", high = \"2s\" }",
                "{ low = 9007199254740993, high = 1e300 }",
                "c.toml:10:78: expected { low = 1, high = 5 } or"},
        Mistake{"EmptyChoice", "{ choose = [1e-5, 1e-4] }", "{ choose = [] }",
                "expected { choose = [1, 2, 5] }"},
        Mistake{"NoTarget", "device = \"encoder\"\n", "",
                "rule: device is missing; expected device or plc, one of them"},
        Mistake{"CanaryWithChance", "canary = true", "canary = true\nchance = 0.1", "a canary has none"},
        Mistake{"Chance", "[[rule]]\nname = \"noise\"", "[[rule]]\nname = \"noise\"\nchance = 2",
                "chance = 2: expected 0 to 1"},
        Mistake{"Twice", "name = \"canary\"", "name = \"noise\"",
                "there is another one of the name \"noise\""},
        Mistake{"Kind", "kind = \"operational\"", "kind = \"up\"",
                "kind = \"up\": expected one of operational, value, frames, event, reaction, python"},
        Mistake{"NoWithin", "within = \"8s\"\n", "", "invariant: within is missing"},
        Mistake{"Filter", "service=emcy", "service=emergency", "c.toml:27:10: filter ="},
        Mistake{"Expect", "expect = \"sometimes\"", "expect = \"often\"",
                "expected \"never\" or \"sometimes\""}),
    [](const auto& each) { return each.param.name; });

TEST(CampaignFile, WithoutAnInvariant_IsRefused) {
  EXPECT_THAT(errors_of("[campaign]\nplant = \"p.toml\"\nduration = \"1s\"\n"),
              testing::ElementsAre(HasSubstr("expected one [[invariant]] at least")));
}

}  // namespace
}  // namespace canopus::campaign::campaign_file_test
