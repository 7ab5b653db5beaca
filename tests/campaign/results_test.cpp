// Results: the same bytes for any number of shards and threads, and after a process that was killed.

#include "canopus/campaign/results.hpp"

#include <rapidcheck/gtest.h>

#include "canopus/campaign/failure_story.hpp"
#include "canopus/campaign/report.hpp"
#include "canopus/campaign/runner.hpp"
#include "canopus/campaign/summary.hpp"

#include "campaign_folder.hpp"

namespace canopus::campaign::results_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string rest = R"([[rule]]
name = "cut"
chance = 0.3
device = "encoder"
power_cut = { at = { low = "1200ms", high = "2s" }, for = "300ms" }

[[rule]]
name = "late"
device = "drive"
set = { start = { low = "0s", high = "1s" } }

[[rule]]
name = "canary"
canary = true
device = "io-block"
power_cut = { at = "1200ms", for = "100ms" }

[[invariant]]
name = "one boot-up"
kind = "frames"
after = "1100ms"
filter = "service=error-control boot-up !node=4 !node=1"

[[invariant]]
name = "drive is late"
kind = "frames"
expect = "sometimes"
after = "500ms"
filter = "service=error-control boot-up node=4"
)";

class CampaignResults : public test::CampaignFolder {
 protected:
  CampaignResults() : campaign_(*load(text("name = \"short\"\nduration = \"2500ms\"\nseeds = 16", rest))) {}

  /// Runs a shard and its stories; `most` runs at most.
  StoredResults run_shard(const std::string& folder, Shard shard, std::size_t jobs,
                          std::uint64_t most = 1000) {
    auto results = Results::open(in(folder), head_of(campaign_, shard));
    EXPECT_TRUE(results.has_value());
    const auto progress = run_all(
        campaign_, *results,
        {.jobs = jobs, .shard = shard, .is_over = [&](const Progress& now) { return now.ran >= most; }});
    EXPECT_TRUE(progress.has_value());
    if (most == 1000) {
      EXPECT_TRUE(results->finish().has_value());
    }
    StoredResults stored{in(folder), head_of(campaign_, shard)};
    const auto summary = summarize({stored});
    EXPECT_TRUE(write_stories(campaign_, *summary, stored.folder, [] { return false; }).has_value());
    return stored;
  }
  /// The three files of a report.
  std::string report(const std::vector<StoredResults>& shards) {
    summary_ = *merge_results(shards, in("report"));
    std::vector<std::string> folders;
    for (const StoredResults& shard : shards) folders.push_back(shard.folder);
    EXPECT_TRUE(write_report(summary_, folders, in("report")).has_value());
    return read(in("report/results.jsonl")) + read(in("report/report.html")) + read(in("report/junit.xml"));
  }

  Campaign campaign_;
  Summary summary_;
};

TEST_F(CampaignResults, OfOneTwoAndSixteenShards_OnOneAndTwoThreads_AreTheSameBytes) {
  const std::string one = report({run_shard("one", {}, 1)});
  EXPECT_EQ(summary_.runs, 16U);
  EXPECT_GT(summary_.failed, 0U);
  EXPECT_THAT(summary_.missed_canaries, IsEmpty());
  EXPECT_THAT(summary_.holes, IsEmpty());
  EXPECT_THAT(one, HasSubstr("power_cut.at"));
  EXPECT_EQ(report({run_shard("threads", {}, 2)}), one);
  EXPECT_EQ(read(in("threads/results.jsonl")), read(in("one/results.jsonl")));
  for (const std::uint64_t count : {2U, 16U}) {
    std::vector<StoredResults> shards;
    for (std::uint64_t number = 1; number <= count; ++number) {
      shards.push_back(
          run_shard("shard-" + std::to_string(number) + "-" + std::to_string(count), {number, count}, 2));
    }
    EXPECT_EQ(report(shards), one) << count << " shards";
  }
}

