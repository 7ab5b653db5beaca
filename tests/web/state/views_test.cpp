// What the page looks at beside the state: words of a module's buffer memory with the PDOs behind them, and boots step by step.

#include "canopus/web/state/views.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/plant/event.hpp"
#include "canopus/web/state/events.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::web::views_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using namespace std::chrono_literals;
using Json = nlohmann::json;

const std::string plant_text =
    "[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n"
    "[[device]]\nnode = 3\nname = \"encoder\"\neds = \"" CANOPUS_SOURCE_DIR
    "/examples/devices/encoder.eds\"\nobjects = { \"1800:05\" = 100 }\n"
    "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 1\nmaster = true\nslaves = "
    "\"all\"\nexchange = \"20ms\"\n"
    "restart_time = \"100ms\"\n";

class WebViewsTest : public support::PlantFolder {
 protected:
  void start(const std::string& text, can::Duration time = 5s) {
    plant_ = load(text, events_.observer());
    ASSERT_NE(plant_, nullptr);
    views_.emplace(*plant_, events_.boots());
    plant_->power_on();
    run(time);
  }
  void run(can::Duration time) { plant_->timeline().run_until(plant_->timeline().now() + time); }
  Json look(const std::string& view) {
    const std::string text = views_->event_of(view);
    return text.empty() ? Json() : Json::parse(text);
  }
  static Json row_of(const Json& event, unsigned address) {
    for (const Json& row : event["rows"]) {
      if (row["address"] == address) return row;
    }
    return {};
  }

  class NoObserver final : public plant::PlantObserver {
  } no_observer_;
  WebEvents events_{no_observer_};
  std::unique_ptr<plant::Plant> plant_;
  std::optional<WebViews> views_;
};

TEST_F(WebViewsTest, Words_HaveNamesValuesAndTheirPdo) {
  start(plant_text);
  (void)look(R"({"words":0,"find":"g10000","count":10})");
  run(300ms);
  const Json event = look(R"({"words":0,"find":"g10000","count":10})");
  EXPECT_EQ(event["event"], "words");
  EXPECT_EQ(event["module"], "ME3CAN1-Q U0");
  EXPECT_EQ(event["of"], 1);
  const Json row = row_of(event, 10000);
  EXPECT_EQ(row["access"], "read");
  EXPECT_EQ(row["pdo"], "RPDO1");
  EXPECT_EQ(row["can_id"], "183");
  EXPECT_EQ(row["from"], "node 3 (encoder) TPDO1");
  EXPECT_GE(row["age"], 0.0);
  EXPECT_LT(row["age"], 0.101);
  EXPECT_NE(row["name"], "");
  EXPECT_NE(row["section"], "");
}

TEST_F(WebViewsTest, Words_SayWhatTheyTake) {
  start(plant_text, 1s);
  // The bit rate: one of some [ME3CAN1-Q 4.6.4]; the node address: from, to; the receive data of a PDO: no range.
  const Json rate = row_of(look(R"({"words":0,"find":"g24","count":200})"), 24);
  EXPECT_THAT(rate["values"], Contains(250)) << rate;
  const Json node = row_of(look(R"({"words":0,"find":"g27","count":200})"), 27);
  EXPECT_EQ(node["low"], 1) << node;
  EXPECT_EQ(node["high"], 127) << node;
  const Json data = row_of(look(R"({"words":0,"find":"g10000","count":200})"), 10000);
  EXPECT_FALSE(data.contains("low") || data.contains("high") || data.contains("values")) << data;
}

TEST_F(WebViewsTest, Objects_SayTheirLimits) {
  start(plant_text, 1s);
  const Json event = look(R"({"objects":1,"find":"6003","count":20})");
  ASSERT_THAT(event["rows"], SizeIs(1)) << event;
  EXPECT_TRUE(event["rows"][0].contains("low") || event["rows"][0].contains("high")) << event;
}

