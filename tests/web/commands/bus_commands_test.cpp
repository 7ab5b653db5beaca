// Commands of the page on nodes of a simulated bus: frames on the bus, answers, and what ends them.

#include "canopus/web/commands/bus_commands.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canopus/can/bus.hpp"
#include "canopus/plant/device_on_bus.hpp"
#include "canopus/web/commands/commands.hpp"

#include "paths.hpp"
#include "support/plant_folder.hpp"

namespace canopus::web::bus_commands_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;
using namespace std::chrono_literals;
using Json = nlohmann::json;

const std::string devices = "[[device]]\nnode = 3\nname = \"encoder\"\neds = \"" CANOPUS_SOURCE_DIR
                            "/examples/devices/encoder.eds\"\n"
                            "[[device]]\nnode = 5\nname = \"io-block\"\neds = \"" CANOPUS_SOURCE_DIR
                            "/examples/devices/io-block.eds\"\n";
const std::string master =
    "[[plc]]\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nhead = 0\nnode = 1\nmaster = true\nslaves = \"all\"\n"
    "restart_time = \"100ms\"\n";

/// "603 40 08 10 00 00 00 00 00"
std::string text_of(const can::Frame& frame) {
  std::string text = fmt::format("{:03X}", frame.identifier);
  for (unsigned i = 0; i < frame.length(); ++i) text += fmt::format(" {:02X}", frame.data[i]);
  return text;
}

class BusCommandsTest : public support::PlantFolder, private can::BusObserver {
 protected:
  void start(const std::string& nodes = devices) {
    plant_ = load("[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n" + nodes, no_observer_);
    ASSERT_NE(plant_, nullptr);
    clock_.plant = plant_.get();
    bus_commands_.emplace(io_, *plant_, clock_, standstill_);
    make_commands();
    plant_->power_on();
    run(3s);
    plant_->bus(0).add_observer(*this);
  }
  void make_commands() {
    commands_.emplace(
        io_, WebCommands::Use{.buses = {{.name = "line1", .address = "socketcand:127.0.0.1:29536"},
                                        {.name = "elsewhere", .address = "socketcan:can0", .is_live = true}},
                              .on_bus =
                                  [this](const WebCommandLine& line, RunningCommand::Use use) {
                                    auto running = bus_commands_->start(line, std::move(use));
                                    if (running != nullptr) running_ = running;
                                    return running;
                                  },
                              .program = "/no/such/program",
                              .now = [this] { return now(); },
                              .done =
                                  [this](const WebUser& user, const std::string& line, int code,
                                         const std::string& message, WebRole) {
                                    audit_.push_back(user.name + ": " + line + ": " + std::to_string(code) +
                                                     (message.empty() ? "" : ": " + message));
                                  }});
  }
  void TearDown() override {
    commands_.reset();
    bus_commands_.reset();
    if (plant_) plant_->bus(0).remove_observer(*this);
  }

  [[nodiscard]] can::Time now() const { return plant_->timeline().now(); }
  /// Plant time goes on, the loop is run in between; none of it waits for the machine's clock.
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
  void say(const Json& wish, std::uint32_t id = 1, WebRole role = WebRole::configure,
           const std::string& name = "ann") {
    commands_->run({.name = name, .role = role}, wish.dump(), id,
                   [this](const std::string& event) { replies_.push_back(Json::parse(event)); });
  }
  /// The rows of a command, and the fields of its last reply.
  struct Answer {
    Json rows = Json::array();
    int code = -1;
    std::string message{};
  };
  [[nodiscard]] Answer answer(std::uint32_t id = 1) const {
    Answer answer;
    for (const Json& reply : replies_) {
      if (reply["id"] != id) continue;
      if (reply.contains("rows"))
        for (const Json& row : reply["rows"]) answer.rows.push_back(row);
      if (reply.contains("code")) answer.code = reply["code"];
      if (reply.contains("message")) answer.message = reply["message"];
    }
    return answer;
  }
  Answer asked(const Json& wish, can::Duration time = 100ms) {
    replies_.clear();
    say(wish);
    run(time);
    return answer();
  }

  void frame_completed(const can::Frame& frame, can::Time, can::Time) override {
    frames_.push_back(text_of(frame));
  }

  class : public plant::PlantObserver {
  } no_observer_;
  class Clock final : public link::LoopClock {
   public:
    can::Time now() override { return plant->timeline().now(); }
    void touched() override {}
    plant::Plant* plant = nullptr;
  } clock_;
  std::chrono::milliseconds standstill_ = 1h;
  boost::asio::io_context io_{1};
  std::unique_ptr<plant::Plant> plant_;
  std::optional<BusCommands> bus_commands_;
  std::optional<WebCommands> commands_;
  std::weak_ptr<RunningCommand> running_;
  std::vector<Json> replies_;
  std::vector<std::string> audit_;
  std::vector<std::string> frames_;
};

