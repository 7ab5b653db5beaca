// Who prints never waits for a reader who does not read; nothing is lost without a word about it.

#include "canopus/cli/output/output_queue.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace canopus::cli::output_queue_test {
namespace {

using namespace std::chrono_literals;

constexpr auto forever = [](auto) { return true; };
constexpr auto not_at_all = [](auto) { return false; };

std::string lost_line(std::uint64_t lines) { return fmt::format("{} lines lost\n", lines); }

/// A pipe with a reader that reads when it is asked to.
class Pipe {
 public:
  Pipe() {
    EXPECT_EQ(::pipe2(ends_.data(), O_CLOEXEC), 0);
    (void)::fcntl(ends_[1], F_SETPIPE_SZ, 4096);
  }
  ~Pipe() {
    close_reader();
    close_writer();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] int writer() const { return ends_[1]; }
  void close_reader() { close(ends_[0]); }
  void close_writer() { close(ends_[1]); }
  /// The first octet, as soon as it is there.
  std::string read_first() {
    char octet = 0;
    return ::read(ends_[0], &octet, 1) == 1 ? std::string(1, octet) : "";
  }
  /// What comes until the text ends so.
  std::string read_until(std::string_view end) {
    std::string text;
    std::array<char, 4096> piece{};
    while (!text.ends_with(end)) {
      const ssize_t size = ::read(ends_[0], piece.data(), piece.size());
      if (size <= 0) break;
      text.append(piece.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

 private:
  static void close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

TEST(OutputQueue, LinesComeInOrder) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {});
  queue.line("one");
  queue.line("{} {}", "two", 2);
  queue.json({{"three", 3}});
  EXPECT_EQ(queue.finish(forever), 0U);
  EXPECT_EQ(pipe.read_until("}\n"), "one\ntwo 2\n{\"three\":3}\n");
}

TEST(OutputQueue, ThreadIsThereFromTheFirstLineOn) {
  const auto threads = [] {
    const std::filesystem::directory_iterator all("/proc/self/task");
    return std::distance(begin(all), end(all));
  };
  Pipe pipe;
  const auto before = threads();
  OutputQueue queue(pipe.writer(), {});
  EXPECT_TRUE(queue.is_idle());
  EXPECT_TRUE(queue.flush(forever));
  EXPECT_EQ(threads(), before);
  queue.line("one");
  EXPECT_EQ(threads(), before + 1);
  EXPECT_EQ(queue.finish(forever), 0U);
  EXPECT_EQ(pipe.read_until("\n"), "one\n");
}

TEST(OutputQueue, NothingIsPrintedAfterTheEndOfAQueueThatNobodyUsed) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {});
  EXPECT_EQ(queue.finish(forever), 0U);
  queue.line("too late");
  EXPECT_EQ(queue.lost(), 1U);
  EXPECT_EQ(queue.finish(forever), 0U);
  pipe.close_writer();
  EXPECT_EQ(pipe.read_until("late\n"), "");
}

TEST(OutputQueue, UnreadLinesAreLostAndTheirNumberIsSaidAtTheirPlace) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {.lost_line = lost_line, .capacity = 10'000});
  // The thread is in the middle of a line that the pipe cannot hold, and stays there until somebody reads.
  const std::string long_line(20'000, 'x');
  queue.line("{}", long_line);
  ASSERT_EQ(pipe.read_first(), "x");
  const std::uint64_t count = 5000;
  for (std::uint64_t i = 0; i < count; ++i) queue.line("line {}", i);
  const std::uint64_t lost = queue.lost();
  ASSERT_GT(lost, 3000U) << "nobody reads, and it holds 10 kB";
  ASSERT_LT(lost, count);

  const std::string end = fmt::format("{} lines lost\n", lost);
  std::string expected = long_line.substr(1) + "\n";
  for (std::uint64_t i = 0; i < count - lost; ++i) expected += fmt::format("line {}\n", i);
  EXPECT_EQ(pipe.read_until("lost\n"), expected + end);
  queue.line("it flows again");
  EXPECT_EQ(pipe.read_until("again\n"), "it flows again\n");
  EXPECT_EQ(queue.finish(forever), 0U);
}

TEST(OutputQueue, WithPatienceNothingIsLost) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {.lost_line = lost_line, .capacity = 100});
  queue.set_patience(forever);
  std::string text;
  std::thread reader([&] { text = pipe.read_until("line 2999\n"); });
  std::string expected;
  for (int i = 0; i < 3000; ++i) {
    queue.line("line {}", i);
    expected += fmt::format("line {}\n", i);
  }
  EXPECT_EQ(queue.finish(forever), 0U);
  reader.join();
  EXPECT_EQ(text, expected);
  EXPECT_EQ(queue.lost(), 0U);
}

