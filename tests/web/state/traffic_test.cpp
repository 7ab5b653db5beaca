// The page's views of a bus and of a node's objects: frames by class, bits of a frame, values of a dictionary.

#include "canopus/web/state/traffic.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/sim/bus/bus.hpp"
#include "canopus/web/state/events.hpp"
#include "canopus/web/state/objects.hpp"
#include "canopus/web/state/views.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::web::traffic_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::SizeIs;
using namespace std::chrono_literals;
using nlohmann::json;

class WebTrafficTest : public support::PlantFolder {
 protected:
  void SetUp() override {
    PlantFolder::SetUp();
    plant_ = load(
        "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n"
        "[[device]]\nnode = 3\nname = \"<b>encoder</b>\"\neds = \"" CANOPUS_SOURCE_DIR
        "/examples/devices/encoder.eds\"\nobjects = { \"1017:00\" = 500, \"1800:05\" = 100 }\n"
        "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 1\nmaster = true\nslaves = "
        "\"all\"\nexchange = \"20ms\"\nrestart_time = \"100ms\"\n",
        events_.observer());
    ASSERT_NE(plant_, nullptr);
    views_.emplace(*plant_, events_.boots());
    plant_->power_on();
    plant_->timeline().run_until(can::Time{5s});
  }
  json look(const std::string& view) {
    const std::string text = views_->event_of(view);
    return text.empty() ? json() : json::parse(text);
  }

  class NoObserver final : public plant::PlantObserver {
  } no_observer_;
  WebEvents events_{no_observer_};
  std::unique_ptr<plant::Plant> plant_;
  std::optional<WebViews> views_;
};

TEST_F(WebTrafficTest, FramesByClass_AreAllFramesOfTheBus_AndTheirTimeIsItsLoad) {
  const auto busy_of = [](const json& event) {
    double busy = 0;
    for (const json& one : event["classes"]) busy += one["busy"].get<double>();
    return busy;
  };
  const json before = look(R"({"traffic":0})");
  plant_->timeline().run_until(can::Time{15s});
  const json event = look(R"({"traffic":0})");
  EXPECT_EQ(event["event"], "traffic");
  EXPECT_EQ(event["bus"], "line1");
  std::uint64_t frames = 0;
  std::vector<std::string> with_frames;
  for (const json& one : event["classes"]) {
    frames += one["frames"].get<std::uint64_t>();
    if (one["frames"] != 0) with_frames.push_back(one["class"]);
  }
  const can::BusLoad load = plant_->bus(0).load(plant_->timeline().now());
  EXPECT_EQ(frames, load.frames);
  EXPECT_THAT(with_frames, ElementsAre("NMT", "PDO", "SDO", "error control"));
  EXPECT_NEAR((busy_of(event) - busy_of(before)) / 10, load.now, 0.3 * load.now);
  EXPECT_THAT(event["can_ids"].get<std::vector<std::string>>(),
              IsSupersetOf({"000", "183", "603", "583", "703"}));
  EXPECT_FALSE(event.contains("frame"));
}

TEST_F(WebTrafficTest, ErrorFrames_ByKindAndPlace) {
  // After 1 s the module is alone for a moment: nobody acknowledges what it sends.
  const json errors = look(R"({"traffic":0})")["errors"];
  std::uint64_t count = 0;
  for (const json& one : errors) {
    EXPECT_FALSE(one["error"].get<std::string>().empty());
    EXPECT_FALSE(one["field"].get<std::string>().empty());
    count += one["count"].get<std::uint64_t>();
  }
  EXPECT_EQ(count, plant_->bus(0).load(plant_->timeline().now()).error_frames);
}

TEST_F(WebTrafficTest, TheLastFrameOfAnIdentifier) {
  const json frame = look(R"({"traffic":0,"can_id":1795})")["frame"];  // 703H
  EXPECT_EQ(frame["can_id"], "703");
  EXPECT_EQ(frame["data"], "05") << "Operational";
  EXPECT_EQ(frame["dlc"], 1);
  EXPECT_GT(frame["at"], 4.4);
  EXPECT_EQ(frame["bits"][0]["field"], "SOF");
  for (const char* none : {R"({"traffic":0,"can_id":1799})", R"({"traffic":0,"can_id":99999999999})",
                           R"({"traffic":0,"can_id":-1})", R"({"traffic":0,"can_id":"703"})"}) {
    EXPECT_FALSE(look(none).contains("frame")) << none;
  }
}

