#include "canopus/can/transmit_queue.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::can::transmit_queue_test {
namespace {

Frame numbered(std::uint32_t identifier, unsigned number) {
  return data_frame(identifier, {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8)});
}

/// What waits in it, next one first.
std::vector<Frame> drained(TransmitQueue& queue) {
  std::vector<Frame> frames;
  while (!queue.empty()) frames.push_back(queue.pop());
  return frames;
}

TEST(TransmitQueue, Sorted_GivesTheLowestIdentifierFirst_AndTheOldestOfEqualOnes) {
  TransmitQueue queue;
  queue.configure(true, 8);
  for (const auto& [identifier, number] : {std::pair{0x200U, 1U}, {0x181U, 2U}, {0x200U, 3U}, {0x080U, 4U}})
    ASSERT_TRUE(queue.push(numbered(identifier, number), 0));
  EXPECT_EQ(drained(queue),
            (std::vector{numbered(0x080, 4), numbered(0x181, 2), numbered(0x200, 1), numbered(0x200, 3)}));
}

TEST(TransmitQueue, Capacity_IsKept_AndWhatIsUnderWayCounts) {
  for (const std::size_t capacity : {1U, 2U, 3U, 8U, 9U}) {
    TransmitQueue queue;
    queue.configure(false, capacity);
    for (unsigned number = 0; number < capacity; ++number)
      ASSERT_TRUE(queue.push(numbered(0x181, number), 0)) << capacity;
    EXPECT_FALSE(queue.push(numbered(0x181, 99), 0)) << capacity;
    const Frame under_way = queue.pop();
    EXPECT_FALSE(queue.push(numbered(0x181, 99), 1)) << capacity;
    queue.push_back_again(under_way);
    EXPECT_EQ(drained(queue).size(), capacity);
  }
}

// Frames come, go onto the wire, come back or are taken out in any order: it does what a list would.
TEST(TransmitQueue, DoesWhatAListWould) {
  std::mt19937 random(1);
  for (unsigned run = 0; run < 400; ++run) {
    const bool sorted = random() % 2 == 0;
    const std::size_t capacity = 1 + random() % 40;
    TransmitQueue queue;
    queue.configure(sorted, capacity);
    std::vector<Frame> list;
    std::optional<Frame> on_wire;
    const auto place_of = [&](const Frame& frame, bool is_oldest) {
      if (!sorted) return is_oldest ? list.begin() : list.end();
      const auto before = [&](const Frame& other) {
        return is_oldest ? arbitration(other) < arbitration(frame) : arbitration(other) <= arbitration(frame);
      };
      return std::ranges::find_if_not(list, before);
    };
    for (unsigned step = 0; step < 300; ++step) {
      switch (random() % 8) {
        case 0:
          if (!on_wire && !list.empty()) {
            on_wire = queue.pop();
            ASSERT_EQ(*on_wire, list.front());
            list.erase(list.begin());
          }
          break;
        case 1: on_wire.reset(); break;
        case 2:
          if (on_wire) {
            queue.push_back_again(*on_wire);
            list.insert(place_of(*on_wire, true), *on_wire);
            on_wire.reset();
          }
          break;
        case 3:
          if (!list.empty()) {
            const Frame frame = list[random() % list.size()];
            queue.remove(frame);
            list.erase(std::ranges::find(list, frame));
          }
          break;
        default: {
          const Frame frame = numbered(0x181 + random() % 4, step);
          const bool has_room = list.size() + (on_wire ? 1 : 0) < capacity;
          ASSERT_EQ(queue.push(frame, on_wire ? 1 : 0), has_room);
          if (has_room) list.insert(place_of(frame, false), frame);
        }
      }
      ASSERT_EQ(queue.size(), list.size());
      if (list.empty()) continue;
      ASSERT_EQ(queue.front(), list.front()) << run << ' ' << step;
    }
    EXPECT_EQ(drained(queue), list);
  }
}

}  // namespace
}  // namespace canopus::can::transmit_queue_test