TEST_F(CampaignResults, AfterAProcessWasKilled_TheSecondStartGivesTheSameBytes) {
  (void)run_shard("whole", {}, 1);
  (void)run_shard("killed", {}, 1, 7);
  ASSERT_FALSE(fs::exists(in("killed/results.jsonl")));
  const std::string growing = read(in("killed/results.part.jsonl"));
  EXPECT_EQ(std::ranges::count(growing, '\n'), 8);  // the head and 7 runs
  std::ofstream(in("killed/results.part.jsonl"))
      << growing << R"({"seed":9,"variant":"plant","outco)";  // torn
  auto results = Results::open(in("killed"), head_of(campaign_, {}));
  ASSERT_TRUE(results);
  EXPECT_EQ(results->done(), 7U);
  const auto progress = run_all(campaign_, *results, {});
  ASSERT_TRUE(progress);
  EXPECT_EQ(progress->ran, 9U);
  EXPECT_TRUE(results->finish().has_value());
  EXPECT_EQ(read(in("killed/results.jsonl")), read(in("whole/results.jsonl")));
  EXPECT_FALSE(fs::exists(in("killed/results.part.jsonl")));
}

TEST_F(CampaignResults, OfACampaignThatWasChanged_AreRefused) {
  (void)run_shard("one", {}, 1, 2);
  ResultsHead other = head_of(campaign_, {});
  other.checksum = "0";
  const auto results = Results::open(in("one"), other);
  ASSERT_FALSE(results);
  EXPECT_THAT(results.error(),
              HasSubstr("results of another campaign, or of this one before its files changed"));
}

TEST_F(CampaignResults, MissingShards_AreNamed) {
  const std::vector<StoredResults> shards{run_shard("a", {1, 3}, 1), run_shard("c", {3, 3}, 1)};
  const auto summary = summarize(shards);
  ASSERT_TRUE(summary);
  EXPECT_THAT(summary->missing, ElementsAre("shard 2/3: 5 runs"));
  EXPECT_FALSE(summary->is_good());
}

TEST_F(CampaignResults, Story_IsARunOfItsOwnThatFailsAlike) {
  const StoredResults stored = run_shard("one", {}, 1);
  const auto summary = summarize({stored});
  ASSERT_THAT(summary->kinds, testing::SizeIs(1));
  const FailureKind& kind = summary->kinds.front();
  const std::string folder = in("one/" + story_folder(kind));
  for (const std::string name : {"plant.toml", "campaign.toml", "trace.log", "events.jsonl", "story.json"})
    EXPECT_TRUE(fs::exists(folder + "/" + name)) << name;
  text::TextOutput err;
  const auto smallest = load_campaign(folder + "/campaign.toml", err);
  ASSERT_TRUE(smallest) << err.text();
  const RunResult result = run_or_fail(*smallest, plan_of(*smallest, 0, kind.seed));
  ASSERT_THAT(result.failures, testing::SizeIs(1));
  EXPECT_EQ(result.failures.front().fingerprint(), kind.fingerprint);
  const auto story = text::parse_json(read(folder + "/story.json"));
  ASSERT_TRUE(story);
  EXPECT_EQ(story->at("rules").size(), 1U);
  EXPECT_EQ(story->at("reproduce").string(),
            "canopus campaign campaign.toml --seed " + std::to_string(kind.seed));
  EXPECT_THAT(story->at("without_devices").dump(), HasSubstr("drive"));
}

TEST_F(CampaignResults, JUnit_HasACaseForEachInvariantCanaryAndHole) {
  (void)report({run_shard("one", {}, 1)});
  const std::string xml = read(in("report/junit.xml"));
  EXPECT_THAT(xml, HasSubstr(R"(<testsuite name="short" tests="4" failures="1">)"));
  EXPECT_THAT(xml, HasSubstr(R"(<testcase classname="plant" name="one boot-up">)"));
  EXPECT_THAT(xml, HasSubstr(R"(<testcase classname="canary" name="canary"/>)"));
  EXPECT_THAT(xml, HasSubstr(R"(<testcase classname="sometimes" name="drive is late"/>)"));
}