TEST_F(WebTrafficTest, FramesWith29Bits_HaveTheirOwnPlaces) {
  can::Port& port = plant_->bus(0).add_port("sender");
  const auto send = [&](std::uint32_t id, std::uint8_t value) {
    ASSERT_TRUE(port.send({.identifier = id, .extended = true, .dlc = 1, .data = {value}}));
    plant_->timeline().run_until(plant_->timeline().now() + 20ms);
  };
  send(0x18FF1234, 1);
  send(0x703, 2);
  send(0x18FF1234, 3);
  const json event = look(R"({"traffic":0,"can_id":419369524,"extended":true})");  // 18FF1234H
  EXPECT_THAT(event["can_ids"].get<std::vector<std::string>>(),
              IsSupersetOf({"703", "00000703", "18FF1234"}));
  EXPECT_EQ(event["frame"]["can_id"], "18FF1234");
  EXPECT_EQ(event["frame"]["data"], "03");
  const auto bits_of = [](const json& frame, const char* field) {
    std::size_t count = 0;
    for (const json& bit : frame["bits"]) count += bit["field"] == field && !bit.contains("stuff") ? 1 : 0;
    return count;
  };
  EXPECT_EQ(bits_of(event["frame"], "RTR (extended)"), 1U);
  EXPECT_EQ(bits_of(event["frame"], "ID.17-13") + bits_of(event["frame"], "ID.12-5") +
                bits_of(event["frame"], "ID.4-0"),
            18U);
  EXPECT_EQ(look(R"({"traffic":0,"can_id":1795,"extended":true})")["frame"]["data"], "02");
  EXPECT_EQ(look(R"({"traffic":0,"can_id":1795})")["frame"]["data"], "05") << "the heartbeat";
  EXPECT_FALSE(look(R"({"traffic":0,"can_id":1796,"extended":true})").contains("frame"));
  // The first 64 have places.
  for (std::uint32_t id = 0; id < 70; ++id) send(0x10000 + id, 0);
  const auto ids = look(R"({"traffic":0})")["can_ids"].get<std::vector<std::string>>();
  EXPECT_EQ(std::ranges::count_if(ids, [](const std::string& id) { return id.size() == 8; }), 64);
}

TEST_F(WebTrafficTest, WhatIsNoBusAndNoNode_IsNothing) {
  for (const char* text : {R"({"traffic":1})", R"({"objects":2})", R"({"objects":18446744073709551615})"}) {
    EXPECT_TRUE(look(text).is_null()) << text;
  }
}

// CAN-ID 000H, two bytes: 01H 05H. By hand: after five equal bits comes one of the other level [ISO 11898-1 10.5].
TEST(WebBits, FieldsStuffBitsAndAcknowledge) {
  text::Json event;
  add_bits(event, can::data_frame(0, {0x01, 0x05}));
  std::string levels;
  std::string stuffed;
  std::vector<std::string> fields;
  for (const auto& bit : event["bits"]) {
    levels += bit["level"].get<std::string>();
    stuffed += bit.contains("stuff") ? 's' : '.';
    if (fields.empty() || fields.back() != bit["field"]) fields.push_back(bit["field"].get<std::string>());
  }
  // SOF, eleven bits of the identifier, RTR, IDE and r0 dominant, DLC 0010: 17 dominant bits before its 1.
  EXPECT_EQ(levels.substr(0, 22), "dddddrdddddrdddddrddrd");
  EXPECT_EQ(stuffed.substr(0, 22), ".....s.....s.....s....");
  EXPECT_EQ(levels.substr(levels.size() - 10), "rdrrrrrrrr") << "CRC delimiter, ACK slot, ACK delimiter, EOF";
  EXPECT_THAT(fields, ElementsAre("SOF", "ID.28-21", "ID.20-18", "RTR", "IDE", "r0", "DLC", "data", "CRC",
                                  "CRC delimiter", "ACK slot", "ACK delimiter", "EOF"));
}

