// `canopus campaign`: exit codes, what its options take, and what is kept when it is ended.

#include "canopus/cli/run/campaign_command.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canopus/cli/app/command_line.hpp"

#include "paths.hpp"

namespace canopus::cli::campaign_command_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class CampaignCommand : public testing::Test {
 protected:
  CampaignCommand() {
    static int number = 0;
    folder_ = fs::temp_directory_path() /
              ("canopus-campaign-command-" + std::to_string(::getpid()) + "-" + std::to_string(++number));
    fs::create_directories(folder_);
  }
  ~CampaignCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string in(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(in(name)).rdbuf();
    return text.str();
  }
  /// A campaign over the first plant; what holds until 1.1 s is `good`.
  std::string campaign(bool good, const std::string& more = "") {
    const std::string path = in(good ? "good.toml" : "bad.toml");
    std::ofstream(path) << "[campaign]\nplant = \"" << CANOPUS_SOURCE_DIR
                        << "/examples/first-plant/plant.toml\"\nduration = \"1100ms\"\nseeds = 6\n"
                        << "[[invariant]]\nname = \"boots\"\nkind = \"event\"\nevent = \"boot\"\nexpect = \""
                        << (good ? "sometimes" : "never") << "\"\n"
                        << more;
    return path;
  }
  struct Ended {
    int code;
    std::string out, error;
  };
  Ended run(CampaignOptions options) {
    if (options.results.empty()) options.results = in("results");
    text::TextOutput out;
    text::TextOutput err;
    const int code = run_campaign(options, out, err);
    return {code, out.text(), err.text()};
  }
  static Ended command(const std::vector<std::string>& words) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = run_command_line(words);
    return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
  }

  fs::path folder_;
};

TEST_F(CampaignCommand, ThatFindsNothing_EndsWith0AndItsReports) {
  const Ended ended = run({.campaign = campaign(true), .jobs = 2});
  EXPECT_EQ(ended.code, 0) << ended.out << ended.error;
  EXPECT_THAT(ended.out, HasSubstr("campaign: 6 runs, 0 failed, 0 kinds of failure\n"));
  for (const std::string name : {"results.jsonl", "report.html", "junit.xml"})
    EXPECT_TRUE(fs::exists(in("results/" + name))) << name;
  EXPECT_FALSE(fs::exists(in("results/results.part.jsonl")));
}

TEST_F(CampaignCommand, ThatFindsFailures_EndsWith1) {
  const Ended ended = run({.campaign = campaign(false), .jobs = 1});
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.out, HasSubstr("FAILED 6 of 6 runs: boots: "));
}

TEST_F(CampaignCommand, WithAHole_EndsWith1) {
  const Ended ended = run({.campaign = campaign(true,
                                                "[[invariant]]\nname = \"never comes\"\nkind = "
                                                "\"event\"\nevent = \"lift\"\nexpect = \"sometimes\"\n"),
                           .jobs = 1});
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.out, HasSubstr("HOLE: no run reached \"never comes\", which is expected sometimes"));
}

TEST_F(CampaignCommand, ThatCannotBeRead_EndsWith2AndWritesNothing) {
  const Ended ended = run({.campaign = in("none.toml")});
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.error, HasSubstr("none.toml"));
  EXPECT_FALSE(fs::exists(in("results")));
  EXPECT_EQ(run({.campaign = ""}).error,
            "canopus: expected CAMPAIGN, a campaign file, or the command report or compare\n");
}

TEST_F(CampaignCommand, OfOneSeed_PrintsItAndWritesNoFile) {
  const Ended ended = run({.campaign = campaign(false), .seed = 3});
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.out, HasSubstr("variant plant, seed 3:\n"));
  EXPECT_THAT(ended.out, HasSubstr("FAILED at "));
  EXPECT_FALSE(fs::exists(in("results")));
}

