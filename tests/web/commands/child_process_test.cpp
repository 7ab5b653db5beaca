// A program that runs beside this one: what it has of this process, and what it may say. Linux's /proc tells what it has.

#include "canopus/web/commands/child_process.hpp"

#include <csignal>
#include <cstdint>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace canopus::web::child_process_test {
namespace {

using ::testing::ElementsAre;

class ChildProcessTest : public ::testing::Test {
 protected:
  /// What a script of the shell says, and how it ended.
  void run(const std::string& script, std::size_t most_output = SIZE_MAX) {
    auto child = ChildProcess::start(io_, "/bin/sh", {"-c", script},
                                     {.line = [this](const std::string& line) { lines_.push_back(line); },
                                      .ended =
                                          [this](int code, const std::string& errors) {
                                            code_ = code;
                                            errors_ = errors;
                                          },
                                      .most_output = most_output});
    ASSERT_TRUE(child) << child.error();
    io_.restart();
    io_.run();
  }

  boost::asio::io_context io_{1};
  std::vector<std::string> lines_;
  int code_ = -1;
  std::string errors_;
};

TEST_F(ChildProcessTest, SaysLinesAndErrors_AndEndsWithItsCode) {
  run("echo one; echo two >&2; printf three; exit 5");
  EXPECT_THAT(lines_, ElementsAre("one")) << "a line has an end";
  EXPECT_EQ(errors_, "two\n");
  EXPECT_EQ(code_, 5);
}

TEST_F(ChildProcessTest, HasNoDescriptorOfThisProcess) {
  const int open = ::open("/proc/self/status", O_RDONLY);  // no O_CLOEXEC
  ASSERT_GE(open, 3);
  run("for one in /proc/$$/fd/*; do test \"$(readlink $one)\" = /proc/" + std::to_string(::getpid()) +
      "/status && echo left; done; exit 0");
  EXPECT_THAT(lines_, ElementsAre());
  ::close(open);
}

TEST_F(ChildProcessTest, HasAProcessGroupOfItsOwn) {
  run("cut -d ' ' -f 5 /proc/$$/stat; echo $$");
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_EQ(lines_[0], lines_[1]) << "Ctrl-C of the terminal is not for it";
}

TEST_F(ChildProcessTest, HasEverySignalAsItIsByDefault) {
  sigset_t blocked, before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  ASSERT_EQ(::pthread_sigmask(SIG_BLOCK, &blocked, &before), 0);
  const auto pipe = std::signal(SIGPIPE, SIG_IGN);
  run("exec grep -E 'Sig(Blk|Ign)' /proc/self/status");
  (void)std::signal(SIGPIPE, pipe);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ASSERT_EQ(lines_.size(), 2U);
  constexpr std::uint64_t of_programs = 0x7FFFFFFF;  // the first real-time signals are the C library's
  for (const std::string& line : lines_)
    EXPECT_EQ(std::stoull(line.substr(line.find('\t')), nullptr, 16) & of_programs, 0U) << line;
}

TEST_F(ChildProcessTest, LineWithoutAnEnd_EndsIt) {
  run("head -c " + std::to_string(ChildProcess::longest_line + 100000) +
      " /dev/zero | tr '\\0' a; exec sleep 1000");
  EXPECT_NE(code_, 0);
  EXPECT_THAT(lines_, ElementsAre());
}

TEST_F(ChildProcessTest, OfLongErrors_TheBeginningIsKept) {
  run("echo begin >&2; head -c 300000 /dev/zero | tr '\\0' a >&2; exit 3");
  EXPECT_EQ(errors_.size(), ChildProcess::longest_errors);
  EXPECT_TRUE(errors_.starts_with("begin\n"));
  EXPECT_EQ(code_, 3);
}

TEST_F(ChildProcessTest, WhoSaysTooMuch_IsEnded_AndToldSo) {
  run("yes", 100000);
  EXPECT_EQ(code_, 128 + SIGKILL);
  EXPECT_EQ(errors_, "it printed more than 100000 bytes and was ended\n");
}

}  // namespace
}  // namespace canopus::web::child_process_test