TEST_F(WebViewsTest, Meaning_OfAnObject) {
  start(plant_text, 1s);
  const Json heartbeat = look(R"({"meaning":"1017:00"})");
  EXPECT_EQ(heartbeat["event"], "meaning");
  EXPECT_EQ(heartbeat["object"], "1017:00");
  EXPECT_THAT(heartbeat["meaning"], HasSubstr("sends its heartbeat"));
  EXPECT_EQ(heartbeat["unit"], "ms");
  EXPECT_EQ(heartbeat["source"], "CiA 301 7.5.2.20");
  const Json own = look(R"({"meaning":"2000:01"})");
  EXPECT_EQ(own["meaning"], "");
  EXPECT_EQ(own["source"], "");
  for (const char* wrong :
       {"", "1017", "1017:0", "1017:000", "10170:0", "g017:00", "-017:00", "1017:-1", " 017:00"})
    EXPECT_TRUE(look(Json{{"meaning", wrong}}.dump()).is_null()) << wrong;
  EXPECT_TRUE(look(R"({"meaning":4119})").is_null());
}

TEST_F(WebViewsTest, Words_AreFoundByName_AndComeInParts) {
  start(plant_text);
  const Json all = look(R"({"words":0})");
  EXPECT_GT(all["of"], 2000) << "every word that has a name";
  EXPECT_THAT(all["rows"], SizeIs(0)) << "none was asked for";
  const Json first = look(R"({"words":0,"from":0,"count":5})");
  const Json second = look(R"({"words":0,"from":3,"count":5})");
  ASSERT_THAT(first["rows"], SizeIs(5));
  EXPECT_EQ(first["rows"][3], second["rows"][0]);
  EXPECT_THAT(look(R"({"words":0,"from":0,"count":100000})")["rows"], SizeIs(WebViews::most_words));
  EXPECT_THAT(look(R"({"words":0,"from":18446744073709551615,"count":5})")["rows"], SizeIs(0));
  const Json found = look(R"({"words":0,"find":"NMT","count":20})");
  EXPECT_GT(found["of"], 0);
  for (const Json& row : found["rows"]) {
    EXPECT_THAT(std::string(row["name"]), testing::ContainsRegex("[nN][mM][tT]"));
  }
}

TEST_F(WebViewsTest, ValuesAreTheModulesOwn_AndMove) {
  start(plant_text + "\n[[device]]\nnode = 4\neds = \"" CANOPUS_SOURCE_DIR
                     "/examples/devices/encoder.eds\"\n"
                     "[[device.behaviour]]\nobject = \"6004:00\"\nkind = \"counter\"\nlow = 1\nhigh = "
                     "60000\nperiod = \"10ms\"\n");
  std::vector<int> values;
  for (int i = 0; i < 3; ++i) {
    run(500ms);
    const Json event = look(R"({"words":0,"find":"g100","count":256})");
    for (const Json& row : event["rows"]) {
      const auto address = row["address"].get<module::BufferAddress>();
      EXPECT_EQ(row["value"], plant_->module(0).buffer_memory()->peek(address, plant_->timeline().now()));
      if (row.value("from", "").starts_with("node 4")) values.push_back(row["value"]);
    }
  }
  std::ranges::sort(values);
  values.erase(std::ranges::unique(values).begin(), values.end());
  EXPECT_GE(values.size(), 3U) << "the counter arrives";
}

TEST_F(WebViewsTest, WhatNobodyLooksAt_IsNotWatched) {
  start(plant_text);
  const Json before = row_of(look(R"({"words":0,"find":"g10000","count":10})"), 10000);
  EXPECT_FALSE(before.contains("age")) << "looked at from now on";
  EXPECT_EQ(views_->event_of(""), "");
  run(1s);
  const Json after = row_of(look(R"({"words":0,"find":"g10000","count":10})"), 10000);
  EXPECT_FALSE(after.contains("age"));
}

TEST_F(WebViewsTest, WhatIsNoView_IsNothing) {
  start(plant_text, 100ms);
  for (const char* text :
       {"{}", "[]", "1", "{", R"({"words":1})", R"({"words":-1,"count":5})", R"({"other":true})"}) {
    const std::string said = views_->event_of(text);
    if (std::string_view(text).find("-1") != std::string_view::npos) {
      EXPECT_EQ(Json::parse(said)["number"], 0) << "no number: the first";
    } else {
      EXPECT_EQ(said, "") << text;
    }
  }
}

