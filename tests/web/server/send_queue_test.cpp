#include "canopus/web/server/send_queue.hpp"

#include <gtest/gtest.h>

namespace canopus::web::send_queue_test {
namespace {

SendQueue::Text text(const std::string& words) { return std::make_shared<const std::string>(words); }

SendQueue outbox(std::size_t most) {
  return SendQueue(most, [](std::uint64_t events) { return "lost " + std::to_string(events); });
}

TEST(SendQueue, EventsInTheirOrder_ThenTheState) {
  SendQueue waiting = outbox(10);
  EXPECT_TRUE(waiting.empty());
  waiting.set_state(text("s"));
  waiting.add_event(text("a"));
  waiting.add_event(text("b"));
  EXPECT_FALSE(waiting.empty());
  EXPECT_EQ(waiting.pop_all(), "[a,\nb,\ns]");
  EXPECT_TRUE(waiting.empty());
  EXPECT_EQ(waiting.pop_all(), "[]");
}

TEST(SendQueue, OfStatesTheNewest) {
  SendQueue waiting = outbox(10);
  waiting.set_state(text("old"));
  waiting.set_state(text("new"));
  EXPECT_EQ(waiting.pop_all(), "[new]");
}

TEST(SendQueue, OfMessagesTheNewest_BeforeTheState) {
  SendQueue waiting = outbox(10);
  waiting.set_messages(text("old"));
  waiting.set_messages(text("m"));
  EXPECT_FALSE(waiting.empty());
  waiting.set_state(text("s"));
  waiting.add_event(text("e"));
  EXPECT_EQ(waiting.pop_all(), "[e,\nm,\ns]");
  EXPECT_TRUE(waiting.empty());
}

TEST(SendQueue, EveryReply_UpToALimit) {
  SendQueue waiting = outbox(1);
  EXPECT_TRUE(waiting.add_reply("a"));
  EXPECT_TRUE(waiting.add_reply("b"));
  waiting.set_state(text("s"));
  EXPECT_FALSE(waiting.empty());
  EXPECT_EQ(waiting.pop_all(), "[a,\nb,\ns]");
  EXPECT_TRUE(waiting.empty());
  const std::string large(SendQueue::most_reply_bytes, 'x');
  EXPECT_TRUE(waiting.add_reply(large));
  EXPECT_FALSE(waiting.add_reply("c"));
  (void)waiting.pop_all();
  EXPECT_TRUE(waiting.add_reply(large));
}

TEST(SendQueue, OfTooManyEventsTheNewest_AndHowManyWereLost) {
  SendQueue waiting = outbox(2);
  for (const char* one : {"a", "b", "c", "d", "e"}) waiting.add_event(text(one));
  EXPECT_EQ(waiting.pop_all(), "[lost 3,\nd,\ne]");
  waiting.add_event(text("f"));
  EXPECT_EQ(waiting.pop_all(), "[f]") << "said once";
}

TEST(SendQueue, OfEventsOfManyBytesTheNewest_AndHowManyWereLost) {
  SendQueue waiting = outbox(1000);
  const std::string large(WebEventList::most_bytes / 4, 'x');
  for (int i = 0; i < 100; ++i) waiting.add_event(text(large));
  const std::string all = waiting.pop_all();
  EXPECT_EQ(all.substr(0, 9), "[lost 96,");
  EXPECT_LT(all.size(), WebEventList::most_bytes + 100);
  waiting.add_event(text(std::string(WebEventList::most_bytes + 1, 'x')));
  EXPECT_FALSE(waiting.empty());
  EXPECT_EQ(waiting.pop_all(), "[lost 1]") << "one that has no room at all";
}

}  // namespace
}  // namespace canopus::web::send_queue_test
