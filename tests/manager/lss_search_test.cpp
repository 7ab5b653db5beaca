// Looking for a device by its LSS address at every bit rate [CiA 305; ME3CAN1-Q 4.8.11].

#include "canopus/lss/lss_search.hpp"

#include <gmock/gmock.h>

#include "master_bench.hpp"

namespace canopus::manager::test::lss_search_test {
namespace {

using ::testing::ElementsAre;

constexpr lss::LssAddress address{0x71, 0xED63, 0x10000, 7};

class Search : public ::testing::Test, public can::Sink, public lss::LssSearchListener {
 public:
  virtual ~Search() = default;
  bool send(const can::Frame& frame) override {
    // A device at another bit rate hears nothing.
    if (bit_rate == device_rate && silent_until <= now) {
      const std::uint8_t command = frame.data[0];
      std::uint8_t reply = 0;
      if (command == 0x43 && present) reply = 0x44;
      if (command == 0x11 || command == 0x13 || command == 0x17) reply = command;
      if (command == 0x15) {
        device_rate = own_rate;
        silent_until = now + 200ms;
      }
      if (reply != 0) answers.push_back(lss::frame(0x7E4, reply, command == refused ? 1 : 0));
    }
    lines.push_back(text(frame).substr(0, 9));
    return true;
  }
  void change_bit_rate(std::uint32_t rate, can::Time) override {
    bit_rate = rate;
    lines.push_back(std::to_string(rate / 1000) + " kbit/s");
  }
  void lss_search_finished(std::uint8_t id, bool found, can::Time) override {
    lines.push_back("node " + std::to_string(id) + (found ? " found" : " not found"));
  }
  /// What comes next: an answer, or the next deadline.
  void step(lss::LssSearch& one) {
    if (!answers.empty()) return one.receive(std::exchange(answers, {}).front(), now);
    now = one.deadline();
    one.tick(now);
  }
  void run() {
    while (search.running()) step(search);
  }

