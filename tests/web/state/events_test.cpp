// What the page of a run gets: the events of --json, and the state of the plant.

#include "canopus/web/state/events.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/sim/lift/lift_report.hpp"
#include "canopus/web/state/messages.hpp"

#include "paths.hpp"

namespace canopus::web::events_test {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using namespace std::chrono_literals;

constexpr plant::NodeLabel encoder{"line1", "encoder", 3};
constexpr can::Time at{1'250'000us};

/// Counts every call that an observer can get.
class Counting final : public plant::PlantObserver {
 public:
  int calls = 0;
  void on(const plant::Event&) override { ++calls; }
};

TEST(WebEvents, EveryEventComesToBoth) {
  Counting first;
  std::vector<std::string> lines;
  WebEvents events(first);
  events.set_listener([&](std::string_view line) { lines.emplace_back(line); });
  plant::PlantObserver& all = events.observer();
  all.on({at, plant::BootUp{encoder}});
  all.on({at, plant::NmtStateChange{encoder, canopen::NmtState::operational}});
  all.on({at, plant::LssSetting{encoder, 250000}});
  all.on({at, plant::EmergencySent{encoder, {}}});
  all.on({at, plant::MissingAck{encoder}});
  all.on({at, plant::BusErrorEvent{}});
  all.on({at, plant::ControllerChange{encoder, {}}});
  all.on({at, plant::SlaveBootStep{encoder, encoder, {}}});
  all.on({at, plant::SignalChange{"plc1", 'X', 0, true}});
  all.on({at, plant::BufferChange{"plc1", 0, 1, 2, true}});
  all.on({at, plant::ObjectForced{{}}});
  all.on({at, plant::ObjectReleased{{}}});
  all.on({at, plant::LiftChange{"line1", {}}});
  all.on({at, plant::LoadMeasured{"line1", {}}});
  all.on({at, plant::Warning{"a", "b"}});
  all.on({at, plant::ModuleEvent{"plc1", "U0", {}}});
  all.on({at, plant::ModuleError{"plc1", "U0", {}}});
  all.on({at, plant::Failure{"a", "b"}});
  EXPECT_EQ(first.calls, 18);
  EXPECT_THAT(lines, SizeIs(18));
  EXPECT_THAT(lines, Each(AllOf(HasSubstr("\"event\":"), Not(HasSubstr("\n")))));
  EXPECT_EQ(lines[0], R"({"t":1.25,"event":"boot","bus":"line1","node":3,"name":"encoder"})");
}

TEST(WebEvents, WhatCameBeforeThereWasAServer_IsNotLost) {
  Counting first;
  WebEvents events(first);
  events.observer().on({at, plant::Failure{"a", "early"}});
  std::vector<std::string> lines;
  events.set_listener([&](std::string_view line) { lines.emplace_back(line); });
  events.observer().on({at, plant::Failure{"a", "late"}});
  EXPECT_THAT(lines, ElementsAre(HasSubstr("early"), HasSubstr("late")));
  EXPECT_EQ(events.lost(7), R"({"t":1.25,"event":"lost","lines":7})");
}

TEST(WebEvents, ACutBusHasTheLoadOfEachHalf) {
  const std::string device = "[[device]]\neds = \"" CANOPUS_SOURCE_DIR
                             "/examples/devices/encoder.eds\"\nobjects = { \"1017:00\" = 100 }\n";
  const plant::PlantReading reading = plant::read_plant(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[bus.fault]]\nkind = \"cut\"\nports = "
      "[\"far\"]\nfrom = \"1s\"\nuntil = \"3s\"\n" +
          device + "node = 2\nname = \"near\"\n" + device + "node = 3\nname = \"far\"\n",
      "plant.toml");
  ASSERT_TRUE(reading.errors.empty());
  Counting observer;
  auto built = plant::Plant::build(reading.plant, observer);
  ASSERT_TRUE(built.has_value());
  plant::Plant& plant = **built;
  plant.power_on();
  const auto bus_at = [&](can::Time time) {
    plant.timeline().run_until(time);
    return nlohmann::json::parse(state_event(plant))["buses"][0];
  };
  EXPECT_FALSE(bus_at(can::Time{500ms}).contains("cut"));
  const auto cut = bus_at(can::Time{2500ms})["cut"];
  ASSERT_EQ(cut.size(), 2U);
  EXPECT_EQ(cut[0]["nodes"], (nlohmann::json{"near"}));
  EXPECT_EQ(cut[1]["nodes"], (nlohmann::json{"far"}));
  for (const char* field : {"now", "frames", "error_frames"}) EXPECT_TRUE(cut[1].contains(field)) << field;
  EXPECT_GT(cut[1]["now"], 0.0) << "nobody acknowledges the far node: it repeats its frame";
  EXPECT_FALSE(bus_at(can::Time{3500ms}).contains("cut"));
}