TEST(OutputQueue, PatienceEndsTheWaitForAReaderWhoDoesNotRead) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {.lost_line = lost_line, .capacity = 100});
  queue.line("{}", std::string(20'000, 'x'));
  ASSERT_EQ(pipe.read_first(), "x");
  int asked = 0;
  queue.set_patience([&](auto) { return ++asked < 3; });
  queue.line("{}", std::string(90, 'y'));
  queue.line("this does not fit");
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(queue.lost(), 1U);
  EXPECT_EQ(queue.finish(not_at_all), 3U) << "what is left of the first line, the second, and the lost one";
}

TEST(OutputQueue, PatienceCountsFromTheLineThatWaits) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {});
  queue.line("one");
  ASSERT_EQ(pipe.read_until("\n"), "one\n");
  ASSERT_TRUE(queue.flush(forever));
  const auto begun = std::chrono::steady_clock::now();
  queue.line("{}", std::string(20'000, 'x'));
  queue.flush([&](auto since) {
    EXPECT_LE(since, std::chrono::steady_clock::now() - begun);
    return false;
  });
}

TEST(OutputQueue, ALineLongerThanTheQueueGoesThroughAlone) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {.capacity = 100});
  const std::string longer(20'000, 'x');
  std::string text;
  std::thread reader([&] { text = pipe.read_until("\n"); });
  queue.line("{}", longer);
  EXPECT_EQ(queue.finish(forever), 0U);
  reader.join();
  EXPECT_EQ(text, longer + "\n");
}

TEST(OutputQueue, GatheredLinesComeTogetherWhenTheyArePassedOn) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {});
  queue.gather();
  queue.line("one");
  queue.line("two");
  queue.pass_on();
  EXPECT_EQ(pipe.read_until("two\n"), "one\ntwo\n");
  queue.line("three");
  queue.end_gathering();
  EXPECT_EQ(pipe.read_until("three\n"), "three\n");
  queue.line("four");
  EXPECT_EQ(pipe.read_until("four\n"), "four\n");
  queue.gather();
  queue.line("five");
  EXPECT_EQ(queue.finish(forever), 0U);
  EXPECT_EQ(pipe.read_until("five\n"), "five\n");
}

TEST(OutputQueue, ManyGatheredLinesGoOnByThemselves) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {.lost_line = lost_line, .capacity = 100});
  queue.set_patience(forever);
  queue.gather();
  std::string text;
  std::thread reader([&] { text = pipe.read_until("line 2999\n"); });
  std::string expected;
  for (int i = 0; i < 3000; ++i) {
    queue.line("line {}", i);
    expected += fmt::format("line {}\n", i);
  }
  queue.pass_on();
  reader.join();
  EXPECT_EQ(text, expected);
  EXPECT_EQ(queue.lost(), 0U);
}

TEST(OutputQueue, AReaderThatHasGoneIsAnError) {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  std::atomic<int> failed{0};
  OutputQueue queue(pipe.writer(), {.failed = [&](int error) { failed = error; }});
  pipe.close_reader();
  queue.line("nobody hears this");
  EXPECT_TRUE(queue.flush(forever)) << "there is nothing to wait for";
  EXPECT_EQ(queue.error(), EPIPE);
  EXPECT_EQ(failed, EPIPE);
  EXPECT_TRUE(queue.is_idle());
  queue.line("nor this");
  EXPECT_EQ(queue.finish(forever), 0U);
  (void)std::signal(SIGPIPE, before);
}

TEST(OutputQueue, AReaderThatGoesLaterIsNoticedWithoutALine) {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  std::atomic<int> failed{0};
  OutputQueue queue(pipe.writer(), {.failed = [&](int error) {
                      failed = error;
                      failed.notify_one();
                    }});
  queue.line("one");
  EXPECT_EQ(pipe.read_until("\n"), "one\n");
  pipe.close_reader();
  failed.wait(0);
  EXPECT_EQ(failed, EPIPE);
  (void)std::signal(SIGPIPE, before);
}

TEST(OutputQueue, AFullDeviceIsAnError) {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(full, 0);
  OutputQueue queue(full, {});
  queue.line("one");
  EXPECT_TRUE(queue.flush(forever));
  EXPECT_EQ(queue.error(), ENOSPC);
  EXPECT_EQ(queue.finish(forever), 0U);
  ::close(full);
}

TEST(OutputQueue, TheDescriptionStaysBlocking) {
  Pipe pipe;
  OutputQueue queue(pipe.writer(), {});
  queue.line("one");
  EXPECT_EQ(queue.finish(forever), 0U);
  EXPECT_EQ(::fcntl(pipe.writer(), F_GETFL) & O_NONBLOCK, 0);
}

}  // namespace
}  // namespace canopus::cli::output_queue_test
