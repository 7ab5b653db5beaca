// The time that a client has, and what becomes of it where the process did not run.

#include "canopus/link/tcp/connection_timer.hpp"

#include <gtest/gtest.h>

namespace canopus::link::connection_timer_test {
namespace {

using namespace std::chrono_literals;

int late_answers = 0;

/// As if the process had been suspended each time that the timer expired, as often as `late_answers` says.
ConnectionTimer::Clock::time_point now_or_later() {
  const auto now = ConnectionTimer::Clock::now();
  return late_answers-- > 0 ? now + 1h : now;
}

TEST(ConnectionTimer, TimeInWhichTheProcessDidNotRun_IsGivenAgain) {
  boost::asio::io_context context;
  ConnectionTimer timer(context, &now_or_later);
  late_answers = 2;
  int calls = 0;
  timer.set(1ms, [&calls] { ++calls; });
  context.run_one();
  EXPECT_EQ(calls, 0);
  context.run_one();
  EXPECT_EQ(calls, 0);
  late_answers = 0;
  // However slow this machine is: the time comes once the process runs.
  while (calls == 0) context.run_one();
  EXPECT_EQ(calls, 1);
}

TEST(ConnectionTimer, Stopped_CallsNothing) {
  boost::asio::io_context context;
  ConnectionTimer timer(context);
  int calls = 0;
  timer.set(1ms, [&calls] { ++calls; });
  timer.stop();
  context.run();
  EXPECT_EQ(calls, 0);
  EXPECT_FALSE(timer.is_set());
}

}  // namespace
}  // namespace canopus::link::connection_timer_test