TEST(WebEvents, TheStateOfAPlant) {
  const plant::PlantReading reading = plant::read_plant(R"(
[plant]
name = "<b>plant</b>"
[[bus]]
name = "line1"
bit_rate = 250_000
[[plc]]
name = "plc1"
listen = "off"
[[plc.module]]
model = "ME3CAN1-Q"
head = 0x20
bus = "line1"
node = 1
watch = ["G25"]
)",
                                                        "plant.toml");
  ASSERT_TRUE(reading.errors.empty());
  Counting observer;
  auto built = plant::Plant::build(reading.plant, observer);
  ASSERT_TRUE(built.has_value());
  plant::Plant& plant = **built;
  plant.power_on();
  plant.timeline().run_until(can::Time{3s});
  const auto state = nlohmann::json::parse(state_event(plant));
  EXPECT_EQ(state["event"], "state");
  EXPECT_EQ(state["t"], 3.0);
  EXPECT_EQ(state["modules"][0]["model"], "ME3CAN1-Q");
  EXPECT_EQ(state["modules"][0]["signals"], true);
  EXPECT_EQ(state["modules"][0]["words"][0]["name"], "Communication status");
  EXPECT_EQ(state["plant"], "<b>plant</b>");
  EXPECT_EQ(state["live"], false);
  EXPECT_EQ(state["buses"][0]["link"], "sim");
  EXPECT_EQ(state["buses"][0]["bit_rate"], 250000);
  ASSERT_THAT(state["nodes"], SizeIs(1));
  EXPECT_EQ(state["nodes"][0]["node"], 1);
  EXPECT_EQ(state["nodes"][0]["module"], true);
  EXPECT_EQ(state["nodes"][0]["tec"], 128) << "nobody acknowledges";
  EXPECT_EQ(state["nodes"][0]["controller"], "error passive");
  ASSERT_THAT(state["modules"], SizeIs(1));
  EXPECT_EQ(state["modules"][0]["head"], 0x20);
  EXPECT_EQ(state["modules"][0]["cpu"], "RUN");
  EXPECT_EQ(state["modules"][0]["leds"][0]["name"], "RUN");
  EXPECT_EQ(state["modules"][0]["leds"][0]["pattern"], "on");
  EXPECT_EQ(state["modules"][0]["signals_on"][0], "X20");
  EXPECT_EQ(state["modules"][0]["words"][0]["address"], 25);
}

TEST(WebEvents, ASlaveThatItsBusSaysNothingOf_HasNoKnownNmtState) {
  const plant::PlantReading reading = plant::read_plant(R"(
[[bus]]
name = "line1"
bit_rate = 250_000
[[plc]]
listen = "off"
[[plc.module]]
model = "ME3CAN1-Q"
head = 0
node = 1
master = true
slaves = "all"
objects = { "1F81:09" = 0x05 }
)",
                                                        "plant.toml");
  ASSERT_TRUE(reading.errors.empty());
  Counting observer;
  auto built = plant::Plant::build(reading.plant, observer);
  ASSERT_TRUE(built.has_value());
  plant::Plant& plant = **built;
  plant.power_on();
  plant.timeline().run_until(can::Time{3s});
  const auto state = nlohmann::json::parse(state_event(plant));
  ASSERT_THAT(state["slaves"], SizeIs(1));
  EXPECT_EQ(state["slaves"][0]["state"], "not known");
  EXPECT_EQ(state["slaves"][0]["in_operation"], false);
}