TEST_F(CampaignResults, SameFailureOfTwoVariants_IsAKindOfEach) {
  std::string line =
      R"({"seed":1,"variant":"V","outcome":"failed","rules":[],"failures":[{"invariant":"up","node":"n","reason":"off","t":1.5,"detail":"d"}],"reached":[],"boot":null,"reactions":{},"frames":1,"checksum":"0"})";
  const ResultsHead head{
      .campaign = "two", .checksum = "1", .variants = {"old", "new"}, .invariants = {"up"}};
  std::string lines = to_json(head).dump() + '\n';
  for (const std::string variant : {"old", "new"}) {
    std::string each = line;
    each.replace(each.find("\"V\""), 3, "\"" + variant + "\"");
    lines += each + '\n';
  }
  fs::create_directories(in("x"));
  write("x/results.jsonl", lines);
  const auto summary = summarize({{in("x"), head}});
  ASSERT_TRUE(summary);
  ASSERT_THAT(summary->kinds, testing::SizeIs(2));
  EXPECT_EQ(summary->kinds[0].variant, "old");
  EXPECT_EQ(summary->kinds[1].variant, "new");
  EXPECT_THAT(junit_report(*summary), HasSubstr(R"(tests="2" failures="2")"));
  const auto filtered = summarize({{in("x"), head}}, "new");
  ASSERT_TRUE(filtered);
  EXPECT_EQ(filtered->runs, 1U);
}

TEST_F(CampaignResults, HolesAndMissedCanaries_FailTheCampaign) {
  std::string blind = rest;
  blind.replace(blind.find("after = \"1100ms\"\nfilter = \"service=error-control boot-up !node=4"),
                std::string("after = \"1100ms\"").size(), "after = \"2400ms\"");
  blind.replace(blind.find("node=4\"\n"), std::string("node=4").size(), "node=9");
  write("blind.toml", text("duration = \"2500ms\"\nseeds = 6", blind));
  const auto campaign = load_campaign(in("blind.toml"), err_);
  ASSERT_TRUE(campaign) << err_.text();
  auto results = Results::open(in("blind"), head_of(*campaign, {}));
  ASSERT_TRUE(run_all(*campaign, *results, {}));
  const auto summary = summarize({{in("blind"), head_of(*campaign, {})}});
  ASSERT_TRUE(summary);
  EXPECT_THAT(summary->missed_canaries, ElementsAre("canary"));
  EXPECT_THAT(summary->holes, ElementsAre("drive is late"));
  EXPECT_FALSE(summary->is_good());
}

TEST_F(CampaignResults, Comparison_NamesWhatIsNewAndWhatIsSlower) {
  Summary before{.runs = 100};
  Summary after{.runs = 100};
  before.kinds.push_back({.fingerprint = "up: node 3: stopped", .runs = 4});
  before.kinds.push_back({.fingerprint = "range: D5: above its range", .runs = 2});
  after.kinds.push_back({.fingerprint = "up: node 3: stopped", .runs = 12});
  after.kinds.push_back({.fingerprint = "up: node 4: stopped", .runs = 1, .seed = 17});
  after.holes.push_back("sync");
  for (int i = 0; i < 10; ++i) {
    before.boots.add(std::chrono::milliseconds(1000));
    after.boots.add(std::chrono::milliseconds(2000));
  }
  const Comparison comparison = compare(before, after);
  EXPECT_TRUE(comparison.is_worse);
  EXPECT_THAT(comparison.lines,
              ElementsAre("WORSE: in 12.0 % of the runs instead of 4.0 %: up: node 3: stopped",
                          "WORSE: new failure, 1 of 100 runs, first seed 17: up: node 4: stopped",
                          "better: no longer: range: D5: above its range", "WORSE: new hole: sync",
                          "WORSE: boot, median: 2.000 s instead of 1.000 s",
                          "WORSE: boot, 99 %: 2.000 s instead of 1.000 s"));
  EXPECT_FALSE(compare(before, before).is_worse);
  EXPECT_THAT(compare(before, before).lines, IsEmpty());
}

