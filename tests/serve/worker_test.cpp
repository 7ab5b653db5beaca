#include "canopus/serve/worker.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace canopus::serve::worker_test {
namespace {

using namespace std::chrono_literals;

TEST(Worker, DoesOneAfterTheOther_AndFinishes) {
  std::vector<int> done;
  {
    Worker worker(100, true, 10s);
    for (int i = 0; i < 50; ++i) EXPECT_TRUE(worker.add([&done, i] { done.push_back(i); }));
  }
  ASSERT_EQ(done.size(), 50U);
  EXPECT_TRUE(std::ranges::is_sorted(done));
}

TEST(Worker, TakesSoMany_AndDropsThemAtItsEnd) {
  std::promise<void> go_on, began;
  std::thread other;
  int done = 0;
  {
    Worker worker(2, false, 10s);
    EXPECT_TRUE(worker.add([&] {
      began.set_value();
      go_on.get_future().wait();
    }));
    began.get_future().wait();
    EXPECT_TRUE(worker.add([&] { ++done; }));
    EXPECT_TRUE(worker.add([&] { ++done; }));
    EXPECT_FALSE(worker.add([&] { ++done; }));
    other = std::thread([&] { go_on.set_value(); });
    // May have begun with the others before it hears of its end.
  }
  other.join();
  EXPECT_LE(done, 2);
}

TEST(Worker, IsLeftAlone_WhenItHangs) {
  auto go_on = std::make_shared<std::promise<void>>();
  auto waits = go_on->get_future().share();
  {
    EXPECT_TRUE(Worker(10, true, 10ms).add([waits] { waits.wait(); }));
  }
  go_on->set_value();
}

}  // namespace
}  // namespace canopus::serve::worker_test