TEST_F(WebViewsTest, WhatIsNestedDeeply_IsNoView) {
  start(plant_text, 100ms);
  for (const std::size_t depth : {64U, 200'000U}) {
    const std::string nested = std::string(depth, '[') + std::string(depth, ']');
    EXPECT_EQ(views_->event_of(R"({"words":0,"x":)" + nested + "}"), "") << depth;
  }
}

TEST_F(WebViewsTest, Boots_AreStepsWithTheirTimes) {
  start(plant_text);
  const Json event = look(R"({"boots":true})");
  EXPECT_EQ(event["event"], "boots");
  ASSERT_THAT(event["slaves"], SizeIs(1));
  const Json& slave = event["slaves"][0];
  EXPECT_EQ(slave["bus"], "line1");
  EXPECT_EQ(slave["node"], 3);
  EXPECT_EQ(slave["name"], "encoder");
  EXPECT_EQ(slave["master"], 1);
  ASSERT_THAT(event["masters"], SizeIs(1));
  EXPECT_EQ(event["masters"][0]["bus"], "line1");
  EXPECT_EQ(event["masters"][0]["node"], 1);
  EXPECT_EQ(event["masters"][0]["start_up"], "ended");
  ASSERT_GE(slave["steps"].size(), 3U);
  EXPECT_EQ(slave["steps"].back()["step"], "booted");
  double last = 0;
  for (const Json& step : slave["steps"]) {
    EXPECT_GE(step["t"], last);
    last = step["t"];
  }
}

TEST_F(WebViewsTest, ABootThatFails_SaysWhy) {
  std::string text = plant_text;
  text.replace(text.find("slaves = \"all\""), 14,
               "objects = { \"1F80\" = 1, \"1F81:03\" = 0x0D, \"1F85:03\" = 0x195 }");
  start(text);
  const Json event = look(R"({"boots":true})");
  ASSERT_THAT(event["slaves"], SizeIs(1));
  const Json last = event["slaves"][0]["steps"].back();
  EXPECT_THAT(std::string(last["step"]), HasSubstr("failed"));
  EXPECT_EQ(last["error"], "D");
  EXPECT_EQ(last["expected"], 0x195);
  EXPECT_EQ(last["received"], 0);
  EXPECT_THAT(std::string(last["reason"]), HasSubstr("vendor"));
  ASSERT_THAT(event["masters"], SizeIs(1));
  EXPECT_EQ(event["masters"][0]["start_up"], "halted");  // 1F81H bit 3: the slave is mandatory
}

TEST_F(WebViewsTest, StartUpOfEachMaster_IsInWords) {
  const auto masters_of = [this](const std::string& settings) {
    std::string text = plant_text;
    const std::size_t at = text.find("master = true");
    text.replace(at, text.find("exchange", at) - at, settings);
    views_.reset();  // it looks at the plant of the line before
    start(text);
    return look(R"({"boots":true})")["masters"];
  };
  const auto start_up_of = [&](const std::string& objects) {
    const Json masters = masters_of("master = true\nobjects = { " + objects + " }\n");
    return masters.size() == 1 ? masters[0].value("start_up", "") : "no master";
  };
  EXPECT_EQ(start_up_of(R"("1F80" = 1, "1F81:03" = 5)"), "ended");
  EXPECT_EQ(start_up_of(R"("1F80" = 1, "1F81:07" = 0x0D)"), "booting") << "mandatory, and not there";
  EXPECT_EQ(start_up_of(R"("1F80" = 5, "1F81:03" = 5)"), "waits for own start") << "1F80H bit 2";
  EXPECT_THAT(masters_of("master = false\n"), SizeIs(0)) << "a module that is no master";
}

TEST_F(WebViewsTest, OfManySteps_TheNewestAreKept) {
  WebBoots boots;
  manager::BootRecord record;
  const plant::NodeLabel slave{"line1", "encoder", 3};
  const plant::NodeLabel master{"line1", "module", 1};
  for (unsigned i = 0; i < 200; ++i) {
    record.step = i % 2 == 0 ? manager::BootStep::presence : manager::BootStep::presence_pause;
    record.attempts = i;
    boots.on({can::Time(std::chrono::seconds(i)), plant::SlaveBootStep{slave, master, record}});
    boots.on(
        {can::Time(std::chrono::seconds(i)), plant::SlaveBootStep{slave, master, record}});  // the same step
  }
  const auto& steps = boots.slaves().begin()->second.steps;
  EXPECT_THAT(steps, SizeIs(WebBoots::most_steps));
  EXPECT_EQ(steps.back().at, can::Time(199s));
  EXPECT_EQ(steps.back().record.attempts, 199U);
}

TEST_F(WebViewsTest, Values_AreNumbersOfWordsAndObjects) {
  start(plant_text);
  const Json event = look(
      R"({"values":["words 0 10000","objects 1 6004:00","objects 1 1008:00","objects 9 6004:00","words 9 1","words 0 70000","objects 1 6004","x",7]})");
  EXPECT_EQ(event["event"], "values");
  const Json& values = event["values"];
  ASSERT_EQ(values.size(), 9U);
  EXPECT_EQ(values[0]["key"], "words 0 10000");
  const Json words = look(R"({"words":0,"find":"g10000","count":10})");
  EXPECT_EQ(values[0]["value"], row_of(words, 10000)["value"]);
  const Json objects = look(R"({"objects":1,"find":"6004","count":10})");
  EXPECT_EQ(std::to_string(values[1]["value"].get<std::uint64_t>()), objects["rows"][0]["decimal"]);
  for (std::size_t i = 2; i < values.size(); ++i) EXPECT_TRUE(values[i]["value"].is_null()) << values[i];
  EXPECT_EQ(values[8]["key"], "");
  EXPECT_TRUE(look(R"({"values":7})").is_null());
  EXPECT_TRUE(look(R"({"values":["","","","","","","","","","","","",""]})").is_null()) << "13";
}

TEST_F(WebViewsTest, Words_AreFoundByPdo_CanId_AndSender) {
  start(plant_text);
  for (const char* find : {"RPDO1", "183", "encoder"}) {
    const Json event = look(Json{{"words", 0}, {"find", find}, {"count", 256}}.dump());
    const Json row = row_of(event, 10000);
    EXPECT_EQ(row["pdo"], "RPDO1") << find << event;
  }
  const Json of_encoder = look(R"({"words":0,"find":"encoder","count":256})");
  for (const Json& row : of_encoder["rows"]) EXPECT_EQ(row["from"], "node 3 (encoder) TPDO1");
  EXPECT_EQ(look(R"({"words":0,"find":"no such sender","count":256})")["of"], 0);
}

TEST_F(WebViewsTest, Program_ShowsStateLinesAndValues) {
  write("main.st", "PROGRAM Main\nVAR n : INT; t : TON; END_VAR\nn := n + 1; // count\nEND_PROGRAM\n");
  start(
      "[[bus]]\nname = \"line1\"\nbit_rate = 250000\n[[plc]]\nname = \"plc1\"\nprogram = [\"main.st\"]\nscan "
      "= \"10ms\"\n",
      25ms);
  const Json event = look(R"({"program":"plc1","file":0,"from":3,"count":1})");
  EXPECT_EQ(event["event"], "program");
  EXPECT_EQ(event["state"], "run");
  EXPECT_EQ(event["scan"]["count"], 2);
  EXPECT_EQ(event["files"], Json({"main.st"}));
  EXPECT_EQ(event["of"], 5);
  ASSERT_EQ(event["lines"].size(), 1U);
  EXPECT_EQ(event["lines"][0]["text"], "n := n + 1; // count");
  EXPECT_EQ(event["lines"][0]["code"], true);
  EXPECT_EQ(event["lines"][0]["values"][1], Json({{"column", 6},
                                                  {"length", 1},
                                                  {"name", "Main.n"},
                                                  {"type", "INT"},
                                                  {"value", "3"},
                                                  {"forced", false},
                                                  {"writable", true}}));
  const Json variables = look(R"({"variables":"plc1","find":"time","from":1,"count":5})");
  EXPECT_EQ(variables["of"], 2);
  ASSERT_EQ(variables["rows"].size(), 1U);
  EXPECT_EQ(variables["rows"][0]["name"], "Main.t.ET");
  EXPECT_EQ(variables["rows"][0]["value"], "T#0s");
  EXPECT_TRUE(look(R"({"program":"other"})").is_null());
  EXPECT_TRUE(look(R"({"variables":7})").is_null());
  EXPECT_TRUE(look(R"({"program":"plc1","file":9,"from":0,"count":9999999})")["lines"].empty());
  const Json state = Json::parse(state_event(*plant_, nullptr, nullptr, 1));
  EXPECT_EQ(state["programs"], Json::array({{{"plc", "plc1"}, {"state", "run"}}}));
}

}  // namespace
}  // namespace canopus::web::views_test
