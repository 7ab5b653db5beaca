// Single frames from the page on a simulated bus: what is on the bus, when, and what is refused.

#include "canopus/web/commands/frame_sending.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/can/bus.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::web::frame_sending_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using namespace std::chrono_literals;
using text::Json;

const std::string device = "[[device]]\nnode = 3\nname = \"encoder\"\neds = \"" CANOPUS_SOURCE_DIR
                           "/examples/devices/encoder.eds\"\n"
                           "[[device]]\nnode = 5\nname = \"io-block\"\neds = \"" CANOPUS_SOURCE_DIR
                           "/examples/devices/io-block.eds\"\n";

class FrameSendingTest : public support::PlantFolder, private can::BusObserver {
 protected:
  void start(const std::string& nodes = device) {
    plant_ = load("[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n" + nodes, no_observer_);
    ASSERT_NE(plant_, nullptr);
    clock_.plant = plant_.get();
    sending_.emplace(io_, *plant_, clock_, 1h);
    plant_->power_on();
    run(3s);
    plant_->bus(0).add_observer(*this);
  }
  void TearDown() override {
    sending_.reset();
    if (plant_) plant_->bus(0).remove_observer(*this);
  }
  [[nodiscard]] can::Time now() const { return plant_->timeline().now(); }
  void run(can::Duration time) {
    const can::Time end = now() + time;
    while (now() < end) {
      io_.restart();
      io_.poll();
      plant_->timeline().run_until(std::min(end, now() + can::Duration(1ms)));
    }
    io_.restart();
    io_.poll();
  }
  void send(const Json& wish) {
    answer_.reset();
    sending_->send(wish, [this](std::expected<Json, std::string> row) { answer_ = std::move(row); });
  }
  std::string refused(const Json& wish) {
    send(wish);
    if (!answer_ || *answer_) return "it was taken";
    return answer_->error();
  }
  void frame_completed(const can::Frame& frame, can::Time, can::Time end) override {
    std::string text =
        fmt::format("{:0{}X}{}", frame.identifier, frame.extended ? 8 : 3, frame.remote ? " R" : "");
    for (unsigned i = 0; i < frame.length() && !frame.remote; ++i)
      text += fmt::format(" {:02X}", frame.data[i]);
    frames_.push_back(text);
    ends_.push_back(end);
  }

  class : public plant::PlantObserver {
  } no_observer_;
  class Clock final : public link::LoopClock {
   public:
    can::Time now() override { return plant->timeline().now(); }
    void touched() override {}
    plant::Plant* plant = nullptr;
  } clock_;
  boost::asio::io_context io_{1};
  std::unique_ptr<plant::Plant> plant_;
  std::optional<FrameSending> sending_;
  std::optional<std::expected<Json, std::string>> answer_;
  std::vector<std::string> frames_;
  std::vector<can::Time> ends_;
};

TEST_F(FrameSendingTest, AListIsOnTheBus_InItsOrder) {
  start();
  send({{"bus", "line1"}, {"frames", {"300#0102", "123#R", "18FF1234#"}}});
  EXPECT_FALSE(answer_) << "it takes plant time";
  run(20ms);
  EXPECT_THAT(frames_, ElementsAre("300 01 02", "123 R", "18FF1234"));
  ASSERT_TRUE(answer_ && *answer_);
  EXPECT_EQ((**answer_)["bus"], "line1");
  EXPECT_EQ((**answer_)["frames"], 3);
  EXPECT_GT((**answer_)["seconds"].get<double>(), 0.0005);
}

TEST_F(FrameSendingTest, AnInterval_IsFromFrameToFrame_AndTheListIsRepeated) {
  start();
  send({{"bus", "line1"}, {"frames", {"300#01", "301#02"}}, {"interval", "10ms"}, {"repeat", 2U}});
  run(100ms);
  ASSERT_THAT(frames_, ElementsAre("300 01", "301 02", "300 01", "301 02"));
  for (std::size_t i = 1; i < ends_.size(); ++i)
    EXPECT_LT(std::chrono::abs((ends_[i] - ends_[i - 1]) - 10ms), 100us) << i;
  ASSERT_TRUE(answer_ && *answer_);
  EXPECT_EQ((**answer_)["frames"], 4);
}

