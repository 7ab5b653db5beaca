// Faults of a running plant's buses from the page: those of the file, new ones, what they hit, and nonsense.

#include "canopus/web/commands/faults.hpp"

#include <memory>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/can/bus.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/plant/file/fault_text.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::web::faults_test {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;
using Json = nlohmann::json;

const std::string plant_text =
    "[plant]\nseed = 7\n"
    "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n"
    "[[bus.fault]]\nkind = \"drop\"\nidentifier = 0x183  # the encoder's\nreceiver = \"ME3CAN1-Q U0\"\nfrom "
    "= \"1s\"\n"
    "[[device]]\nnode = 3\nname = \"encoder\"\neds = \"" CANOPUS_SOURCE_DIR
    "/examples/devices/encoder.eds\"\nobjects = { \"1800:05\" = 100 }\n"
    "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 1\nmaster = true\nslaves = "
    "\"all\"\nrestart_time = \"100ms\"\n";

class WebFaultsTest : public support::PlantFolder {
 protected:
  void start(const std::string& text = plant_text) {
    plant_ = load(text, no_observer_);
    ASSERT_NE(plant_, nullptr);
    faults_.emplace(*plant_, clock_);
    plant_->power_on();
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  Json bus() { return Json::parse(faults_->list().dump())["buses"][0]; }
  std::string error(const text::Json& wish) {
    const auto row = faults_->run(wish);
    return row ? "it was taken" : row.error();
  }

  class NoObserver final : public plant::PlantObserver {
  } no_observer_;
  class Clock final : public link::LoopClock {
   public:
    can::Time now() override { return {}; }
    void touched() override { ++touches; }
    int touches = 0;
  } clock_;
  std::unique_ptr<plant::Plant> plant_;
  std::optional<WebFaults> faults_;
};

TEST_F(WebFaultsTest, List_HasThoseOfTheFile_AndWhatTheyHit) {
  start();
  EXPECT_EQ(bus()["bus"], "line1");
  EXPECT_EQ(bus()["seed"], 7);
  EXPECT_EQ(bus()["ports"], (Json{"ME3CAN1-Q U0", "encoder"}));
  const Json fault = bus()["faults"][0];
  EXPECT_TRUE(fault["on"]);
  EXPECT_TRUE(fault["from_file"]);
  EXPECT_EQ(fault["hits"], 0);
  const auto read = plant::read_fault(fault["text"].get<std::string>());
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->fault.identifier, 0x183U);
  EXPECT_EQ(read->fault.receiver, "ME3CAN1-Q U0");
  EXPECT_EQ(read->fault.from, can::Time{} + 1s);
  run(4s);
  EXPECT_GT(bus()["faults"][0]["hits"].get<int>(), 5) << "the encoder sends every 100 ms";
}

TEST_F(WebFaultsTest, Run_PutsThemInPlaceOfTheOthers_FromTheBeginning) {
  start();
  run(4s);
  const std::string of_file = bus()["faults"][0]["text"];
  const auto row = faults_->run({{"bus", "line1"},
                                 {"seed", 9U},  // as read from text
                                 {"faults",
                                  {{{"text", of_file}, {"on", false}},
                                   {{"text", "kind = \"corrupt\"\nidentifier = 0x183\ncount = 2"}},
                                   {{"text", "kind = \"jam\"\nports = [\"encoder\"]\nfrom = \"4500ms\""}}}}});
  ASSERT_TRUE(row) << row.error();
  EXPECT_EQ(clock_.touches, 1);
  EXPECT_EQ(bus()["seed"], 9);
  const std::uint64_t errors = plant_->bus(0).load(plant_->timeline().now()).error_frames;
  EXPECT_FALSE(bus()["faults"][2]["active"]);
  run(1s);
  const Json faults = bus()["faults"];
  EXPECT_EQ(faults[0]["on"], false);
  EXPECT_TRUE(faults[0]["from_file"]);
  EXPECT_FALSE(faults[0].contains("hits"));
  EXPECT_EQ(faults[1]["hits"], 2);
  EXPECT_FALSE(faults[1]["from_file"]);
  EXPECT_TRUE(faults[2]["active"]);
  EXPECT_EQ(plant_->bus(0).load(plant_->timeline().now()).error_frames, errors + 2);
  ASSERT_TRUE(faults_->run({{"bus", "line1"}, {"faults", text::Json::array()}}));
  EXPECT_TRUE(bus()["faults"].empty());
  EXPECT_EQ(bus()["seed"], 9);
}