TEST_F(BusCommandsTest, Read_IsAnSdoUploadOnTheBus_AndItsRowThatOfTheCommandLine) {
  start();
  const Answer answer = asked({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}, {"type", "u32"}});
  EXPECT_EQ(answer.rows,
            Json::parse(R"([{"node":3,"object":"1000:00","bytes":"96010100","type":"u32","value":65942}])"));
  EXPECT_EQ(answer.code, 0);
  EXPECT_EQ(answer.message, "");
  EXPECT_THAT(frames_, ElementsAre("603 40 00 10 00 00 00 00 00", "583 43 00 10 00 96 01 01 00"));
  EXPECT_THAT(
      audit_,
      ElementsAre("ann: canopus sdo read --json --bus=socketcand:127.0.0.1:29536 --type=u32 -- 3 1000: 0"));
}

TEST_F(BusCommandsTest, Read_OfALongValue_GoesInSegments) {
  start();
  const Answer answer = asked({{"command", "sdo read"}, {"node", "3"}, {"object", "1008"}});
  EXPECT_EQ(answer.rows,
            Json::parse(R"([{"node":3,"object":"1008:00","bytes":"43616E6F70757320656E636F646572"}])"));
  EXPECT_THAT(frames_, ElementsAre("603 40 08 10 00 00 00 00 00", "583 41 08 10 00 0F 00 00 00",
                                   "603 60 00 00 00 00 00 00 00", "583 00 43 61 6E 6F 70 75 73",
                                   "603 70 00 00 00 00 00 00 00", "583 10 20 65 6E 63 6F 64 65",
                                   "603 60 00 00 00 00 00 00 00", "583 0D 72 00 00 00 00 00 00"));
}

TEST_F(BusCommandsTest, Write_IsAnSdoDownload_AndItsRowTheValue) {
  start();
  const Answer answer =
      asked({{"command", "sdo write"}, {"node", "3"}, {"object", "1017"}, {"value", "500"}, {"type", "u16"}});
  EXPECT_EQ(answer.rows,
            Json::parse(R"([{"node":3,"object":"1017:00","bytes":"F401","type":"u16","value":500}])"));
  EXPECT_EQ(answer.code, 0);
  EXPECT_THAT(frames_, IsSupersetOf({"603 2B 17 10 00 F4 01 00 00", "583 60 17 10 00 00 00 00 00"}));
}

TEST_F(BusCommandsTest, Abort_IsARowWithItsCodeAndReason) {
  start();
  const Answer answer = asked({{"command", "sdo read"}, {"node", "3"}, {"object", "2FFF:01"}});
  EXPECT_EQ(answer.rows, Json::parse(R"([{"node":3,"object":"2FFF:01","abort":"06020000",
                                          "reason":"abort 06020000H: object does not exist"}])"));
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.message, "");
}

TEST_F(BusCommandsTest, ANodeThatIsNotThere_DoesNotAnswerWithin500Ms) {
  start();
  say({{"command", "sdo read"}, {"node", "99"}, {"object", "1000"}});
  run(490ms);
  EXPECT_THAT(replies_, IsEmpty());
  run(30ms);
  EXPECT_EQ(
      answer().rows,
      Json::parse(
          R"([{"node":99,"object":"1000:00","abort":"05040000","reason":"no answer within 500.0 ms"}])"));
  EXPECT_EQ(answer().code, 1);
  EXPECT_THAT(frames_, ElementsAre("663 40 00 10 00 00 00 00 00", "663 80 00 10 00 00 00 04 05"));
}

TEST_F(BusCommandsTest, ABusWithoutANode_IsSaidToAcknowledgeNothing) {
  start("");
  const Answer answer = asked({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}}, 2s);
  EXPECT_EQ(
      answer.rows,
      Json::parse(
          R"([{"node":3,"object":"1000:00","abort":"05040000","reason":"no answer within 500.0 ms"}])"));
  EXPECT_EQ(answer.code, 1);
  EXPECT_EQ(answer.message, "canopus: the bus: no acknowledgement: no other node on this bus");
}