TEST_F(CampaignResults, StoryOfAPlantWithALibraryAndLabels_HasTheFilesAndNoLibrary) {
  write("main.st", "PROGRAM Main level := level + 1; END_PROGRAM");
  write("labels.csv", "Label Name,Data Type,Assign (Device/Label)\nlevel,Word [Signed],D100\n");
  std::string plant = read(test::examples + "any-module/me3can1-q.toml");
  const auto exchange = [&plant](std::string_view from, std::string_view to) {
    ASSERT_NE(plant.find(from), std::string::npos) << from;
    plant.replace(plant.find(from), from.size(), to);
  };
  exchange("program = [\"main.st\", \"lib:canopen\"]",
           "program = [\"main.st\", \"lib:canopen\"]\nlabels = [\"labels.csv\"]");
  exchange("../devices/", test::examples + "devices/");
  write("plant.toml", plant);
  const auto campaign = load(
      "[campaign]\nplant = \"plant.toml\"\nduration = \"20ms\"\nseeds = 1\n[[invariant]]\nname = "
      "\"up\"\nkind = \"operational\"\nwithin = \"1ms\"\n");
  ASSERT_TRUE(campaign) << err_.text();
  auto results = Results::open(in("one"), head_of(*campaign, {}));
  ASSERT_TRUE(run_all(*campaign, *results, {.jobs = 1, .is_over = [](const Progress&) { return false; }}));
  const auto summary = summarize({{in("one"), head_of(*campaign, {})}});
  ASSERT_THAT(summary->kinds, testing::Not(IsEmpty()));
  const auto written = write_stories(*campaign, *summary, in("one"), [] { return false; });
  ASSERT_TRUE(written.has_value()) << written.error();
  const std::string folder = in("one/" + story_folder(summary->kinds.front()));
  EXPECT_TRUE(fs::exists(folder + "/files/labels.csv"));
  const std::string smallest = read(folder + "/plant.toml");
  EXPECT_THAT(smallest, HasSubstr("lib:canopen"));
  EXPECT_THAT(smallest, testing::Not(HasSubstr("files/lib:canopen")));
  text::TextOutput err;
  EXPECT_TRUE(load_campaign(folder + "/campaign.toml", err)) << err.text();
  // The labels decide what a run does: results of before are not those of the changed file.
  write("labels.csv", "Label Name,Data Type,Assign (Device/Label)\nlevel,Word [Signed],D200\n");
  const auto changed = load_campaign(in("campaign.toml"), err_);
  ASSERT_TRUE(changed) << err_.text();
  EXPECT_NE(changed->checksum, campaign->checksum);
}

TEST_F(CampaignResults, FileWithoutEndsOfLines_IsRefusedAtOneMegabyte) {
  fs::create_directories(in("one"));
  const std::string path = in("one/results.jsonl");
  write("one/results.jsonl", "{");
  fs::resize_file(path, std::uintmax_t{1} << 40U);  // a hole: it takes no place on the disk
  EXPECT_EQ(read_results(in("one")).error(), path + ":1: the line is longer than 1 MiB");
}

/// A line of a run as short as can be.
std::string run_line(std::uint64_t seed, const std::string& failures = "") {
  return R"({"seed":)" + std::to_string(seed) + R"(,"variant":"plant","outcome":")" +
         (failures.empty() ? "passed" : "failed") + R"(","rules":[],"failures":[)" + failures +
         R"(],"reached":[],"boot":null,"reactions":{},"frames":1,"checksum":"0"})" + '\n';
}

class CampaignLines : public test::CampaignFolder {
 protected:
  ResultsHead head_{
      .campaign = "c", .checksum = "1", .seeds = 1000, .variants = {"plant"}, .invariants = {"up"}};
  void write_lines(const std::string& folder, const std::string& name, const std::string& lines) {
    fs::create_directories(in(folder));
    write(folder + "/" + name, to_json(head_).dump() + '\n' + lines);
  }
  std::vector<std::uint64_t> numbers_in(const std::vector<std::string>& folders) {
    std::vector<StoredResults> stored;
    for (const std::string& folder : folders) stored.push_back({in(folder), head_});
    std::vector<std::uint64_t> numbers;
    EXPECT_TRUE(each_run(stored, head_,
                         [&](std::uint64_t number, const std::string&) { numbers.push_back(number); }));
    return numbers;
  }
};

