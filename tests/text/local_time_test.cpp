#include "canopus/text/local_time.hpp"

#include <cstdlib>
#include <ctime>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace canopus::text::local_time_test {
namespace {

using namespace std::chrono_literals;
using std::chrono::local_days;
using std::chrono::sys_days;
using std::chrono::sys_seconds;

TEST(LocalTime, IsAheadOfUtcByTheZonesOffsetAtThatMoment) {
  static constexpr sys_seconds summer_begins = sys_days(2024y / 3 / 31) + 1h;
  const auto central_europe = [](sys_seconds moment) -> std::chrono::seconds {
    return moment < summer_begins ? 1h : 2h;
  };
  EXPECT_EQ(local_time(summer_begins - 1s, central_europe), local_days(2024y / 3 / 31) + 1h + 59min + 59s);
  EXPECT_EQ(local_time(summer_begins, central_europe), local_days(2024y / 3 / 31) + 3h);
}

/// The process's zone while it lives, whatever the machine's is.
class Zone {
 public:
  explicit Zone(const char* zone) {
    if (const char* before = std::getenv("TZ")) before_ = before;
    set(zone);
  }
  ~Zone() { set(before_ ? before_->c_str() : nullptr); }
  Zone(const Zone&) = delete;
  Zone& operator=(const Zone&) = delete;

 private:
  static void set(const char* zone) {
    if (zone == nullptr) {
      ::unsetenv("TZ");
    } else {
      ::setenv("TZ", zone, 1);
    }
    ::tzset();
  }
  std::optional<std::string> before_;
};

TEST(LocalTime, ZoneOfTheProcess_CountsDaylightSavingTime) {
  const Zone zone("CET-1CEST,M3.5.0,M10.5.0/3");
  EXPECT_EQ(zone_offset(sys_days(2024y / 1 / 15) + 12h), 1h);
  EXPECT_EQ(zone_offset(sys_days(2024y / 7 / 15) + 12h), 2h);
}

TEST(LocalTime, ZoneWestOfGreenwich_IsBehind) {
  const Zone zone("NST3:30");
  EXPECT_EQ(local_time(sys_days(2024y / 1 / 1) + 1h), local_days(2023y / 12 / 31) + 21h + 30min);
}

}  // namespace
}  // namespace canopus::text::local_time_test
