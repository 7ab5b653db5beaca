#include "canopus/web/access/audit.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace canopus::web::audit_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class WebAuditTest : public ::testing::Test {
 protected:
  WebAuditTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("canopus-web-audit-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    file_ = (folder_ / "audit").string();
  }
  ~WebAuditTest() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string content() const {
    std::ostringstream text;
    text << std::ifstream(file_).rdbuf();
    return text.str();
  }
  std::filesystem::path folder_;
  std::string file_;
};

TEST(WebAudit, ALineSaysWhoDidWhat_AndWhatBecameOfIt) {
  EXPECT_EQ(audit_line({.plant_time = 12.5,
                        .milliseconds = 1795398123456,
                        .user = {.name = "anna", .address = "10.0.0.1:5", .role = WebRole::operate},
                        .what = "canopus nmt start 3",
                        .code = 7,
                        .message = "the role operate is needed"}),
            "{\"at\":\"2026-11-23T01:42:03.456Z\",\"t\":12.5,\"user\":\"anna\",\"role\":\"operate\","
            "\"address\":\"10.0.0.1:5\","
            "\"do\":\"canopus nmt start 3\",\"code\":7,\"message\":\"the role operate is needed\"}");
}

TEST(WebAudit, NamesCannotForgeALine_OrControlATerminal) {
  EXPECT_THAT(audit_line({.what = "a\"}\n{\"user\":\"x\x1B[2J\xE2\x80\xAE\xFF"}),
              HasSubstr("\"do\":\"a\\\"}\\n{\\\"user\\\":\\\"x\\u001b[2J\\u202e"));
}

TEST_F(WebAuditTest, LinesAreAppended_ForTheOwnerAlone) {
  {
    auto audit = WebAudit::open(file_);
    ASSERT_TRUE(audit) << audit.error();
    (*audit)->add("one");
    (*audit)->add("two");
    EXPECT_EQ((*audit)->next_trouble(), "");
  }
  EXPECT_EQ(content(), "one\ntwo\n");
  { (*WebAudit::open(file_))->add("three"); }
  EXPECT_EQ(content(), "one\ntwo\nthree\n");
  struct stat found {};
  ASSERT_EQ(::stat(file_.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777U, 0600U);
}

TEST_F(WebAuditTest, WhatIsNoFile_IsRefused_AndNotWaitedFor) {
  EXPECT_EQ(WebAudit::open((folder_ / "no" / "audit").string()).error(),
            (folder_ / "no" / "audit").string() + ": No such file or directory");
  EXPECT_FALSE(WebAudit::open(folder_.string()));
  EXPECT_EQ(WebAudit::open("/dev/null").error(), "/dev/null: expected a file");
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  EXPECT_FALSE(WebAudit::open(file_)) << "a FIFO without a reader";
  std::filesystem::remove(file_);
  std::filesystem::create_symlink("elsewhere", file_);
  EXPECT_FALSE(WebAudit::open(file_)) << "a link leads somewhere else";
}

TEST_F(WebAuditTest, WhatCannotBeWritten_IsCounted_AndSaid) {
  auto before = ::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  {
    auto audit = WebAudit::open(file_);
    ASSERT_TRUE(audit);
    (*audit)->add("one");
    while (content() != "one\n") std::this_thread::yield();
    rlimit small = limit;
    small.rlim_cur = 6;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    (*audit)->add("two two");
    (*audit)->add("three three");
    while ((*audit)->lost() != 2) std::this_thread::yield();
    EXPECT_EQ((*audit)->next_trouble(), file_ + ": File too large: lines of the audit log are lost");
    EXPECT_EQ((*audit)->next_trouble(), "");
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
    (*audit)->add("four");
  }
  EXPECT_EQ(content(), "one\ntw\n{\"lost\":2}\nfour\n");
  ::signal(SIGXFSZ, before);
}

}  // namespace
}  // namespace canopus::web::audit_test