TEST_F(CampaignCommand, OfAnUnknownVariant_EndsWith2) {
  const Ended ended = run({.campaign = campaign(true), .seed = 1, .variant = "new"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(ended.error, "canopus: --variant new: the campaign has no variant of this name\n");
}

TEST_F(CampaignCommand, WithoutTime_BeginsNoRun) {
  const Ended ended = run({.campaign = campaign(true), .time = "0s", .jobs = 1});
  EXPECT_THAT(ended.out, HasSubstr("0 of 6 runs are done; the same command continues"));
}

TEST_F(CampaignCommand, OfAShard_RunsItsShareAlone_AndTheReportNamesTheOther) {
  const std::string file = campaign(true);
  EXPECT_EQ(run({.campaign = file, .shard = "2/3", .results = in("s/shard-2-of-3"), .jobs = 1}).code, 0);
  EXPECT_EQ(run({.campaign = file, .shard = "1/3", .results = in("s/shard-1-of-3"), .jobs = 1}).code, 0);
  const Ended report = command({"campaign", "report", in("s")});
  EXPECT_EQ(report.code, 1);
  EXPECT_THAT(report.out, HasSubstr("MISSING: shard 3/3: 2 runs"));
  EXPECT_TRUE(fs::exists(in("s/report.html")));
}

TEST_F(CampaignCommand, EndedByCtrlC_KeepsWhatIsDone_AndContinues) {
  const std::string file = campaign(true);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    CampaignOptions options{.campaign = file, .seeds = 1'000'000, .results = in("results"), .jobs = 1};
    text::TextOutput out;
    text::TextOutput err;
    ::_exit(run_campaign(options, out, err));
  }
  // Its results have a line of a run: it is in the middle of them.
  while (std::ranges::count(read("results/results.part.jsonl"), '\n') < 3) {
    ASSERT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "it has ended by itself";
    ::usleep(1000);
  }
  (void)::kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  const std::string kept = read("results/results.jsonl");
  const auto runs = std::ranges::count(kept, '\n') - 1;
  EXPECT_GE(runs, 2);
  EXPECT_FALSE(fs::exists(in("results/results.part.jsonl")));
  CampaignOptions more{.campaign = file, .seeds = static_cast<std::uint64_t>(runs) + 2, .jobs = 1};
  EXPECT_THAT(run(more).out, HasSubstr("campaign: " + std::to_string(runs + 2) + " runs, 0 failed"));
  const std::string all = read("results/results.jsonl");
  EXPECT_EQ(all.substr(all.find('\n'), kept.size() - kept.find('\n')), kept.substr(kept.find('\n')));
}

TEST_F(CampaignCommand, WithATime_EndedByCtrlCWhileFailuresAreMadeSmaller_WritesNoFurtherStory) {
  const std::string file = campaign(false);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    CampaignOptions options{.campaign = file, .seeds = 1, .results = in("results"), .time = "24h", .jobs = 1};
    text::TextOutput out;
    text::TextOutput err;
    ::_exit(run_campaign(options, out, err));
  }
  while (!fs::exists(in("results/results.jsonl"))) {  // the runs are done, and four kinds of failures found
    ASSERT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "it has ended by itself";
    ::usleep(1000);
  }
  (void)::kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  int stories = 0;
  std::error_code none;
  for (const auto& folder : fs::directory_iterator(in("results/failures"), none))
    stories += fs::exists(folder.path() / "story.json");
  EXPECT_LT(stories, 4);
}

TEST_F(CampaignCommand, OptionsWithWrongValues_EndWith2AndSayWhatIsExpected) {
  const std::string file = campaign(true);
  const std::pair<std::vector<std::string>, std::string> wrong[] = {
      {{"--shard", "0/4"}, "\"0/4\": expected a shard as 3/16: its number, from 1, and how many there are"},
      {{"--shard", "5/4"}, "expected a shard as 3/16"},
      {{"--shard", "x"}, "expected a shard as 3/16"},
      {{"--shard", "1/100001"}, "expected a shard as 3/16"},
      {{"--jobs", "0"}, "--jobs"},
      {{"--jobs", "many"}, "--jobs"},
      {{"--seeds", "0"}, "--seeds"},
      {{"--seeds", "10000001"}, "--seeds"},
      {{"--time", "10"}, "--time"},
      {{"--seed", "1", "--shard", "1/2"}, "--shard"},
      {{"--variant", "plant"}, "--seed"}};
  for (const auto& [options, message] : wrong) {
    std::vector<std::string> words{"campaign", file};
    words.insert(words.end(), options.begin(), options.end());
    const Ended ended = command(words);
    EXPECT_EQ(ended.code, 2) << options[0] << " " << options[1];
    EXPECT_THAT(ended.error, HasSubstr(message));
    EXPECT_EQ(ended.out, "");
  }
}

TEST_F(CampaignCommand, Comparison_Of2FoldersThatAreTheSame_EndsWith0) {
  (void)run({.campaign = campaign(true), .jobs = 1});
  const Ended same = command({"campaign", "compare", in("results"), in("results")});
  EXPECT_EQ(same.code, 0);
  EXPECT_EQ(same.out, "no difference\n");
  EXPECT_EQ(command({"campaign", "compare", in("results"), in("none")}).code, 2);
}

}  // namespace
}  // namespace canopus::cli::campaign_command_test