TEST_F(CampaignLines, OfAnyNumberOfFiles_ComeInOrderAndOnce) {
  write_lines("a", "results.jsonl", run_line(1) + run_line(4) + run_line(6));
  write_lines("a", "results.part.jsonl", run_line(9) + run_line(2) + run_line(4));
  write_lines("b", "results.jsonl", run_line(2) + run_line(3));
  write_lines("c", "results.part.jsonl", run_line(8) + run_line(5) + "{\"seed\":7,\"variant\":\"pl");
  EXPECT_THAT(numbers_in({"a", "b", "c"}), ElementsAre(0U, 1U, 2U, 3U, 4U, 5U, 7U, 8U));
}

TEST_F(CampaignLines, OfASortedFileThatIsOutOfOrder_AreRefusedWithTheirLine) {
  write_lines("a", "results.jsonl", run_line(5) + run_line(4));
  const auto read = each_run({{in("a"), head_}}, head_, [](std::uint64_t, const std::string&) {});
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error(),
              HasSubstr("results.jsonl:3: the run is out of order; expected runs by seed and variant"));
}

TEST_F(CampaignLines, LongerThanAMebibyte_AreRefusedWithTheirLine) {
  write_lines("a", "results.jsonl", run_line(1) + std::string((1U << 20U) + 2, 'x') + "\n" + run_line(2));
  const auto read = each_run({{in("a"), head_}}, head_, [](std::uint64_t, const std::string&) {});
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error(), HasSubstr("results.jsonl:3: the line is longer than 1 MiB"));
}

TEST_F(CampaignLines, DamagedOnes_AreMissingRuns) {
  head_.seeds = 4;
  write_lines("a", "results.jsonl",
              run_line(1) + "{\"seed\":2,\"variant\":\"plant\",}\n" + "nonsense\n" + run_line(4));
  const auto summary = summarize({{in("a"), head_}});
  ASSERT_TRUE(summary) << summary.error();
  EXPECT_EQ(summary->runs, 2U);
  EXPECT_THAT(summary->missing, ElementsAre("2 runs"));
}

TEST_F(CampaignLines, WithASecondSeedThatIsNoNumber_AreSummed) {
  const std::string failure = R"({"invariant":"up","node":"","reason":"off","t":1,"detail":"d"})";
  std::string line = run_line(3, failure);
  line.insert(line.size() - 2, R"(,"seed":"three")");
  write_lines("a", "results.jsonl", line);
  const auto summary = summarize({{in("a"), head_}});
  ASSERT_TRUE(summary) << summary.error();
  ASSERT_THAT(summary->kinds, testing::SizeIs(1));
  EXPECT_EQ(summary->kinds.front().seed, 0U);
}

TEST_F(CampaignLines, WithANumberOfShrinkingRunsThatIsNone_AreReported) {
  const std::string failure = R"({"invariant":"up","node":"","reason":"off","t":1,"detail":"d"})";
  write_lines("a", "results.jsonl", run_line(3, failure));
  const auto summary = summarize({{in("a"), head_}});
  ASSERT_TRUE(summary) << summary.error();
  text::Json story = text::Json::object();
  story["shrinking_runs"] = -1;
  EXPECT_THAT(html_report(*summary, std::vector<text::Json>(1, story)), HasSubstr("<td>found in<td>0 runs"));
  story["shrinking_runs"] = 1e300;
  EXPECT_THAT(html_report(*summary, std::vector<text::Json>(1, story)),
              HasSubstr("<td>found in<td>1000000000 runs"));
}

TEST_F(CampaignLines, WithMoreKindsOfFailuresThanAreKept_AreCounted) {
  std::string lines;
  for (std::uint64_t seed = 1; seed <= head_.seeds; ++seed) {
    const auto failure = [&](const std::string& reason) {
      return R"({"invariant":"up","node":"","reason":")" + reason + R"(","t":1,"detail":"d"})";
    };
    const std::string letters{static_cast<char>('a' + seed / 676), static_cast<char>('a' + seed / 26 % 26),
                              static_cast<char>('a' + seed % 26)};
    lines += run_line(seed, failure(letters) + "," + failure(letters + "!"));
  }
  write_lines("a", "results.jsonl", lines);
  const auto summary = summarize({{in("a"), head_}});
  ASSERT_TRUE(summary) << summary.error();
  EXPECT_EQ(summary->failed, 1000U);
  EXPECT_EQ(summary->kinds.size(), most_kinds);
  EXPECT_EQ(summary->runs_of_other_kinds, 1000U);
  EXPECT_THAT(describe(*summary),
              testing::Contains("FAILED 1000 failures of more than 1000 kinds, which are not named"));
}

