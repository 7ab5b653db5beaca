// A plant with an ME3CAN1-Q in a Layer 2 mode: built-in program, live table, events, mistakes in the file.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/cli/run/live_table.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/events/event_printer.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/plc/rack/rack.hpp"
#include "canopus/text/file_error.hpp"

#include "cli/table_picture.hpp"

namespace canopus::cli::layer2_plant_test {
namespace {

using testing::_;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using namespace std::chrono_literals;

constexpr std::string_view frame_of_the_plant = R"(
[[bus]]
name = "line1"
bit_rate = 250_000
[[plc]]
name = "plc1"
[[plc.module]]
model = "ME3CAN1-Q"
head = 0x20
)";
// Slot 1 receives 123H, slot 2 sends 182H every 100 ms.
constexpr std::string_view partner = R"(
exchange = "10ms"
online = true
buffer = { G21 = 11, G6000 = 0x123, G6001 = 0, G6005 = 0x5FFF, G6006 = 2, G6007 = 10, G10007 = 0x182, G10008 = 0 }
write = { G10010 = 0xB2A2, G10009 = 2 }
watch = ["G10003"]
)";

std::vector<std::string> mistakes(const std::string& text) {
  struct Nobody final : plant::PlantObserver {
  } nobody;
  const plant::PlantReading reading = plant::read_plant(text, "plant.toml");
  std::vector<text::FileError> errors = reading.errors;
  if (errors.empty()) {
    if (auto built = plant::Plant::build(reading.plant, nobody); !built) errors = built.error();
  }
  std::vector<std::string> lines;
  for (const text::FileError& error : errors) lines.push_back(describe(error, "plant.toml"));
  return lines;
}

class Layer2Plant : public testing::Test, public plant::PlantObserver, public can::Participant {
 protected:
  void build(const std::string& text) {
    const plant::PlantReading reading = plant::read_plant(text, "plant.toml");
    ASSERT_THAT(reading.errors, IsEmpty());
    auto built = plant::Plant::build(reading.plant, *this);
    ASSERT_TRUE(built.has_value()) << describe(built.error()[0], "plant.toml");
    plant = std::move(*built);
    raw_plant = plant.get();
    peer = &plant->bus(0).add_port("peer");
    plant->timeline().add(*this);
    peer->connect(*this);
    plant->power_on();
  }
  void run(can::Duration duration) { plant->timeline().run_until(plant->timeline().now() + duration); }

  void receive(const can::Frame& frame, can::Time) override { heard.push_back(frame); }
  void tick(can::Time) override {}

  void on(const plant::Event& event) override {
    std::visit([this](const auto& what) { note(what); }, event.what);
  }
  template <typename Other>
  void note(const Other&) {}
  void note(const plant::BootUp& boot) { events.push_back(describe(boot.node) + " boot"); }
  void note(const plant::EmergencySent& sent) { events.push_back(describe(sent.node) + " emcy"); }
  void note(const plant::NmtStateChange& change) {
    events.push_back(fmt::format("{} {}", describe(change.node), canopen::name(change.state)));
  }
  void note(const plant::SignalChange& change) {
    events.push_back(fmt::format("{}{:02X} {}", change.device, change.number, change.on ? "ON" : "OFF"));
  }
  void note(const plant::BufferChange& change) {
    events.push_back(
        fmt::format("G{} = {:04X}{}", change.address, change.value, change.by_cpu ? " by CPU" : ""));
  }
  void note(const plant::Failure& failure) { events.push_back(failure.message); }

  std::unique_ptr<plant::Plant> plant;
  plant::Plant* raw_plant = nullptr;
  can::Port* peer = nullptr;
  LiveTable table{raw_plant};
  std::vector<can::Frame> heard;
  std::vector<std::string> events;
};

TEST_F(Layer2Plant, TheBuiltInProgramSetsTheModuleUp_AndItTalksToAPeer) {
  build(std::string(frame_of_the_plant) + std::string(partner));
  run(900ms);
  EXPECT_THAT(events, IsEmpty());
  run(200ms);
  EXPECT_THAT(events,
              ElementsAre("X20 ON", "G10009 = 0002 by CPU", "G10010 = B2A2 by CPU", "Y23 ON", "X23 ON"));
  heard.clear();
  events.clear();
  peer->send(can::data_frame(0x123, {0x5A, 0xA5}));
  run(100ms);
  EXPECT_THAT(events, ElementsAre("G10003 = A55A"));
  EXPECT_THAT(heard, ElementsAre(can::data_frame(0x182, {0xA2, 0xB2})));
}

