// The trace commands on files: what they keep, and what they must not write over.

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/command_line.hpp"
#include "canopus/cli/terminal/same_file.hpp"

namespace canopus::cli {
namespace {

using testing::HasSubstr;

struct Said {
  int code;
  std::string out, error;
};

Said said(std::vector<std::string> words) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

class TraceCommands : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "trace_commands_" +
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
    std::ofstream(path("a.log")) << text_;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ostringstream all;
    all << std::ifstream(path(name)).rdbuf();
    return all.str();
  }
  const std::string text_ =
      "(100.000000) can0 181#01\n(101.000000) can0 182#02\n(50.000000) can0 183#03\n(102.000000) can0 "
      "184#04\n";

 private:
  std::string folder_;
};

TEST_F(TraceCommands, Convert_KeepsWhatIsDatedBeforeTheFirstFrame) {
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("b.log")}).code, 0);
  EXPECT_THAT(content("b.log"), HasSubstr("183#03"));
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("c.log"), "--start", "0s"}).code, 0);
  EXPECT_THAT(content("c.log"), testing::Not(HasSubstr("183#03")));
}

TEST_F(TraceCommands, ReversedRanges_AreWrongUsage) {
  EXPECT_EQ(said({"trace", "convert", path("a.log"), path("b.log"), "--start", "5s", "--end", "1s"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(path("b.log")));
  EXPECT_THAT(said({"replay", path("a.log"), "--from", "5s", "--to", "1s"}).error,
              HasSubstr("--from is later than --to"));
  EXPECT_THAT(said({"replay", path("a.log"), "--id", "5-1"}).error, HasSubstr("\"5-1\" is no identifier"));
}

TEST_F(TraceCommands, Plot_DoesNotWriteOverItsTrace) {
  EXPECT_EQ(said({"trace", "plot", path("a.log"), "--out", path("a.log")}).code, 2);
  EXPECT_EQ(content("a.log"), text_);
}

TEST_F(TraceCommands, AMissingFile_IsExitCodeTwoAndNoReport) {
  for (const std::string& file : {path("missing.log"), path("")}) {
    EXPECT_EQ(said({"trace", "show", file}).code, 2) << file;
    const Said stats = said({"trace", "stats", file});
    EXPECT_EQ(stats.code, 2) << file;
    EXPECT_EQ(stats.out, "") << file;
    EXPECT_EQ(said({"trace", "plot", file, "--out", path("p.svg")}).code, 2) << file;
    EXPECT_FALSE(std::filesystem::exists(path("p.svg"))) << file;
  }
}

TEST_F(TraceCommands, SameFile_IsKnownByOtherNames) {
  std::filesystem::create_hard_link(path("a.log"), path("link.log"));
  EXPECT_TRUE(is_same_file(path("a.log"), path("link.log")));
  EXPECT_FALSE(is_same_file(path("a.log"), path("other.log")));
  EXPECT_FALSE(is_same_file("-", "-"));
}

}  // namespace
}  // namespace canopus::cli