TEST_F(FrameSendingTest, ABusWhereNobodyAcknowledges_SaysSo) {
  start("");
  send({{"bus", "line1"}, {"frames", {"300#01"}}});
  run(3s);
  ASSERT_TRUE(answer_ && !*answer_);
  EXPECT_THAT(answer_->error(),
              HasSubstr("; line1: a frame is not on the bus after 2 s (sent: 0 of 1 frame)"));
  EXPECT_THAT(answer_->error(), HasSubstr("no acknowledgement"));
  frames_.clear();
  run(1s);
  EXPECT_THAT(frames_, IsEmpty());
}

TEST_F(FrameSendingTest, Stop_EndsThem) {
  start();
  send({{"bus", "line1"}, {"frames", {"300#01"}}, {"interval", "1s"}, {"repeat", 100U}});
  run(2500ms);
  EXPECT_THAT(frames_, SizeIs(3));
  EXPECT_EQ(sending_->stop()["stopped"], 1);
  run(5s);
  EXPECT_THAT(frames_, SizeIs(3));
  ASSERT_TRUE(answer_ && !*answer_);
  EXPECT_THAT(answer_->error(), HasSubstr("interrupted (sent: 3 of 100 frames)"));
}

TEST_F(FrameSendingTest, NoMoreThanFourListsAtOnce) {
  start();
  const Json wish{{"bus", "line1"}, {"frames", {"300#01"}}, {"interval", "1s"}, {"repeat", 100U}};
  for (int i = 0; i < 4; ++i) {
    send(wish);
    EXPECT_FALSE(answer_) << i;
  }
  EXPECT_EQ(refused(wish), "other frames are being sent; stop them first, or wait");
}

TEST_F(FrameSendingTest, WhatIsNoFrame_IsRefused_AndNothingIsSent) {
  start();
  const auto frame = [&](const Json& one) {
    return refused({{"bus", "line1"}, {"frames", Json::array({Json("300#01"), one})}});
  };
  EXPECT_THAT(
      frame("30G#01"),
      HasSubstr("frame 2 (30G#01): character 1: expected an identifier of 3 or 8 hexadecimal digits"));
  EXPECT_THAT(frame("800#01"), HasSubstr("frame 2 (800#01): "));
  EXPECT_THAT(frame("300#010203040506070809"), HasSubstr("frame 2 "));
  EXPECT_THAT(frame("300 [1] 01"), HasSubstr("expected a frame without blanks"));
  EXPECT_THAT(frame("300##101"), HasSubstr("frame 2 "));
  EXPECT_THAT(frame("20000004#0001000000000000"), HasSubstr("expected a frame as candump writes it"));
  EXPECT_THAT(frame(5), HasSubstr("frame 2 (): expected a text"));
  EXPECT_EQ(refused({{"bus", "line2"}, {"frames", {"300#01"}}}), "there is no bus \"line2\"");
  EXPECT_EQ(refused({{"bus", "line1"}}), "frames: expected a list of 1 to 1000 frames");
  EXPECT_EQ(refused({{"bus", "line1"}, {"frames", Json::array()}}),
            "frames: expected a list of 1 to 1000 frames");
  EXPECT_EQ(refused({{"bus", "line1"}, {"frames", {"300#01"}}, {"repeat", 0U}}),
            "repeat: expected 1 to 10000");
  EXPECT_THAT(refused({{"bus", "line1"}, {"frames", {"300#01"}}, {"interval", "soon"}}),
              HasSubstr("interval: "));
  EXPECT_EQ(refused({{"bus", "line1"}, {"frames", {"300#01"}}, {"interval", "61s"}}),
            "interval: expected up to 60s");
  Json many = Json::array();
  for (int i = 0; i < 1000; ++i) many.push_back(Json("300#01"));
  EXPECT_EQ(refused({{"bus", "line1"}, {"frames", many}, {"repeat", 101U}}),
            "1000 frames, 101 times: expected at most 100000 in all");
  run(100ms);
  EXPECT_THAT(frames_, IsEmpty());
  EXPECT_EQ(sending_->live_bus({{"bus", "line1"}}), "");
}

}  // namespace
}  // namespace canopus::web::frame_sending_test
