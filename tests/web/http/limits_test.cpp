// How often one may ask and try: moments are given.

#include "canopus/web/http/limits.hpp"

#include <gtest/gtest.h>

#include "canopus/web/access/sessions.hpp"

namespace canopus::web::limits_test {
namespace {

using namespace std::chrono_literals;

const WebMoment start{1h};

link::InternetAddress address(const char* text) { return *link::parse_internet_address(text); }

int admitted(WebRate& rate, const link::InternetAddress& from, WebMoment now, int asked = 1000) {
  int count = 0;
  for (int i = 0; i < asked; ++i) count += rate.admits(from, now) ? 1 : 0;
  return count;
}

TEST(WebRate, SoManyAtOnce_ThenSoManyASecond) {
  WebRate rate({.of_address_at_once = 10, .of_address = 2, .in_all_at_once = 100, .in_all = 50});
  EXPECT_EQ(admitted(rate, address("10.0.0.1"), start), 10);
  EXPECT_EQ(admitted(rate, address("10.0.0.1"), start + 1s), 2);
  EXPECT_EQ(admitted(rate, address("10.0.0.1"), start + 1h), 10) << "no more than at once";
}

TEST(WebRate, OneAddressDoesNotTakeFromAnother_UntilAllTogetherAreTooMany) {
  WebRate rate({.of_address_at_once = 10, .of_address = 2, .in_all_at_once = 25, .in_all = 1});
  EXPECT_EQ(admitted(rate, address("10.0.0.1"), start), 10);
  EXPECT_EQ(admitted(rate, address("10.0.0.2"), start), 10);
  EXPECT_EQ(admitted(rate, address("10.0.0.3"), start), 5);
  EXPECT_EQ(admitted(rate, address("10.0.0.4"), start), 0);
}

TEST(WebRate, ANetworkOfIpv6IsOneAddress) {
  WebRate rate({.of_address_at_once = 10, .of_address = 2});
  EXPECT_EQ(admitted(rate, address("fd00::1"), start), 10);
  EXPECT_EQ(admitted(rate, address("fd00::ffff:1:2:3"), start), 0);
  EXPECT_EQ(admitted(rate, address("fd00:0:0:1::1"), start), 10);
}

TEST(WebRate, ThisMachineIsOneAddress) {
  WebRate rate({.of_address_at_once = 10, .of_address = 2});
  EXPECT_EQ(admitted(rate, address("127.0.0.1"), start), 10);
  EXPECT_EQ(admitted(rate, address("127.1.2.3"), start), 0);
  EXPECT_EQ(admitted(rate, address("::1"), start), 0);
}

TEST(WebRate, AddressesDoNotFillTheMemory) {
  WebRate rate({.most_addresses = 50});
  link::InternetAddress from = address("fd00::1");
  for (unsigned i = 0; i < 5000; ++i) {
    from[6] = static_cast<std::uint8_t>(i >> 8);
    from[7] = static_cast<std::uint8_t>(i);
    (void)rate.admits(from, start + i * 1ms);
    ASSERT_LE(rate.addresses(), 50U);
  }
}

const WebAttemptOptions few{.at_once = 3,
                            .first_wait = 1s,
                            .longest_wait_of_address = 60s,
                            .longest_wait_of_user = 8s,
                            .forgotten_after = 900s,
                            .most_kept = 20};

TEST(WebAttempts, AFewAtOnce_ThenEachWaitsTwiceAsLong) {
  WebAttempts attempts(few);
  WebMoment now = start;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(attempts.wait(address("10.0.0.1"), "anna", now), 0s);
  for (const auto wait : {1s, 2s, 4s, 8s, 16s, 32s, 60s, 60s}) {
    EXPECT_EQ(attempts.wait(address("10.0.0.1"), "anna", now), wait);
    EXPECT_EQ(attempts.wait(address("10.0.0.1"), "anna", now), wait) << "asking costs nothing";
    now += wait;
    EXPECT_EQ(attempts.wait(address("10.0.0.1"), "anna", now), 0s) << "counts as failed";
  }
}

TEST(WebAttempts, ManyAddressesAtOneName_WaitToo_ButNotLong) {
  WebAttempts attempts(few);
  for (const char* from : {"10.0.0.1", "10.0.0.2", "10.0.0.3"})
    EXPECT_EQ(attempts.wait(address(from), "anna", start), 0s);
  EXPECT_EQ(attempts.wait(address("10.0.0.4"), "anna", start), 1s);
  EXPECT_EQ(attempts.wait(address("10.0.0.4"), "bob", start), 0s) << "another name";
  WebMoment now = start;
  for (unsigned i = 0; i < 10; ++i) {
    now += 8s;
    link::InternetAddress from = address("10.0.1.0");
    from[15] = static_cast<std::uint8_t>(i);
    EXPECT_EQ(attempts.wait(from, "anna", now), 0s) << "never longer than 8 s";
  }
  EXPECT_EQ(attempts.wait(address("10.0.9.9"), "anna", now), 8s);
}

TEST(WebAttempts, OneAddressAtManyNames_WaitsToo) {
  WebAttempts attempts(few);
  for (const char* name : {"anna", "bob", "nobody"})
    EXPECT_EQ(attempts.wait(address("10.0.0.1"), name, start), 0s);
  EXPECT_EQ(attempts.wait(address("10.0.0.1"), "carl", start), 1s);
  EXPECT_EQ(attempts.wait(address("10.0.0.2"), "carl", start), 0s);
}

TEST(WebAttempts, SuccessAndTime_AreAFreshBeginning) {
  WebAttempts attempts(few);
  for (int i = 0; i < 3; ++i) (void)attempts.wait(address("10.0.0.1"), "anna", start);
  attempts.succeeded(address("10.0.0.1"), "anna");
  EXPECT_EQ(attempts.kept(), 0U);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(attempts.wait(address("10.0.0.1"), "anna", start), 0s);
  EXPECT_EQ(attempts.wait(address("10.0.0.1"), "anna", start), 1s);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(attempts.wait(address("10.0.0.1"), "anna", start + 901s), 0s) << "forgotten";
}

TEST(WebAttempts, NamesDoNotFillTheMemory) {
  WebAttempts attempts(few);
  for (int i = 0; i < 1000; ++i) {
    (void)attempts.wait(address("10.0.0.1"), std::to_string(i), start + i * 61s);
    ASSERT_LE(attempts.kept(), 40U);
  }
}

WebUser anna(WebRole role = WebRole::operate) {
  return {.name = "anna", .address = "10.0.0.1:1", .role = role};
}

TEST(WebSessions, AreFoundByTheirSecretAlone) {
  WebSessions sessions;
  const auto one = sessions.begin(anna(), "hash", start);
  const auto other = sessions.begin({.name = "bob"}, "hash", start);
  EXPECT_NE(one->secret, other->secret);
  EXPECT_NE(one->key, one->secret);
  EXPECT_EQ(sessions.find(one->secret, start), one);
  EXPECT_EQ(sessions.find(other->secret, start), other);
  EXPECT_EQ(sessions.find(one->key, start), nullptr);
  EXPECT_EQ(sessions.find("", start), nullptr);
  sessions.end(*one);
  EXPECT_TRUE(one->is_over);
  EXPECT_EQ(sessions.find(one->secret, start), nullptr);
  EXPECT_EQ(sessions.find(other->secret, start), other);
}

TEST(WebSessions, EndWhenNothingIsDone_ButForWhoOnlyLooks) {
  WebSessions sessions;
  const auto idle = sessions.begin(anna(), "hash", start);
  const auto used = sessions.begin(anna(WebRole::configure), "hash", start);
  const auto looks = sessions.begin(anna(WebRole::look), "hash", start);
  EXPECT_NE(sessions.find(used->secret, start + 20min), nullptr);
  sessions.end_expired(start + 30min);
  EXPECT_FALSE(idle->is_over);
  sessions.end_expired(start + 31min);
  EXPECT_TRUE(idle->is_over);
  EXPECT_FALSE(used->is_over);
  sessions.end_expired(start + 51min);
  EXPECT_TRUE(used->is_over);
  EXPECT_FALSE(looks->is_over);
}

TEST(WebSessions, EndAfterTwelveHours_WhateverIsDone) {
  WebSessions sessions;
  const auto one = sessions.begin(anna(), "hash", start);
  for (auto passed = 0min; passed <= 12h; passed += 10min)
    EXPECT_EQ(sessions.find(one->secret, start + passed), one);
  EXPECT_EQ(sessions.find(one->secret, start + 12h + 1s), nullptr);
  EXPECT_TRUE(one->is_over);
}

TEST(WebSessions, OfOneUserTheOldestGivesWay_AndThereIsALimit) {
  WebSessions sessions({.most = 3, .most_of_user = 2});
  const auto first = sessions.begin(anna(), "hash", start);
  const auto second = sessions.begin(anna(), "hash", start);
  const auto third = sessions.begin(anna(), "hash", start);
  EXPECT_TRUE(first->is_over);
  EXPECT_FALSE(second->is_over);
  EXPECT_FALSE(third->is_over);
  EXPECT_NE(sessions.begin({.name = "bob"}, "hash", start), nullptr);
  EXPECT_EQ(sessions.begin({.name = "carl"}, "hash", start), nullptr);
  EXPECT_EQ(sessions.size(), 3U);
}

TEST(WebSessions, EndWithTheirUser_HisRoleAndHisPassword) {
  WebSessions sessions;
  const auto stays = sessions.begin(anna(), "hash", start);
  const auto gone = sessions.begin({.name = "gone"}, "hash", start);
  const auto other_role = sessions.begin({.name = "bob", .role = WebRole::configure}, "hash", start);
  const auto other_password = sessions.begin({.name = "carl"}, "hash", start);
  sessions.update_users({{.name = "anna", .role = WebRole::operate, .hash = "hash"},
                         {.name = "bob", .role = WebRole::look, .hash = "hash"},
                         {.name = "carl", .role = WebRole::look, .hash = "other"}});
  EXPECT_FALSE(stays->is_over);
  EXPECT_TRUE(gone->is_over);
  EXPECT_TRUE(other_role->is_over);
  EXPECT_TRUE(other_password->is_over);
}

}  // namespace
}  // namespace canopus::web::limits_test