TEST_F(Layer2Plant, TableAndSummary_TellItsState_AndCountItsFrames) {
  build(std::string(frame_of_the_plant) + std::string(partner));
  run(2050ms);
  EXPECT_THAT(shown(table, plant->timeline().now(), {.rows = 40, .columns = 80}),
              HasSubstr("   -  ME3CAN1-Q U2  layer 2 online "));
  plant::RunSummary summary{.end = plant->timeline().now(), .wall = 1s, .nodes = plant->nodes()};
  EXPECT_THAT(describe(summary), ElementsAre(_, "line1 (ME3CAN1-Q U2): layer 2 online, 10 frames sent",
                                             "1 of 1 node operational"));
  const std::uint8_t off = 0;
  ASSERT_TRUE(plant->rack(0).write_bits(plc::Device::y, 0x23, {&off, 1}, plant->timeline().now()));
  const std::uint8_t on = 1;
  ASSERT_TRUE(plant->rack(0).write_bits(plc::Device::y, 0x23, {&on, 1}, plant->timeline().now()));
  ASSERT_TRUE(plant->rack(0).write_bits(plc::Device::y, 0x23, {&off, 1}, plant->timeline().now()));
  run(10ms);
  summary.nodes = plant->nodes();
  EXPECT_THAT(describe(summary),
              ElementsAre(_, HasSubstr("layer 2 offline, 10 frames sent"), "0 of 1 node operational"));
}

TEST_F(Layer2Plant, FramesOfAPlainBus_AreNotReadAsCanopen) {
  build(std::string(frame_of_the_plant) + std::string(partner));
  run(1500ms);
  events.clear();
  peer->send(can::data_frame(0x705, {0x00}));
  peer->send(can::data_frame(0x706, {0x05}));
  peer->send(can::data_frame(0x081, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  run(100ms);
  EXPECT_THAT(events, IsEmpty());
}

TEST_F(Layer2Plant, WithACanopenNodeOnTheBus_TheyAre) {
  build(std::string(frame_of_the_plant) + std::string(partner) +
        "[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0x40\nnode = 9\n");
  run(1500ms);
  EXPECT_THAT(events, Contains("line1 node 9 (ME3CAN1-Q U4) boot"));
  peer->send(can::data_frame(0x705, {0x00}));
  peer->send(can::data_frame(0x081, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  run(100ms);
  EXPECT_THAT(events, Contains("line1 node 5 boot"));
  EXPECT_THAT(events, Contains("line1 node 1 emcy"));
}

TEST_F(Layer2Plant, TheBuiltInProgramSetsUpAgainAfterARestart) {
  build(std::string(frame_of_the_plant) + "restart_time = \"100ms\"\n" + std::string(partner));
  run(1500ms);
  events.clear();
  const std::uint8_t on = 1;
  ASSERT_TRUE(plant->rack(0).write_bits(plc::Device::y, 0x22, {&on, 1}, plant->timeline().now()));
  run(120ms);
  EXPECT_THAT(events, Contains("G10009 = 0002 by CPU"));
  EXPECT_EQ(events.back(), "X23 ON");
}

TEST(Layer2PlantFile, MistakesAreNamed) {
  const std::string plant(frame_of_the_plant);
  EXPECT_THAT(
      mistakes(plant + "buffer = { G21 = 11, G6000 = 0x800, G6001 = 0 }\n"),
      ElementsAre("plant.toml:10:22: G6000: the ME3CAN1-Q does not go online in its Layer 2 mode with this "
                  "word, or without it"));
  EXPECT_THAT(mistakes(plant + "buffer = { G21 = 11, G6001 = 0x5FFF }\n"),
              ElementsAre(HasSubstr("G10000: the ME3CAN1-Q does not go online")));
  EXPECT_THAT(mistakes(plant + "buffer = { G21 = 29, G6000 = 0x800, G6001 = 0 }\n"), IsEmpty());
  EXPECT_THAT(mistakes(plant + "buffer = { G21 = 11, G10002 = 2 }\n"),
              ElementsAre(HasSubstr(
                  "G10002 = 2: the ME3CAN1-Q does not take this value, or does not save this word")));
  EXPECT_THAT(mistakes(plant + "write = { G10002 = 2 }\n"),
              ElementsAre("plant.toml:10:11: write: G10002 = 2: the ME3CAN1-Q does not take this"));
  EXPECT_THAT(mistakes(plant + "buffer = { G21 = 11 }\nwrite = { G8452 = 9 }\n"),
              ElementsAre(HasSubstr("write: G8452 = 9: the ME3CAN1-Q does not take this")));
  EXPECT_THAT(mistakes(plant + "online = 1\n"), Not(IsEmpty()));
}

}  // namespace
}  // namespace canopus::cli::layer2_plant_test
