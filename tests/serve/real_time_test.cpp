// How punctual the loop of a plant in real time is for whom. Deadlines are waited for together for an hour, so that what the
// test sees does not hang on how quick the machine is.

#include "canopus/serve/real_time.hpp"

#include <memory>

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/can/timeline.hpp"
#include "canopus/plant/file/plant_file.hpp"

namespace canopus::serve::real_time_test {
namespace {

using ::testing::IsEmpty;
using namespace std::chrono_literals;

class RealTimeTest : public ::testing::Test, public plant::PlantObserver, public can::Ticker {
 protected:
  RealTimeTest() {
    const plant::PlantReading reading =
        plant::read_plant("[[bus]]\nname = \"a\"\nbit_rate = 250_000\n", "plant.toml");
    EXPECT_THAT(reading.errors, IsEmpty());
    auto built = plant::Plant::build(reading.plant, *this);
    EXPECT_TRUE(built.has_value());
    plant_ = std::move(*built);
    plant_->timeline().add(*this);
    clock_ = std::make_unique<RealTime>(io_, *plant_, *this, can::never);
    clock_->wake_together(1h);
    clock_->start();
  }
  /// Somebody of the plant is due so much later.
  void due_in(can::Duration duration) { alarm() = plant_->timeline().now() + duration; }

  void tick(can::Time now) override {
    ++ticks_;
    alarm() = period_ == can::Duration::max() ? can::never : now + period_;
  }

  boost::asio::io_context io_;
  std::unique_ptr<plant::Plant> plant_;
  std::unique_ptr<RealTime> clock_;
  can::Duration period_ = can::Duration::max();
  int ticks_ = 0;
};

TEST_F(RealTimeTest, AccessesThatChangeNoDeadline_RunWhatIsDue_AndWakeTheLoopForNothing) {
  period_ = 100us;
  due_in(100us);
  std::size_t woken = 0;
  while (clock_->now() < can::Time{5ms}) {
    clock_->accessed();
    woken += io_.poll();
  }
  EXPECT_GE(ticks_, 49);
  EXPECT_EQ(woken, 0U);
}

TEST_F(RealTimeTest, AnAccessThatChangesADeadline_IsWaitedForOnItsOwn) {
  (void)clock_->now();
  due_in(100us);
  clock_->accessed();
  io_.run_one_for(10s);  // the timer that this one takes the place of
  io_.run_one_for(10s);
  EXPECT_EQ(ticks_, 1);
}

TEST_F(RealTimeTest, WhoWaitsForWhatComesOfIt_HasEachDeadlineWaitedFor) {
  period_ = 100us;
  (void)clock_->now();
  due_in(100us);
  clock_->touched();
  while (ticks_ < 10 && io_.run_one_for(10s) != 0) {
  }
  EXPECT_GE(ticks_, 10);
}

}  // namespace
}  // namespace canopus::serve::real_time_test