TEST(WebEvents, ANodeOnTheFarSideOfACut_IsNotInOperation) {
  const plant::PlantReading reading = plant::read_plant(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n"
      "[[bus.fault]]\nkind = \"cut\"\nports = [\"encoder\"]\nfrom = \"1s\"\nuntil = \"2s\"\n"
      "[[device]]\nnode = 3\nname = \"encoder\"\neds = \"" CANOPUS_SOURCE_DIR
      "/examples/devices/encoder.eds\"\n"
      "[[device]]\nnode = 4\nname = \"drive\"\neds = \"" CANOPUS_SOURCE_DIR "/examples/devices/drive.eds\"\n",
      "plant.toml");
  ASSERT_TRUE(reading.errors.empty());
  Counting observer;
  auto built = plant::Plant::build(reading.plant, observer);
  ASSERT_TRUE(built.has_value());
  plant::Plant& plant = **built;
  plant.power_on();
  const auto cut_off_at = [&](can::Duration moment) {
    plant.timeline().run_until(can::Time{moment});
    std::vector<bool> all;
    const auto state = nlohmann::json::parse(state_event(plant));
    for (const auto& node : state["nodes"]) all.push_back(node.value("cut_off", false));
    return all;
  };
  EXPECT_EQ(cut_off_at(500ms), (std::vector<bool>{false, false}));
  EXPECT_EQ(cut_off_at(1500ms), (std::vector<bool>{true, false}));
  EXPECT_EQ(cut_off_at(2500ms), (std::vector<bool>{false, false}));
}

TEST(BusStatisticsView, HeartbeatsAnswersAndSync_ByThePredefinedConnectionSet) {
  BusStatisticsView figures;
  const auto frame = [&](std::uint32_t id, std::vector<std::uint8_t> data, can::Duration moment) {
    can::Frame one{.identifier = id, .dlc = static_cast<std::uint8_t>(data.size())};
    std::ranges::copy(data, one.data.begin());
    figures.frame_completed(one, can::Time{moment});
  };
  frame(0x705, {0}, 1ms);  // a boot-up message
  EXPECT_FALSE(figures.node(5).heartbeat);
  frame(0x705, {0x7F}, 100ms);
  EXPECT_EQ(figures.node(5).heartbeat, can::Time{100ms});
  EXPECT_EQ(figures.node(5).period, can::Duration{});
  frame(0x705, {0x05}, 350ms);
  EXPECT_EQ(figures.node(5).period, 250ms);
  // An answer counts from the latest request; one without a request is none.
  frame(0x585, {0x60}, 400ms);
  EXPECT_EQ(figures.node(5).answers.count(), 0U);
  frame(0x605, {0x40}, 401ms);
  frame(0x605, {0x40}, 402ms);
  frame(0x585, {0x43}, 405ms);
  frame(0x585, {0x43}, 409ms);
  frame(0x605, {0x40}, 500ms);
  frame(0x585, {0x43}, 501ms);
  EXPECT_EQ(time_fields(figures.node(5).answers).dump(),
            R"({"count":2,"least":0.001,"mean":0.002,"most":0.003})");
  EXPECT_EQ(figures.node(6).answers.count(), 0U);
  for (const can::Duration moment : {1000ms, 1010ms, 1019ms, 1030ms}) frame(0x080, {}, moment);
  EXPECT_EQ(time_fields(figures.sync()).dump(), R"({"count":3,"least":0.009,"mean":0.01,"most":0.011})");
}

