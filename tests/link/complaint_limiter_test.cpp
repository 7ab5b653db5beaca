#include "canopus/link/complaint_limiter.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace canopus::link::complaint_limiter_test {
namespace {

using namespace std::chrono_literals;

TEST(ComplaintLimiter, FirstComplaint_IsSaidAtOnce) {
  ComplaintLimiter limiter;
  EXPECT_EQ(limiter.complain("frames are lost", 0s), "frames are lost");
  EXPECT_EQ(limiter.deadline(), std::nullopt);
}

TEST(ComplaintLimiter, ThoseOfTheSameSecond_AreOneWithTheirNumber) {
  ComplaintLimiter limiter;
  (void)limiter.complain("a", 10s);
  EXPECT_EQ(limiter.complain("b", 10s), std::nullopt);
  EXPECT_EQ(limiter.complain("c", 10s + 999ms), std::nullopt);
  EXPECT_EQ(limiter.deadline(), 11s);
  EXPECT_EQ(limiter.tick(11s - 1ns), std::nullopt);
  EXPECT_EQ(limiter.tick(11s), "c (and 1 more like it)");
  EXPECT_EQ(limiter.deadline(), std::nullopt);
  EXPECT_EQ(limiter.tick(12s), std::nullopt);
}

TEST(ComplaintLimiter, OneThatWaited_IsSaidAsItIs) {
  ComplaintLimiter limiter;
  (void)limiter.complain("a", 0s);
  (void)limiter.complain("b", 0s);
  EXPECT_EQ(limiter.tick(1s), "b");
}

TEST(ComplaintLimiter, WhatWaitedAndWasSaid_BeginsTheNextSecond) {
  ComplaintLimiter limiter;
  (void)limiter.complain("a", 0s);
  (void)limiter.complain("b", 0s);
  (void)limiter.tick(1s);
  EXPECT_EQ(limiter.complain("c", 1s + 500ms), std::nullopt);
  EXPECT_EQ(limiter.deadline(), 2s);
}

TEST(ComplaintLimiter, AfterAQuietSecond_TheNextIsSaidAtOnce) {
  ComplaintLimiter limiter;
  (void)limiter.complain("a", 0s);
  EXPECT_EQ(limiter.complain("a", 1s), "a");
}

TEST(ComplaintLimiter, LateTick_LosesNothing) {
  ComplaintLimiter limiter;
  (void)limiter.complain("a", 0s);
  (void)limiter.complain("b", 0s);
  EXPECT_EQ(limiter.complain("c", 5s), "c (and 1 more like it)");
}

TEST(ComplaintLimiter, Finish_SaysWhatWaitsBeforeItsTime) {
  ComplaintLimiter limiter;
  (void)limiter.complain("a", 0s);
  EXPECT_EQ(limiter.finish(), std::nullopt);
  (void)limiter.complain("b", 0s);
  EXPECT_EQ(limiter.finish(), "b");
}

TEST(ComplaintLimiter, HostileText_IsCutAndPrintable) {
  ComplaintLimiter limiter;
  EXPECT_EQ(limiter.complain("\x1b[2Jx\ny\xc3\xa4", 0s), "?[2Jx?y??");
  const auto cut = limiter.complain(std::string(100'000, 'x'), 1s);
  EXPECT_EQ(cut, std::string(200, 'x') + "...");
}

RC_GTEST_PROP(ComplaintLimiterProperty, AnyTimes_OneASecondAndEveryOneCounted,
              (const std::vector<std::uint16_t>& steps)) {
  ComplaintLimiter limiter;
  ComplaintLimiter::Time now = 0s;
  std::optional<ComplaintLimiter::Time> said_at;
  std::uint64_t counted = 0;
  const auto count = [&](const std::optional<std::string>& text) {
    if (!text) return;
    RC_ASSERT(!said_at || now - *said_at >= 1s);
    said_at = now;
    const std::size_t place = text->find("(and ");
    counted += 1 + (place == std::string::npos ? 0 : std::stoull(text->substr(place + 5)));
  };
  for (const std::uint16_t step : steps) {
    const auto next = now + std::chrono::milliseconds(step % 1500);
    if (const auto due = limiter.deadline(); due && *due <= next) {
      now = *due;
      count(limiter.tick(now));
    }
    now = next;
    count(limiter.complain("x", now));
  }
  if (const auto due = limiter.deadline()) {
    now = *due;
    count(limiter.tick(now));
  }
  RC_ASSERT(counted == steps.size());
}

}  // namespace
}  // namespace canopus::link::complaint_limiter_test