  std::vector<std::string> lines;
  std::vector<can::Frame> answers;
  can::Time now{};
  can::Time silent_until{};
  std::uint32_t own_rate = 250'000;
  std::uint32_t bit_rate = 250'000;
  std::uint32_t device_rate = 250'000;
  bool present = true;
  std::uint8_t refused = 0;
  lss::LssSearch search{*this, *this};
};

TEST_F(Search, AtTheOwnRate_NodeIdBitRateStoreWaiting) {
  EXPECT_TRUE(search.start(5, address, 250'000, now));
  run();
  EXPECT_THAT(lines, ElementsAre("7E5 40 71", "7E5 41 63", "7E5 42 00", "7E5 43 07", "7E5 11 05", "7E5 13 00",
                                 "7E5 17 00", "7E5 04 00", "node 5 found"));
}

TEST_F(Search, AtAnotherRate_IsActivated_AndTheOwnRateComesBack) {
  device_rate = 800'000;
  search.start(5, address, 250'000, now);
  run();
  EXPECT_THAT(lines, ElementsAre("7E5 40 71", "7E5 41 63", "7E5 42 00", "7E5 43 07", "1000 kbit/s",
                                 "7E5 40 71", "7E5 41 63", "7E5 42 00", "7E5 43 07", "800 kbit/s",
                                 "7E5 40 71", "7E5 41 63", "7E5 42 00", "7E5 43 07", "7E5 11 05", "7E5 13 00",
                                 "7E5 17 00", "7E5 15 64", "250 kbit/s", "7E5 04 00", "node 5 found"));
  EXPECT_EQ(device_rate, 250'000U);
}

TEST_F(Search, Nowhere_EveryRateIsTried_AndTheOwnOneComesBack) {
  present = false;
  search.start(5, address, 250'000, now);
  run();
  EXPECT_THAT(only(lines, "kbit/s"), ElementsAre("1000 kbit/s", "800 kbit/s", "500 kbit/s", "125 kbit/s",
                                                 "50 kbit/s", "20 kbit/s", "10 kbit/s", "250 kbit/s"));
  EXPECT_EQ(lines.back(), "node 5 not found");
}

TEST_F(Search, NodeIdRefused_IsNotFound_AndTheDeviceIsLeftWaiting) {
  refused = 0x11;
  search.start(5, address, 250'000, now);
  run();
  EXPECT_EQ(lines[lines.size() - 2], "7E5 04 00");
  EXPECT_EQ(lines.back(), "node 5 not found");
}

// At 10 kbit/s a frame takes 13.5 ms; a controller that is restarted drops what it has not sent.
TEST_F(Search, NodeIdRefusedAtAnotherRate_TheLastFrameGoesOutBeforeTheRateChanges) {
  device_rate = 10'000;
  refused = 0x11;
  search.start(5, address, 250'000, now);
  can::Time left{};
  while (search.running()) {
    step(search);
    if (lines.back() == "7E5 04 00" && left == can::Time{}) left = now;
  }
  EXPECT_THAT(std::vector(lines.end() - 3, lines.end()),
              ElementsAre("7E5 04 00", "250 kbit/s", "node 5 not found"));
  EXPECT_GE(now, left + 13500us);
}

TEST_F(Search, ToWaitingFirst_IsSaidBeforeEachSelection) {
  lss::LssSearch careful{*this, *this, {.to_waiting_first = true}};
  device_rate = 800'000;
  refused = 0x11;
  careful.start(5, address, 250'000, now);
  while (careful.running()) step(careful);
  EXPECT_THAT(lines,
              ElementsAre("7E5 04 00", "7E5 40 71", "7E5 41 63", "7E5 42 00", "7E5 43 07", "1000 kbit/s",
                          "7E5 04 00", "7E5 40 71", "7E5 41 63", "7E5 42 00", "7E5 43 07", "800 kbit/s",
                          "7E5 04 00", "7E5 40 71", "7E5 41 63", "7E5 42 00", "7E5 43 07", "7E5 11 05",
                          "7E5 04 00", "250 kbit/s", "node 5 not found"));
}

TEST_F(Search, BitRateRefused_MattersOnlyWhereItDiffers) {
  refused = 0x13;
  search.start(5, address, 250'000, now);
  run();
  EXPECT_EQ(lines.back(), "node 5 found");
  device_rate = 500'000;
  search.start(5, address, 250'000, now);
  run();
  EXPECT_EQ(lines.back(), "node 5 not found");
  EXPECT_EQ(bit_rate, 250'000U);
}

TEST_F(Search, NotStorable_IsFoundAllTheSame) {
  refused = 0x17;
  search.start(5, address, 250'000, now);
  run();
  EXPECT_EQ(lines.back(), "node 5 found");
}

TEST_F(Search, OwnRateOutsideTheTable_CannotBegin) { EXPECT_FALSE(search.start(5, address, 123'000, now)); }

TEST_F(Search, OwnRateOf100Kbit_HasItsFormerIndex) {
  own_rate = bit_rate = device_rate = 100'000;
  EXPECT_TRUE(search.start(5, address, 100'000, now));
  run();
  EXPECT_EQ(only(lines, "7E5 13"), std::vector<std::string>{"7E5 13 00"});
  EXPECT_EQ(lines.back(), "node 5 found");
}

// At 10 kbit/s a frame takes 13.5 ms: the device's two delays end that much later than the master's would.
TEST_F(Search, AfterTheChange_NothingIsSentBeforeTheDeviceHearsAgain) {
  device_rate = 10'000;
  search.start(5, address, 250'000, now);
  while (search.running() && (lines.empty() || lines.back() != "7E5 15 64")) step(search);
  const can::Time asked = now;
  silent_until = asked + 13500us + 200ms;
  while (search.running() && lines.back() != "7E5 04 00") {
    now = search.deadline();
    search.tick(now);
  }
  EXPECT_GT(now, silent_until);
  EXPECT_LT(now, silent_until + 20ms);
}

}  // namespace
}  // namespace canopus::manager::test::lss_search_test