TEST_F(CampaignLines, BehindATornOne_BeginALineOfTheirOwn) {
  write_lines("a", "results.part.jsonl", run_line(2) + "{\"seed\":7,\"variant\":\"pl");
  auto results = Results::open(in("a"), head_);
  ASSERT_TRUE(results) << results.error();
  EXPECT_EQ(results->done(), 1U);
  const std::string line = run_line(1);
  ASSERT_TRUE(results->add(0, line.substr(0, line.size() - 1)));
  EXPECT_EQ(read(in("a/results.part.jsonl")), to_json(head_).dump() + '\n' + run_line(2) + run_line(1));
}

RC_GTEST_PROP(CampaignLinesOfAnyOrder, AreInOrderAndOnce,
              (const std::vector<std::uint16_t>& seeds, std::uint8_t files)) {
  class Folder : public test::CampaignFolder {
   public:
    using CampaignFolder::in;
    using CampaignFolder::write;
    void TestBody() override {}
  };
  const Folder folder;
  const ResultsHead head{
      .campaign = "c", .checksum = "1", .seeds = 70'000, .variants = {"plant"}, .invariants = {"up"}};
  std::vector<std::string> lines(1U + files % 4U);
  std::set<std::uint64_t> expected;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    lines[i % lines.size()] += run_line(1U + seeds[i]);
    expected.insert(seeds[i]);
  }
  std::vector<StoredResults> stored;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string name = std::to_string(i);
    fs::create_directories(folder.in(name));
    folder.write(name + "/results.part.jsonl", to_json(head).dump() + '\n' + lines[i]);
    stored.push_back({folder.in(name), head});
  }
  std::vector<std::uint64_t> found;
  RC_ASSERT(each_run(stored, head, [&](std::uint64_t number, const std::string&) {
              found.push_back(number);
            }).has_value());
  RC_ASSERT(found == std::vector<std::uint64_t>(expected.begin(), expected.end()));
}

TEST(Shard, Text_IsItsNumberAndHowManyThereAre) {
  EXPECT_EQ(*parse_shard("3/16"), (Shard{3, 16}));
  for (const char* text : {"0/4", "5/4", "1", "1/", "/4", "a/b", "1/4/4", "1/100001", "-1/4"})
    EXPECT_FALSE(parse_shard(text)) << text;
}

TEST(Histogram, Classes_AreAQuarterWide) {
  TimeHistogram times;
  for (const int us : {0, 1, 5, 100, 1000, 1'000'000}) times.add(std::chrono::microseconds(us));
  for (const auto& [number, count] : times.classes()) {
    const auto begin = TimeHistogram::begin_of(number);
    const auto end = TimeHistogram::begin_of(number + 1);
    EXPECT_LT(begin, end);
    EXPECT_LE((end - begin) * 4, std::max<can::Duration>(begin, std::chrono::microseconds(4)));
  }
  TimeHistogram again;
  EXPECT_TRUE(again.read(times.to_json()));
  EXPECT_EQ(again.classes(), times.classes());
  EXPECT_EQ(again.longest(), std::chrono::seconds(1));
}

TEST(Histogram, ClassBehindTheLongestTime_BeginsWithIt) {
  TimeHistogram times;
  ASSERT_TRUE(times.read(*text::parse_json(R"({"longest": 1.5, "classes": {"256": 3}})")));
  EXPECT_EQ(times.quantile(0.5), std::chrono::milliseconds(1500));
  can::Duration before{};
  for (unsigned number = 1; number <= 257; ++number) {
    EXPECT_GE(TimeHistogram::begin_of(number), before) << number;
    before = TimeHistogram::begin_of(number);
  }
}

}  // namespace
}  // namespace canopus::campaign::results_test