TEST(WebBits, AnExtendedFrame_HasItsOwnFields) {
  text::Json event;
  add_bits(event, {.identifier = 0x1234'5678, .extended = true, .remote = true, .dlc = 8});
  std::vector<std::string> fields;
  for (const auto& bit : event["bits"]) {
    if (fields.empty() || fields.back() != bit["field"]) fields.push_back(bit["field"].get<std::string>());
  }
  EXPECT_THAT(fields, ::testing::Contains("ID.17-13"));
  EXPECT_THAT(fields, ::testing::Not(::testing::Contains("data"))) << "a remote frame has none";
}

TEST(FrameClasses, AsCia301Assigns) {
  for (const auto& [id, wanted] :
       std::vector<std::pair<std::uint32_t, FrameClass>>{{0x000, FrameClass::nmt},
                                                         {0x001, FrameClass::other},
                                                         {0x080, FrameClass::sync},
                                                         {0x081, FrameClass::emcy},
                                                         {0x0FF, FrameClass::emcy},
                                                         {0x100, FrameClass::time},
                                                         {0x180, FrameClass::other},
                                                         {0x181, FrameClass::pdo},
                                                         {0x57F, FrameClass::pdo},
                                                         {0x581, FrameClass::sdo},
                                                         {0x67F, FrameClass::sdo},
                                                         {0x700, FrameClass::other},
                                                         {0x701, FrameClass::error_control},
                                                         {0x77F, FrameClass::error_control},
                                                         {0x7E5, FrameClass::lss},
                                                         {0x7FF, FrameClass::other}}) {
    EXPECT_EQ(class_of(can::data_frame(id)), wanted) << std::hex << id;
  }
  EXPECT_EQ(class_of({.identifier = 0x181, .extended = true}), FrameClass::other);
}

TEST_F(WebTrafficTest, ObjectsOfANode_LikeItsDictionary) {
  const json event = look(R"({"objects":1,"find":"1017","count":2})");
  EXPECT_EQ(event["event"], "objects");
  EXPECT_EQ(event["number"], 1);
  EXPECT_EQ(event["node"], 3);
  EXPECT_EQ(event["name"], "<b>encoder</b>");
  EXPECT_EQ(event["of"], 1);
  const json& row = event["rows"][0];
  EXPECT_EQ(row["object"], "1017:00");
  EXPECT_EQ(row["type"], "UNSIGNED16");
  EXPECT_EQ(row["access"], "rw");
  EXPECT_EQ(row["decimal"], "500");
  EXPECT_EQ(row["hex"], "01F4");
  EXPECT_EQ(look(R"({"objects":0,"find":"DEVICE TYPE","count":2})")["rows"][0]["object"], "1000:00")
      << "the module";
  EXPECT_THAT(look(R"({"objects":0,"count":9999})")["rows"], SizeIs(most_objects));
}

TEST(WebObjects, ValuesOfAllKinds_AsManyAsAreInSight) {
  using canopen::DataType;
  canopen::DictionaryBuilder builder;
  builder.variable(0x2000, {.name = "small", .type = DataType::integer16, .value = {0xFE, 0xFF}});
  builder.variable(0x2001,
                   {.name = "name", .type = DataType::visible_string, .value = canopen::text("\"1\"")});
  builder.variable(0x2002, {.name = "bytes", .type = DataType::octet_string, .value = {0x00, 0xFF}});
  builder.variable(0x2003,
                   {.name = "large", .type = DataType::unsigned64, .value = {1, 0, 0, 0, 0, 0, 0, 0x80}});
  builder.variable(0x2004, {.name = "real", .type = DataType::real32, .value = {0, 0, 0xC0, 0x3F}});
  builder.uniform(0x2005, canopen::ObjectCode::array, "array", 254,
                  {.name = "Alike", .type = DataType::unsigned8});
  canopen::ObjectDictionary objects(builder.build(), 7);
  ASSERT_TRUE(objects.set<std::int16_t>(0x2000, 0, -3));
  text::Json event;
  add_objects(event, objects, 7, "", 0, 6);
  EXPECT_EQ(event["of"], 5 + 255);
  const auto rows = event["rows"];
  ASSERT_THAT(rows, SizeIs(6));
  EXPECT_EQ(rows[0]["decimal"], "-3");
  EXPECT_EQ(rows[0]["default_decimal"], "-2");
  EXPECT_EQ(rows[0]["hex"], "FFFD");
  EXPECT_EQ(rows[1]["text"], "\"1\"");
  EXPECT_EQ(rows[2]["hex"], "00FF");
  EXPECT_EQ(rows[2]["bytes"], 2);
  EXPECT_FALSE(rows[2].contains("text"));
  EXPECT_EQ(rows[3]["decimal"], "9223372036854775809");
  EXPECT_EQ(rows[4]["decimal"], "1.5");
  EXPECT_EQ(rows[5]["object"], "2005:00");
  add_objects(event, objects, 7, "alike", 253, 6);
  EXPECT_EQ(event["of"], 254);
  ASSERT_THAT(event["rows"], SizeIs(1));
  EXPECT_EQ(event["rows"][0]["object"], "2005:FE");
}

TEST_F(WebTrafficTest, WhoLostTheArbitration_AndAtWhichBit) {
  can::Bus& bus = plant_->bus(0);
  can::Port& low = bus.add_port("low");
  can::Port& high = bus.add_port("high");
  can::Port& wide = bus.add_port("wide");
  const auto send = [&] {
    ASSERT_TRUE(high.send({.identifier = 2, .dlc = 0}));
    ASSERT_TRUE(low.send({.identifier = 1, .dlc = 0}));
    ASSERT_TRUE(wide.send({.identifier = 1U << 18, .extended = true, .dlc = 0}));
    plant_->timeline().run_until(plant_->timeline().now() + 5ms);
  };
  send();
  EXPECT_FALSE(look(R"({"traffic":0,"can_id":1})")["frame"].contains("lost")) << "nobody looked then";
  send();
  const json lost = look(R"({"traffic":0,"can_id":1})")["frame"]["lost"];
  // SOF and ten dominant bits have two stuff bits between them; 2 differs in the eleventh bit, the other one in SRR.
  ASSERT_THAT(lost, SizeIs(2)) << lost;
  EXPECT_EQ(lost[0], (json{{"name", "high"}, {"can_id", "002"}, {"bit", 12}}));
  EXPECT_EQ(lost[1], (json{{"name", "wide"}, {"can_id", "00040000"}, {"bit", 14}}));
  (void)look(R"({"traffic":0,"can_id":262144,"extended":true})");
  (void)look(R"({"traffic":0,"can_id":2})");
  send();
  const json second = look(R"({"traffic":0,"can_id":262144,"extended":true})")["frame"]["lost"];
  EXPECT_EQ(second, (json::array({{{"name", "high"}, {"can_id", "002"}, {"bit", 12}}})));
  EXPECT_THAT(look(R"({"traffic":0,"can_id":2})")["frame"]["lost"], IsEmpty());
  // As long as nobody looks nothing is kept.
  (void)views_->event_of("");
  send();
  EXPECT_FALSE(look(R"({"traffic":0,"can_id":1})")["frame"].contains("lost"));
}

TEST_F(WebTrafficTest, LatestErrorFrames_WithTheBitsOfTheNewest) {
  const std::size_t before = look(R"({"traffic":0})")["error_frames"].size();
  sim::Fault fault;
  fault.kind = sim::FaultKind::corrupt;
  fault.identifier = 0x183;
  fault.bit = 30;
  fault.count = 1;
  ASSERT_TRUE(plant_->simulated_bus(0)->set_faults({fault}, 1));
  plant_->timeline().run_until(plant_->timeline().now() + 300ms);
  const json event = look(R"({"traffic":0})");
  ASSERT_GE(event["error_frames"].size(), std::min<std::size_t>(before + 1, WebTraffic::most_error_frames));
  const json newest = event["error_frames"][0];
  EXPECT_GT(newest["at"], 5.0);
  EXPECT_EQ(newest["error"], "bit") << newest;
  EXPECT_EQ(newest["bit"], 30);
  EXPECT_EQ(newest["name"], "<b>encoder</b>");
  EXPECT_TRUE(newest["transmitter"]);
  std::map<std::string, std::size_t> parts;
  std::string levels;
  for (const json& bit : newest["bits"]) {
    ++parts[bit["part"]];
    levels += bit["level"];
  }
  EXPECT_EQ(parts["frame"], 31U) << "SOF is 0";
  EXPECT_GE(parts["error flag"], 6U);
  EXPECT_LE(parts["error flag"], 12U);
  EXPECT_EQ(parts["error delimiter"], 8U);
  EXPECT_TRUE(levels.starts_with("dd")) << levels;  // SOF, and the first bit of 183H
  EXPECT_TRUE(levels.ends_with("ddddddrrrrrrrr")) << levels;
  // What it says is the frame that came whole afterwards, but for the wrong bit.
  const json whole = look(R"({"traffic":0,"can_id":387})")["frame"]["bits"];
  for (std::size_t i = 0; i < 30 && i < 12; ++i)
    EXPECT_EQ(newest["bits"][i]["level"], whole[i]["level"]) << i;
}

TEST_F(WebTrafficTest, FramesThatWait) {
  can::Port& port = plant_->bus(0).add_port("sender");
  EXPECT_EQ(port.waiting(), 0U);
  for (std::uint32_t id = 1; id <= 5; ++id) ASSERT_TRUE(port.send({.identifier = id, .dlc = 8}));
  EXPECT_EQ(port.waiting(), 5U);
  plant_->timeline().run_until(plant_->timeline().now() + 250us);
  EXPECT_EQ(port.waiting(), 5U) << "the one that is being sent waits, too";
  plant_->timeline().run_until(plant_->timeline().now() + 10ms);
  EXPECT_EQ(port.waiting(), 0U);
  EXPECT_EQ(json::parse(state_event(*plant_))["nodes"][0]["waiting"], 0);
}

}  // namespace
}  // namespace canopus::web::traffic_test