TEST_F(WebFaultsTest, Nonsense_IsRefusedInASentence_AndChangesNothing) {
  start();
  const Json before = bus();
  const auto with = [](const text::Json& fault) { return text::Json{{"bus", "line1"}, {"faults", {fault}}}; };
  EXPECT_EQ(error({{"bus", "line2"}, {"faults", text::Json::array()}}),
            "there is no simulated bus \"line2\": faults are for simulated buses");
  EXPECT_EQ(error({{"bus", 1}, {"faults", text::Json::array()}}),
            "there is no simulated bus \"\": faults are for simulated buses");
  EXPECT_EQ(error({{"bus", "line1"}}), "\"faults\" is to be a list of up to 200 faults");
  EXPECT_EQ(error({{"bus", "line1"}, {"faults", text::Json(std::vector<int>(201))}}),
            "\"faults\" is to be a list of up to 200 faults");
  EXPECT_EQ(error({{"bus", "line1"}, {"faults", text::Json::array()}, {"seed", -1}}),
            "\"seed\" is to be a number from 0 on");
  EXPECT_EQ(error(with("drop")), "fault 1: expected its text, for example kind = \"drop\"");
  EXPECT_EQ(error(with({{"text", std::string(4001, ' ')}})),
            "fault 1: expected its text, for example kind = \"drop\"");
  EXPECT_THAT(error(with({{"text", "kind = "}})), HasSubstr("fault 1: line 1: "));
  EXPECT_THAT(error(with({{"text", "kind = \"x\""}})),
              HasSubstr("fault 1: line 1: kind = \"x\": expected one of drop, corrupt"));
  EXPECT_THAT(error(with({{"text", "kind = \"drop\"\ncuont = 1"}})),
              HasSubstr("fault 1: line 2: fault: unknown key cuont"));
  EXPECT_EQ(error(with({{"text", "kind = \"jam\"\nports = [\"nobody\"]"}})),
            "fault 1 (jam): no port \"nobody\" on bus \"line1\"");
  EXPECT_EQ(bus(), before);
  EXPECT_EQ(clock_.touches, 0);
}

TEST_F(WebFaultsTest, OneIsEnded_AndTheOthersKeepTheirHits) {
  start();
  const text::Json jam{{"text", "kind = \"jam\"\nports = [\"encoder\"]"}};
  const text::Json drop{{"text", "kind = \"drop\"\nidentifier = 0x183\nreceiver = \"ME3CAN1-Q U0\""}};
  const text::Json off{{"text", "kind = \"drop\"\nidentifier = 0x184"}, {"on", false}};
  run(4s);  // jammed at once, the encoder would not be started
  ASSERT_TRUE(faults_->run({{"bus", "line1"}, {"faults", {off, jam, drop}}}));
  run(2s);
  const int hits = bus()["faults"][2]["hits"].get<int>();
  EXPECT_GT(hits, 5);
  ASSERT_TRUE(bus()["faults"][1]["active"]);
  const int touches = clock_.touches;
  const auto row = faults_->end({{"bus", "line1"}, {"number", 1U}});
  ASSERT_TRUE(row) << row.error();
  EXPECT_EQ(clock_.touches, touches + 1);
  ASSERT_EQ(bus()["faults"].size(), 2U);
  EXPECT_EQ(bus()["faults"][1]["hits"], hits);
  run(1s);
  EXPECT_GT(bus()["faults"][1]["hits"].get<int>(), hits) << "it goes on, and is not counted anew";
  ASSERT_TRUE(faults_->end({{"bus", "line1"}, {"number", 1U}}));
  ASSERT_TRUE(faults_->end({{"bus", "line1"}, {"number", 0U}})) << "one that is off";
  EXPECT_TRUE(bus()["faults"].empty());
  const auto none = faults_->end({{"bus", "line1"}, {"number", 0U}});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error(), "there is no fault");
}

TEST_F(WebFaultsTest, EndOfAFaultThatThereIsNot_ChangesNothing) {
  start();
  const Json before = bus();
  for (const text::Json& number : {text::Json(1U), text::Json(-1), text::Json("0"), text::Json()}) {
    const auto row = faults_->end({{"bus", "line1"}, {"number", number}});
    ASSERT_FALSE(row);
    EXPECT_EQ(row.error(), "number: expected that of a fault of the list, 0 to 0");
  }
  EXPECT_FALSE(faults_->end({{"bus", "line2"}, {"number", 0U}}));
  EXPECT_EQ(bus(), before);
}

TEST_F(WebFaultsTest, WhatActedBeforeARefusedRun_GoesOn_AndIsCounted) {
  start();
  run(3s);
  const int hits = bus()["faults"][0]["hits"].get<int>();
  EXPECT_THAT(error({{"bus", "line1"}, {"faults", {text::Json{{"text", "kind = \"x\""}}}}}),
              HasSubstr("fault 1: "));
  run(1s);
  EXPECT_GT(bus()["faults"][0]["hits"].get<int>(), hits);
}

}  // namespace
}  // namespace canopus::web::faults_test
