// A node that is alone on its bus.

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plant/plant.hpp"

#include "paths.hpp"

namespace canopus::cli::missing_ack_detector_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

class UnacknowledgedTest : public testing::Test, public plant::PlantObserver {
 protected:
  /// A plant of devices of this file on one bus: further TOML for each.
  void build(const std::vector<std::string>& devices) {
    std::string text = "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n";
    for (const std::string& device : devices) {
      text += "[[device]]\neds = \"" CANOPUS_SOURCE_DIR "/examples/devices/encoder.eds\"\n" + device + "\n";
    }
    const plant::PlantReading reading = plant::read_plant(text, "plant.toml");
    ASSERT_THAT(reading.errors, IsEmpty());
    auto built = plant::Plant::build(reading.plant, *this);
    ASSERT_TRUE(built.has_value());
    plant = std::move(*built);
    plant->power_on();
  }
  void run_until(can::Duration time) { plant->timeline().run_until(can::Time(time)); }
  void on(const plant::Event& event) override {
    const auto* const missing = std::get_if<plant::MissingAck>(&event.what);
    if (missing == nullptr) return;
    EXPECT_LT(event.time, can::Time(100ms));
    heard.push_back(describe(missing->node));
  }

  std::unique_ptr<plant::Plant> plant;
  std::vector<std::string> heard;
};

TEST(LinePrinterTest, LinesThatRepeatQuickly_AreCounted) {
  text::TextOutput out;
  text::TextOutput err;
  plant::LinePrinter printer(out, err, false);
  const plant::NodeLabel node{"line1", "io-block", 2};
  for (int i = 0; i < 1300; ++i) {
    printer.on({can::Time(i * 9ms), plant::MissingAck{node}});
    printer.on({can::Time(i * 9ms), plant::Failure{"line1", "the controller is bus-off"}});
  }
  printer.on({can::Time(20s), plant::BootUp{node}});
  const std::string line = "line1 node 2 (io-block): no acknowledgement: no other node on this bus";
  EXPECT_EQ(out.text(), "    0.000000  " + line + "\n    0.009000  " + line + "\n    0.018000  " + line +
                            "\n         ...  " + line +
                            " (×1300, last 11.7 s)\n   20.000000  line1 node 2 (io-block): boot-up\n");
  EXPECT_THAT(err.text(),
              testing::EndsWith("\n         ...  line1: the controller is bus-off (×1300, last 11.7 s)\n"));
}

TEST_F(UnacknowledgedTest, ALoneNodeIsReportedOnce) {
  build({"node = 3\nname = \"encoder\"\nobjects = { \"1017:00\" = 100 }"});
  run_until(5s);
  EXPECT_THAT(heard, ElementsAre("line1 node 3 (encoder)"));
  EXPECT_GT(plant->bus(0).load(can::Time(5s)).error_frames, 1000U);
}

TEST_F(UnacknowledgedTest, NodesThatHearEachOtherAreNotReported) {
  build({"node = 3\nobjects = { \"1017:00\" = 100 }", "node = 4\nobjects = { \"1017:00\" = 100 }"});
  run_until(5s);
  EXPECT_THAT(heard, IsEmpty());
}

TEST_F(UnacknowledgedTest, ListenersDoNotAcknowledge) {
  build({"node = 3\nname = \"encoder\"", "node = 4\nlisten_only = true"});
  run_until(1s);
  EXPECT_THAT(heard, ElementsAre("line1 node 3 (encoder)"));
}

TEST(UnacknowledgedEvent, IsALineAndJson) {
  text::TextOutput text, errors;
  const plant::NodeLabel node{"line1", "encoder", 3};
  plant::LinePrinter(text, errors, false).on({can::Time(1500us), plant::MissingAck{node}});
  EXPECT_EQ(text.text(),
            "    0.001500  line1 node 3 (encoder): no acknowledgement: no other node on this bus\n");
  text.clear();
  plant::LinePrinter(text, errors, true).on({can::Time(1500us), plant::MissingAck{node}});
  EXPECT_EQ(text.text() + errors.text(), "");
  plant::JsonPrinter(text).on({can::Time(1500us), plant::MissingAck{node}});
  EXPECT_EQ(
      text.text(),
      "{\"t\":0.0015,\"event\":\"unacknowledged\",\"bus\":\"line1\",\"node\":3,\"name\":\"encoder\"}\n");
}

}  // namespace
}  // namespace canopus::cli::missing_ack_detector_test