TEST_F(BusCommandsTest, WrongWords_AreThoseOfTheCommandLine) {
  start();
  const auto wrong = [&](const Json& wish) {
    const Answer answer = asked(wish);
    EXPECT_EQ(answer.code, 2);
    EXPECT_THAT(answer.rows, IsEmpty());
    return answer.message;
  };
  EXPECT_EQ(wrong({{"command", "sdo read"}, {"node", "128"}, {"object", "1000"}}),
            "canopus: \"128\" is not a node; expected a node-ID 1 to 127");
  EXPECT_THAT(wrong({{"command", "sdo read"}, {"node", "3"}, {"object", "x"}}), StartsWith("canopus: "));
  EXPECT_THAT(wrong({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}, {"type", "u33"}}),
              StartsWith("canopus: --type: \"u33\" is not a type"));
  EXPECT_THAT(wrong({{"command", "sdo write"}, {"node", "3"}, {"object", "1017"}, {"value", "500"}}),
              StartsWith("canopus: type missing: use --type u16 (or another of "));
  EXPECT_EQ(wrong({{"command", "nmt start"}, {"node", "\u001b[2J"}}),
            "canopus: \"\\x1B[2J\" is not a node; expected a node-ID 1 to 127, or all");
  EXPECT_EQ(wrong({{"command", "boot retry"}, {"node", "5"}, {"master", "0"}}),
            "canopus: --master: \"0\" is not a node; expected a node-ID 1 to 127");
  EXPECT_EQ(wrong({{"command", "boot retry"}, {"node", "all"}, {"master", "1"}}),
            "canopus: --wait needs a single node");
  EXPECT_THAT(frames_, IsEmpty());
}

TEST_F(BusCommandsTest, NmtCommand_IsSent_AndNotConfirmed) {
  start();
  const Answer one = asked({{"command", "nmt start"}, {"node", "3"}});
  EXPECT_EQ(one.rows, Json::parse(R"([{"command":"start","node":3}])"));
  EXPECT_EQ(one.code, 0);
  const Answer all = asked({{"command", "nmt preop"}, {"node", "all"}});
  EXPECT_EQ(all.rows, Json::parse(R"([{"command":"preop","node":0}])"));
  EXPECT_THAT(frames_, IsSupersetOf({"000 01 03", "000 80 00"}));
}

TEST_F(BusCommandsTest, RetryOfABoot_IsARequestToTheMaster_AndWaitsForTheBootUpMessage) {
  start(devices + master);
  const Answer answer = asked({{"command", "boot retry"}, {"node", "5"}, {"master", "1"}}, 1s);
  EXPECT_EQ(answer.rows,
            Json::parse(R"([{"command":"reset-comm","node":5,"master":1,"state":"initialising"}])"));
  EXPECT_EQ(answer.code, 0);
  EXPECT_THAT(frames_, IsSupersetOf({"601 2F 82 1F 05 07 00 00 00", "581 60 82 1F 05 00 00 00 00",
                                     "000 82 05", "705 00"}));
}

TEST_F(BusCommandsTest, RetryOfABoot_OfAMasterThatIsNone_SaysWhy) {
  start();
  const Answer refused = asked({{"command", "boot retry"}, {"node", "5"}, {"master", "3"}});
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.message,
              StartsWith("canopus: master 3 did not take 07H for 1F82:05 (request NMT): abort 06020000H"));
  const Answer silent = asked({{"command", "boot retry"}, {"node", "5"}, {"master", "9"}}, 6s);
  EXPECT_EQ(silent.code, 1);
  EXPECT_EQ(silent.message,
            "canopus: master 9 did not take 07H for 1F82:05 (request NMT): no answer within 5.000 s");
}

TEST_F(BusCommandsTest, TwoUsers_AreServedOneAfterTheOther) {
  start();
  say({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}}, 1, WebRole::configure, "ann");
  say({{"command", "sdo read"}, {"node", "3"}, {"object", "1001"}}, 2, WebRole::operate, "bob");
  EXPECT_THAT(replies_, IsEmpty());
  run(100ms);
  EXPECT_EQ(answer(1).rows[0]["bytes"], "96010100");
  EXPECT_EQ(answer(2).rows[0]["bytes"], "00");
  EXPECT_THAT(frames_, ElementsAre("603 40 00 10 00 00 00 00 00", "583 43 00 10 00 96 01 01 00",
                                   "603 40 01 10 00 00 00 00 00", StartsWith("583 4F 01 10 00 00")));
  EXPECT_THAT(audit_, ElementsAre(StartsWith("ann: "), StartsWith("bob: ")));
}

TEST_F(BusCommandsTest, TheNextCommand_HasThePortOfTheOneBefore) {
  start();
  (void)asked({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}});
  const std::size_t ports = plant_->bus(0).ports().size();
  EXPECT_FALSE(plant_->bus(0).ports().back()->plugged());
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(asked({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}}).code, 0);
  EXPECT_EQ(plant_->bus(0).ports().size(), ports);
}