TEST(BusStatisticsView, TheNmtState_IsThatOfTheLastErrorControlMessage_OrOfAnNmtCommandSince) {
  BusStatisticsView figures;
  const auto after = [&](std::uint32_t id, std::vector<std::uint8_t> data) {
    can::Frame one{.identifier = id, .dlc = static_cast<std::uint8_t>(data.size())};
    std::ranges::copy(data, one.data.begin());
    figures.frame_completed(one, can::Time{1ms});
    return figures.node(5).state;
  };
  using enum canopen::NmtState;
  EXPECT_EQ(after(0x000, {0x01, 0x00}), std::nullopt) << "nobody has heard of it";
  EXPECT_EQ(after(0x705, {0x00}), pre_operational);
  EXPECT_EQ(after(0x000, {0x01, 0x06}), pre_operational) << "for another one";
  EXPECT_EQ(after(0x000, {0x01, 0x05}), operational);
  EXPECT_EQ(after(0x000, {0x02, 0x00}), stopped);
  EXPECT_EQ(after(0x705, {0x85}), operational) << "with the toggle bit of node guarding";
  EXPECT_EQ(after(0x705, {0x33}), operational) << "no state of CiA 301";
  EXPECT_EQ(after(0x000, {0x82, 0x05}), initialising);
  EXPECT_EQ(after(0x705, {0x7F}), pre_operational);
}

TEST(BusStatisticsView, OtherFrames_AreNone) {
  BusStatisticsView figures;
  figures.frame_completed({.identifier = 0x705, .extended = true, .dlc = 1, .data = {5}}, can::Time{1s});
  figures.frame_completed({.identifier = 0x705, .remote = true, .dlc = 1}, can::Time{1s});
  figures.frame_completed({.identifier = 0x705, .dlc = 2, .data = {5}}, can::Time{1s});
  figures.frame_completed({.identifier = 0x085, .dlc = 8}, can::Time{1s});
  EXPECT_FALSE(figures.node(5).heartbeat);
  EXPECT_EQ(figures.sync().count(), 0U);
}

TEST(WebMessages, AreDecodedForWhoLooks_NewestAlone) {
  const plant::PlantReading reading = plant::read_plant(R"(
[[bus]]
name = "line1"
bit_rate = 250_000
)",
                                                        "plant.toml");
  ASSERT_TRUE(reading.errors.empty());
  Counting observer;
  auto built = plant::Plant::build(reading.plant, observer);
  ASSERT_TRUE(built.has_value());
  plant::Plant& plant = **built;
  WebMessages messages(plant);
  struct Silent final : can::Participant {
    void receive(const can::Frame&, can::Time) override {}
    void tick(can::Time) override {}
  } peer, other;
  can::Port& port = plant.bus(0).add_port("peer");
  plant.timeline_of_bus(0).add(peer);
  port.connect(peer);
  plant.timeline_of_bus(0).add(other);
  plant.bus(0).add_port("other").connect(other);
  plant.power_on();
  const auto send = [&](std::size_t frames) {
    for (std::size_t i = 0; i < frames; ++i) {
      port.send(can::Frame{.identifier = 0x703, .dlc = 1, .data = {0x05}});
      plant.timeline().run_until(plant.timeline().now() + 1ms);
    }
  };
  send(3);
  EXPECT_EQ(messages.new_messages(true), "") << "from now on";
  EXPECT_EQ(messages.new_messages(true), "");
  send(2);
  auto event = nlohmann::json::parse(messages.new_messages(true));
  EXPECT_EQ(event["event"], "messages");
  EXPECT_EQ(event["left_out"], 0);
  ASSERT_THAT(event["messages"], SizeIs(2));
  EXPECT_EQ(event["messages"][0]["channel"], "line1");
  EXPECT_EQ(event["messages"][0]["service"], "error-control");
  EXPECT_EQ(event["messages"][0]["node"], 3);
  send(WebMessages::most_frames + 7);
  event = nlohmann::json::parse(messages.new_messages(true));
  EXPECT_EQ(event["left_out"], 7);
  EXPECT_THAT(event["messages"], SizeIs(WebMessages::most_frames));
  EXPECT_EQ(messages.new_messages(false), "");
  send(2);
  EXPECT_EQ(messages.new_messages(true), "") << "nothing of the time between";
}

}  // namespace
}  // namespace canopus::web::events_test