TEST_F(BusCommandsTest, RoleAndFields_AreChecked) {
  start();
  const Json read{{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}};
  say(read, 1, WebRole::look);
  EXPECT_EQ(answer(1).code, web_code::not_allowed);
  say({{"command", "sdo write"}, {"node", "3"}, {"object", "1017"}, {"value", "1"}, {"type", "u16"}}, 2,
      WebRole::operate);
  EXPECT_EQ(answer(2).code, web_code::not_allowed);
  say({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}, {"bus_address", "x"}}, 3);
  EXPECT_EQ(answer(3).code, web_code::usage);
  run(100ms);
  EXPECT_THAT(frames_, IsEmpty());
}

TEST_F(BusCommandsTest, ABusThatIsNotSimulated_KeepsItsChildProcess_AndItsArming) {
  start();
  const Json start_all{{"command", "nmt start"}, {"bus", "elsewhere"}, {"node", "all"}};
  say(start_all, 1);
  EXPECT_EQ(answer(1).code, web_code::not_armed);
  say({{"command", "arm"}, {"on", true}}, 2);
  say(start_all, 3);
  EXPECT_THAT(answer(3).message, StartsWith("a command cannot be started: "));
  say({{"command", "scan"}, {"bus", "line1"}}, 4);
  EXPECT_THAT(answer(4).message, StartsWith("a command cannot be started: "))
      << "what is not an SDO or NMT command";
  EXPECT_THAT(frames_, IsEmpty());
}

TEST_F(BusCommandsTest, ANodeThatLeavesInTheMiddle_IsATimeOut) {
  start();
  say({{"command", "sdo read"}, {"node", "3"}, {"object", "1008"}});
  while (frames_.size() < 4) run(100us);
  plant_->device(0).unplug();
  run(600ms);
  EXPECT_EQ(
      answer().rows,
      Json::parse(
          R"([{"node":3,"object":"1008:00","abort":"05040000","reason":"no answer within 500.0 ms"}])"));
  EXPECT_EQ(answer().code, 1);
}

TEST_F(BusCommandsTest, WhatIsStopped_AbortsItsTransfer) {
  start();
  say({{"command", "sdo read"}, {"node", "99"}, {"object", "1000"}}, 1);
  say({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}}, 2);
  run(10ms);
  say({{"command", "stop"}, {"id", 1}}, 3);
  run(10ms);
  EXPECT_EQ(answer(1).code, web_code::stopped);
  EXPECT_EQ(answer(1).rows, Json::parse(R"([{"node":99,"object":"1000:00","reason":"interrupted"}])"));
  EXPECT_EQ(answer(2).code, 0) << "the next one has its turn";
  EXPECT_THAT(frames_, Contains("663 80 00 10 00 00 00 00 08"));
}

TEST_F(BusCommandsTest, ThePageClosedInTheMiddle_LeavesTheBus) {
  start();
  say({{"command", "sdo read"}, {"node", "99"}, {"object", "1000"}});
  run(10ms);
  commands_.reset();
  EXPECT_FALSE(plant_->bus(0).ports().back()->plugged());
  EXPECT_TRUE(running_.expired());
  run(1s);
  EXPECT_THAT(replies_, IsEmpty());
  make_commands();
  EXPECT_EQ(asked({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}}).code, 0);
}

TEST_F(BusCommandsTest, ANmtCommandWhilePlantTimeStandsStill_IsOnTheBusWhenItGoesOn) {
  start();
  say({{"command", "nmt start"}, {"node", "3"}});
  io_.restart();
  io_.poll();
  EXPECT_EQ(answer().code, 0);
  EXPECT_THAT(frames_, IsEmpty());
  run(10ms);
  EXPECT_THAT(frames_, Contains("000 01 03"));
  EXPECT_FALSE(plant_->bus(0).ports().back()->plugged());
}

TEST_F(BusCommandsTest, TheEndOfTheRun_TakesWhatIsStillSentOffTheBus) {
  start();
  say({{"command", "nmt start"}, {"node", "3"}});
  io_.restart();
  io_.poll();
  commands_.reset();
  bus_commands_.reset();
  plant_->timeline().run_until(now() + can::Duration(2s));
  EXPECT_THAT(frames_, Not(Contains("000 01 03")));
}

TEST_F(BusCommandsTest, PlantTimeThatStandsStill_EndsTheCommand) {
  standstill_ = 1ms;
  start();
  say({{"command", "sdo read"}, {"node", "3"}, {"object", "1000"}});
  io_.restart();
  for (int turn = 0; turn < 1000 && answer().code < 0; ++turn) io_.run_one();
  EXPECT_EQ(answer().rows,
            Json::parse(R"([{"node":3,"object":"1000:00","reason":"plant time stands still"}])"));
  EXPECT_EQ(answer().code, 1);
  run(100ms);
  EXPECT_THAT(frames_, IsEmpty()) << "what failed is not sent later";
}

}  // namespace
}  // namespace canopus::web::bus_commands_test
