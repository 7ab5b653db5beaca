// What the page may have done: command lines, roles, arming, and programs that run beside this one.

#include "canopus/web/commands/commands.hpp"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <rapidcheck/gtest.h>

namespace canopus::web::commands_test {
namespace {

using Json = nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const WebBus line1{.name = "line1",
                   .project = "line1",
                   .network = 2,
                   .address = "socketcan:can0",
                   .is_live = true,
                   .device_files = {"eds"}};

const WebSettings module{
    .file = "module.xml", .model = "RJ71CN91", .plc = {"--plc=192.168.3.39:5007"}, .is_live = true};

std::expected<WebCommandLine, std::string> line_of(const text::Json& wish, const WebBus& bus = line1) {
  return web_command_line(wish, bus);
}

TEST(WebArguments, CommandLine_IsThatOfAPerson) {
  const auto line = line_of({{"command", "project set"},
                             {"node", "5"},
                             {"items", {"1017=500", "-M1"}},
                             {"name", "--help"},
                             {"present", true},
                             {"absent", false}});
  ASSERT_TRUE(line);
  EXPECT_THAT(line->arguments, ElementsAre("project", "set", "--json", "--network=2", "--name=--help",
                                           "--present", "--", "line1", "5", "1017=500", "-M1"));
  EXPECT_EQ(line->role, WebRole::configure);
  EXPECT_FALSE(line->writes_to_bus);
}

TEST(WebArguments, CommandOfModuleSettings_NamesTheirFileAndTheirPlc) {
  const auto arguments = [](const text::Json& wish) {
    const auto line = web_command_line(wish, module);
    return line ? line->arguments : std::vector<std::string>{line.error()};
  };
  EXPECT_THAT(arguments({{"command", "configure set"}, {"window", "tpdo/5"}, {"items", {"--json", "a=b"}}}),
              ElementsAre("configure", "set", "--", "module.xml", "tpdo/5", "--json", "a=b"));
  EXPECT_THAT(arguments({{"command", "configure describe"}}),
              ElementsAre("configure", "describe", "--json", "--module=RJ71CN91", "--"));
  EXPECT_THAT(arguments({{"command", "configure diff"}, {"part", "--yes"}}),
              ElementsAre("configure", "diff", "--json", "--plc=192.168.3.39:5007", "--part=--yes", "--",
                          "module.xml"));
  EXPECT_THAT(arguments({{"command", "configure sdo-read"}, {"node", "3"}, {"object", "1018:02"}}),
              ElementsAre("configure", "sdo-read", "--json", "--plc=192.168.3.39:5007",
                          "--project=module.xml", "--", "3", "1018:02"));
  EXPECT_THAT(arguments({{"command", "configure nodes save"}}),
              ElementsAre("configure", "nodes", "--save", "--yes", "--json", "--plc=192.168.3.39:5007", "--",
                          "module.xml"));
  EXPECT_THAT(arguments({{"command", "configure export"}}),
              ElementsAre("configure", "export", "--", "module.xml", "{file}"));
  EXPECT_THAT(arguments({{"command", "plc type"}}),
              ElementsAre("plc", "type", "--json", "--plc=192.168.3.39:5007", "--"));
  for (const char* unknown : {"configure new", "configure recent", "plc write", "project set"}) {
    EXPECT_THAT(arguments({{"command", unknown}}), ElementsAre(HasSubstr("unknown command"))) << unknown;
    EXPECT_FALSE(is_web_settings_command(unknown));
  }
  EXPECT_THAT(arguments({{"command", "configure show"}, {"bus", "line1"}}),
              ElementsAre("configure show: unknown \"bus\""));
}

TEST(WebArguments, ModuleSettings_WriteToTheModuleOnlyWithYes) {
  const auto writes = [](const text::Json& wish) { return web_command_line(wish, module)->writes_to_bus; };
  EXPECT_FALSE(writes({{"command", "configure write"}}));
  EXPECT_FALSE(writes({{"command", "configure write"}, {"yes", false}}));
  EXPECT_TRUE(writes({{"command", "configure write"}, {"yes", true}}));
  for (const char* name :
       {"configure reset", "configure nodes save", "configure nodes restore", "configure status clear"})
    EXPECT_TRUE(writes({{"command", name}})) << name;
  EXPECT_FALSE(writes({{"command", "configure status"}}));
}

TEST(WebArguments, ModuleSettingsWithoutAPlc_CanBeEditedAlone) {
  const WebSettings alone{.file = "module.xml", .model = "FX3U-CAN"};
  EXPECT_TRUE(web_command_line({{"command", "configure show"}}, alone));
  EXPECT_EQ(web_command_line({{"command", "configure diff"}}, alone).error(),
            "configure diff: there is no PLC with the module of module.xml");
}

TEST(WebArguments, CommandOfTheBus_HasItsAddress) {
  const auto line = line_of({{"command", "sdo write"}, {"node", "5"}, {"object", "1017"}, {"value", "-5"}});
  ASSERT_TRUE(line);
  EXPECT_THAT(line->arguments,
              ElementsAre("sdo", "write", "--json", "--bus=socketcan:can0", "--", "5", "1017", "-5"));
  EXPECT_TRUE(line->writes_to_bus);
  const auto adopt = line_of({{"command", "project adopt"}});
  ASSERT_TRUE(adopt);
  EXPECT_THAT(adopt->arguments, ElementsAre("project", "adopt", "--json", "--network=2",
                                            "--bus=socketcan:can0", "--eds=eds", "--", "line1"));
}

TEST(WebArguments, RetryOfABoot_IsARequestToTheMaster) {
  const auto one = line_of({{"command", "boot retry"}, {"node", "5"}, {"master", "1"}});
  ASSERT_TRUE(one);
  EXPECT_THAT(one->arguments, ElementsAre("nmt", "reset-comm", "--wait", "--timeout=5s", "--json",
                                          "--bus=socketcan:can0", "--master=1", "--", "5"));
  EXPECT_TRUE(one->writes_to_bus);
  EXPECT_EQ(one->role, WebRole::operate);
  const auto all = line_of({{"command", "boot retry all"}, {"node", "all"}, {"master", "1"}});
  ASSERT_TRUE(all);
  EXPECT_THAT(all->arguments,
              ElementsAre("nmt", "reset-comm", "--json", "--bus=socketcan:can0", "--master=1", "--", "all"));
  EXPECT_TRUE(all->writes_to_bus);
  for (const char* name : {"boot retry", "boot retry all"}) {
    EXPECT_EQ(line_of({{"command", name}, {"node", "5"}}).error(),
              fmt::format("{}: expected \"master\"", name));
  }
}

TEST(WebArguments, WhatIsDoneWithinTheProcess_HasTheFieldsThemselves) {
  const auto read = line_of({{"command", "sdo read"}, {"node", "--5"}, {"object", "1017"}, {"type", "u16"}});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->on_bus.kind, WebCommand::OnBus::Kind::sdo_read);
  EXPECT_EQ(read->field("node"), "--5") << "as it was said, whatever a command line would make of it";
  EXPECT_EQ(read->field("object"), "1017");
  EXPECT_EQ(read->field("type"), "u16");
  EXPECT_EQ(read->field("value"), "");
  EXPECT_EQ(line_of({{"command", "scan"}})->on_bus.kind, WebCommand::OnBus::Kind::none);
}

TEST(WebArguments, NmtCommands_AreTheSameWithinTheProcess_AndAsACommandLine) {
  for (const WebCommand& one : web_bus_commands()) {
    if (one.on_bus.kind != WebCommand::OnBus::Kind::nmt) continue;
    std::string words = fmt::format("nmt {}", one.on_bus.service);
    if (one.on_bus.waits) words += " --wait";
    if (one.on_bus.time_out != std::chrono::milliseconds(500))
      words += fmt::format(" --timeout={}s", one.on_bus.time_out / std::chrono::seconds(1));
    EXPECT_EQ(one.words.empty() ? one.title : one.words, words) << one.title;
  }
}

TEST(WebArguments, WhatOnlyShowsWhatItWouldWrite_NeedsNoArming) {
  EXPECT_FALSE(line_of({{"command", "project write"}})->writes_to_bus);
  EXPECT_FALSE(line_of({{"command", "project write"}, {"yes", false}})->writes_to_bus);
  EXPECT_TRUE(line_of({{"command", "project write"}, {"yes", true}})->writes_to_bus);
}

TEST(WebArguments, Roles) {
  EXPECT_EQ(line_of({{"command", "project show"}})->role, WebRole::look);
  EXPECT_EQ(line_of({{"command", "project diff"}})->role, WebRole::operate);
  EXPECT_EQ(line_of({{"command", "scan"}})->role, WebRole::operate);
  EXPECT_EQ(line_of({{"command", "nmt start"}, {"node", "1"}})->role, WebRole::operate);
  EXPECT_EQ(line_of({{"command", "project read"}})->role, WebRole::configure);
  EXPECT_EQ(line_of({{"command", "project undo"}})->role, WebRole::configure);
}

TEST(WebArguments, Nonsense_IsRefusedInASentence) {
  const auto error = [](const text::Json& wish, const WebBus& bus = line1) {
    const auto line = line_of(wish, bus);
    return line ? std::string("it was taken") : line.error();
  };
  EXPECT_EQ(error(text::Json::object()), "expected \"command\"");
  EXPECT_THAT(error({{"command", "plc write"}}), HasSubstr("unknown command \"plc write\"; expected one of"));
  EXPECT_EQ(error({{"command", "project remove"}}), "project remove: expected \"node\"");
  EXPECT_EQ(error({{"command", "project remove"}, {"node", 5}}),
            "project remove: \"node\" is to be a text of up to 1000 characters");
  EXPECT_EQ(error({{"command", "project remove"}, {"node", std::string("5\0", 2)}}),
            "project remove: \"node\" is to be a text of up to 1000 characters");
  EXPECT_EQ(error({{"command", "project remove"}, {"node", std::string(1000, '5')}}), "it was taken");
  EXPECT_EQ(error({{"command", "project remove"}, {"node", std::string(1001, '5')}}),
            "project remove: \"node\" is to be a text of up to 1000 characters");
  EXPECT_EQ(error({{"command", "project set"}, {"items", std::vector<std::string>(512, "a=1")}}),
            "it was taken");
  EXPECT_EQ(error({{"command", "project set"}, {"items", std::vector<std::string>(513, "a=1")}}),
            "project set: \"items\" is to be a list of up to 512 texts");
  EXPECT_EQ(error({{"command", "project undo"}, {"bus_address", "x"}}),
            "project undo: unknown \"bus_address\"");
  EXPECT_EQ(error({{"command", "project show"}, {"all", "yes"}}),
            "project show: \"all\" is to be true or false");
  EXPECT_EQ(error({{"command", "project set"}, {"items", {1}}}),
            "project set: \"items\" is to be a list of up to 512 texts");
  EXPECT_EQ(error({{"command", "project add"}, {"file", {{"name", "x.eds"}}}}),
            "project add: \"file\" is to be a file with its name and its text");
  EXPECT_EQ(error({{"command", "project show"}}, {.name = "a"}), "project show: the bus a has no project");
  EXPECT_EQ(error({{"command", "scan"}}, {.name = "a"}), "scan: commands cannot join the bus a");
  EXPECT_EQ(error({{"command", "project adopt"}}, {.name = "a", .project = "p", .address = "b"}),
            "project adopt: there are no device files; --eds names them");
}

RC_GTEST_PROP(WebArguments, NothingThatThePageSays_IsAnOptionOfItsOwn,
              (const std::string& node, const std::vector<std::string>& items, const std::string& name)) {
  const text::Json wish{{"command", "project set"}, {"node", node}, {"items", items}, {"name", name}};
  const auto line = line_of(wish);
  if (!line) return;
  const auto& words = line->arguments;
  RC_ASSERT(words.size() == 8 + items.size());
  RC_ASSERT(words[4] == "--name=" + name);
  RC_ASSERT(words[5] == "--");
  RC_ASSERT(words[6] == "line1" && words[7] == node);
  RC_ASSERT(std::equal(items.begin(), items.end(), words.begin() + 8));
}

TEST(WebArguments, ShownCommand_CanBeTypedAsItIs) {
  EXPECT_EQ(shown_command({"project", "set", "--name=A b", "it's", "", "1017=500"}),
            "canopus project set '--name=A b' 'it'\\''s' '' 1017=500");
}

/// Commands are run by a script, which prints what the test wants.
class WebCommandsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "canopus-test-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void script(const std::string& text) {
    const auto path = folder_ / "canopus";
    std::ofstream(path) << "#!/bin/sh\n" << text;
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    WebBus bus = line1;
    bus.is_live = is_live_;
    commands_.emplace(
        io_, WebCommands::Use{.buses = {bus},
                              .own = {{"double",
                                       {.role = WebRole::operate,
                                        .fields = {"n", "text"},
                                        .run =
                                            [](const text::Json& wish, const WebCommands::Own::Done& done) {
                                              if (!wish.contains("n"))
                                                return done(std::unexpected("expected n"));
                                              done(text::Json::object({{"n", 2 * wish["n"].get<int>()}}));
                                            }}}},
                              .program = path.string(),
                              .now = [] { return can::Time{}; },
                              .longest_with_files = longest_,
                              .longest_on_bus = longest_,
                              .grace = std::chrono::milliseconds(50),
                              .armed_for = armed_for_,
                              .most_output = 100'000,
                              .done =
                                  [this](const WebUser& user, const std::string& line, int code,
                                         const std::string& message, WebRole) {
                                    done_.push_back(user.name + ": " + line + ": " + std::to_string(code) +
                                                    (message.empty() ? "" : ": " + message));
                                  }});
  }
  void say(const Json& wish, std::uint32_t id = 1, WebRole role = WebRole::configure,
           const std::string& name = "ann") {
    commands_->run({.name = name, .role = role}, wish.dump(), id,
                   [this](const std::string& event) { replies_.push_back(Json::parse(event)); });
  }
  std::vector<Json> replies() {
    io_.restart();
    io_.run();
    return std::exchange(replies_, {});
  }

  /// Of one command. A program that takes its time has them told in several events.
  static Json rows_of(const std::vector<Json>& replies, std::uint32_t id = 1) {
    Json rows = Json::array();
    for (const Json& reply : replies) {
      if (reply["id"] != id || !reply.contains("rows")) continue;
      EXPECT_TRUE(reply["more"]);
      for (const Json& row : reply["rows"]) rows.push_back(row);
    }
    return rows;
  }

  bool is_live_ = false;
  std::chrono::milliseconds longest_ = std::chrono::hours(1);
  std::chrono::nanoseconds armed_for_ = std::chrono::minutes(10);
  std::filesystem::path folder_;
  boost::asio::io_context io_{1};
  std::optional<WebCommands> commands_;
  std::vector<Json> replies_;
  std::vector<std::string> done_;
};

TEST_F(WebCommandsTest, ACommandsRows_ComeWithItsCodeAndCommandLine) {
  script("echo '{\"node\": 5}'; echo 'no JSON'; echo '{\"node\": 6}'; echo 'canopus: oh' >&2; exit 4\n");
  say({{"command", "project diff"}}, 7);
  const auto replies = this->replies();
  EXPECT_EQ(rows_of(replies, 7), Json::parse(R"([{"node": 5}, {"node": 6}])"));
  const Json& last = replies.back();
  EXPECT_EQ(last["event"], "reply");
  EXPECT_EQ(last["id"], 7);
  EXPECT_EQ(last["code"], 4);
  EXPECT_EQ(last["message"], "canopus: oh");
  EXPECT_EQ(last["command"], "canopus project diff --json --network=2 --bus=socketcan:can0 -- line1");
  EXPECT_THAT(done_,
              ElementsAre("ann: canopus project diff --json --network=2 --bus=socketcan:can0 -- line1: 4: "
                          "canopus: oh"));
}

TEST_F(WebCommandsTest, Commands_RunOneAfterTheOther) {
  script("echo \"$1 $2 $3\" >> " + (folder_ / "log").string() + "; cat " + (folder_ / "log").string() +
         " | sed 's/.*/\"&\"/'\n");
  for (std::uint32_t id = 1; id <= 3; ++id) say({{"command", "project undo"}}, id);
  const auto replies = this->replies();
  for (std::uint32_t id = 1; id <= 3; ++id) EXPECT_EQ(rows_of(replies, id).size(), id);
}

TEST_F(WebCommandsTest, ProgramThatASignalEnds_HasItsCode) {
  script("kill -9 $$\n");
  say({{"command", "project undo"}});
  const auto replies = this->replies();
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0]["code"], 128 + 9);
}

TEST_F(WebCommandsTest, AProgramThatCannotBeStarted_IsSaid) {
  script("exit 0\n");
  std::filesystem::remove(folder_ / "canopus");
  say({{"command", "project undo"}});
  const auto replies = this->replies();
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0]["code"], 1);
  EXPECT_THAT(replies[0]["message"].get<std::string>(),
              HasSubstr("a command cannot be started: No such file"));
}

TEST_F(WebCommandsTest, WhatIsNestedDeeply_IsNoCommand) {
  script("exit 0\n");
  const std::string nested = std::string(200'000, '[') + std::string(200'000, ']');
  commands_->run({.name = "ann", .role = WebRole::configure}, R"({"command":"double","n":)" + nested + "}", 7,
                 [this](const std::string& event) { replies_.push_back(Json::parse(event)); });
  ASSERT_EQ(replies_.size(), 1U);
  EXPECT_EQ(replies_[0]["id"], 7);
  EXPECT_EQ(replies_[0]["message"], "expected \"command\"");
}

TEST_F(WebCommandsTest, Role_IsNeeded) {
  script("echo '{}'\n");
  say({{"command", "project undo"}}, 1, WebRole::operate);
  say({{"command", "scan"}}, 2, WebRole::look);
  say({{"command", "double"}, {"n", 3}}, 3, WebRole::look);
  say({{"command", "arm"}, {"on", true}}, 4, WebRole::look);
  for (const Json& reply : replies()) {
    EXPECT_EQ(reply["code"], web_code::not_allowed) << reply;
    EXPECT_THAT(reply["message"].get<std::string>(), HasSubstr("is needed, yours is"));
  }
  EXPECT_EQ(done_.size(), 4U);
  EXPECT_FALSE(commands_->is_armed());
}

TEST_F(WebCommandsTest, LiveBus_IsWrittenOnlyWhenArmed) {
  is_live_ = true;
  script("echo '{}'\n");
  const Json write{{"command", "nmt start"}, {"node", "all"}};
  say(write);
  EXPECT_EQ(replies().back()["code"], web_code::not_armed);
  say({{"command", "scan"}});
  EXPECT_EQ(replies().back()["code"], 0);
  say({{"command", "arm"}, {"on", true}});
  EXPECT_TRUE(commands_->is_armed());
  EXPECT_EQ(replies().back()["armed_for"], 600);
  say(write);
  EXPECT_EQ(replies().back()["code"], 0);
  say({{"command", "arm"}, {"on", false}});
  say(write);
  EXPECT_EQ(replies().back()["code"], web_code::not_armed);
}

TEST_F(WebCommandsTest, WhoOnlyLooks_CannotDisarm) {
  script("exit 0\n");
  say({{"command", "arm"}, {"on", true}});
  say({{"command", "arm"}, {"on", false}}, 2, WebRole::look);
  EXPECT_EQ(replies().back()["code"], web_code::not_allowed);
  EXPECT_TRUE(commands_->is_armed());
  EXPECT_THAT(
      done_, ElementsAre("ann: arm: 0", "ann: disarm: 7: disarm: the role operate is needed, yours is look"));
}

TEST_F(WebCommandsTest, Arming_FallsOffAfterItsTime) {
  is_live_ = true;
  armed_for_ = {};
  script("echo '{}'\n");
  say({{"command", "arm"}, {"on", true}});
  EXPECT_FALSE(commands_->is_armed());
  EXPECT_EQ(replies().back()["armed_for"], 0);
  say({{"command", "nmt start"}, {"node", "all"}});
  EXPECT_EQ(replies().back()["code"], web_code::not_armed);
}

TEST_F(WebCommandsTest, SimulatedBus_NeedsNoArming) {
  script("echo '{}'\n");
  say({{"command", "nmt start"}, {"node", "all"}});
  EXPECT_EQ(replies().back()["code"], 0);
}

TEST_F(WebCommandsTest, FileThatComesAlong_IsThereWithItsName_AndGoneAfterwards) {
  script(
      "for last; do :; done; printf '\"%s\"\\n' \"$last\"; sed 's/.*/\"&\"/' \"$last\"; ls -ld \"$(dirname "
      "\"$last\")\" | "
      "cut -c1-10 | sed 's/.*/\"&\"/'\n");
  say({{"command", "project add"}, {"file", {{"name", "..\\C:\\pump.eds"}, {"text", "[DeviceInfo]\n"}}}});
  const Json rows = rows_of(replies());
  ASSERT_EQ(rows.size(), 3U);
  const std::filesystem::path file = rows[0].get<std::string>();
  EXPECT_EQ(file.filename(), "pump.eds");
  EXPECT_EQ(rows[1], "[DeviceInfo]");
  EXPECT_EQ(rows[2], "drwx------");
  EXPECT_FALSE(std::filesystem::exists(file.parent_path()));
}

TEST_F(WebCommandsTest, FileThatACommandMakes_IsInItsReply) {
  script("for last; do :; done; echo '<html>' > \"$last\"\n");
  say({{"command", "project report"}}, 1, WebRole::look);
  EXPECT_EQ(replies().back()["file"], "<html>\n");
}

TEST_F(WebCommandsTest, WhatIsStopped_Ends) {
  script("trap 'exit 130' INT; echo '{}'; while :; do sleep 0.01; done\n");
  say({{"command", "project undo"}}, 1);
  say({{"command", "project undo"}}, 2);
  say({{"command", "stop"}, {"id", 2}}, 3);
  EXPECT_EQ(replies_[0]["code"], 0);
  EXPECT_EQ(replies_[1]["code"], web_code::stopped);
  while (replies_.size() < 3) io_.run_one();  // it runs, and has its trap
  say({{"command", "stop"}, {"id", 1}}, 4);
  const auto replies = this->replies();
  EXPECT_EQ(replies.back()["id"], 1);
  EXPECT_EQ(replies.back()["code"], web_code::stopped);
  const std::string line = "ann: canopus project undo --json --network=2 -- line1: 10";
  EXPECT_THAT(done_, ElementsAre(line + ": stopped", line)) << "the one that waited, the one that ran";
  // Somebody at another place who gives no name either is somebody else.
  say({{"command", "project undo"}}, 7);
  commands_->run({.name = "ann", .address = "192.0.2.7", .role = WebRole::configure},
                 Json{{"command", "stop"}, {"id", 7}}.dump(), 8,
                 [this](const std::string& event) { replies_.push_back(Json::parse(event)); });
  EXPECT_EQ(replies_.back()["code"], web_code::usage);
  EXPECT_EQ(replies_.back()["message"], "there is no such command of yours");
  say({{"command", "stop"}, {"id", 7}}, 10);
  EXPECT_EQ(replies_.back()["code"], 0);
  say({{"command", "stop"}, {"id", 9}}, 5);
  EXPECT_EQ(replies_.back()["code"], web_code::usage);
}

TEST_F(WebCommandsTest, TooManyCommandsOfOne_AreRefused) {
  script("exit 0\n");
  for (std::uint32_t id = 0; id <= WebCommands::most_of_user; ++id) say({{"command", "project undo"}}, id);
  ASSERT_EQ(replies_.size(), 1U);
  EXPECT_EQ(replies_[0]["code"], web_code::busy);
  say({{"command", "project undo"}}, 100, WebRole::configure, "bob");
  EXPECT_EQ(replies_.size(), 1U);
  EXPECT_EQ(replies().size(), 2 + WebCommands::most_of_user);
}

TEST_F(WebCommandsTest, TooManyCommandsOfAll_AreRefused) {
  script("exit 0\n");
  for (std::uint32_t id = 0; id <= WebCommands::most_waiting; ++id)
    say({{"command", "project undo"}}, id, WebRole::configure, std::to_string(id % 4));
  ASSERT_EQ(replies_.size(), 1U);
  EXPECT_EQ(replies_[0]["code"], web_code::busy);
  EXPECT_EQ(replies_[0]["id"], WebCommands::most_waiting);
  EXPECT_EQ(replies().size(), 1 + WebCommands::most_waiting);
}

TEST_F(WebCommandsTest, WhoOnlyLooks_LeavesRoomToOthers) {
  script("exit 0\n");
  for (std::uint32_t id = 0; id < 40; ++id)
    say({{"command", "project show"}}, id, WebRole::look, std::to_string(id));
  EXPECT_EQ(replies_.size(), 40 - WebCommands::most_of_role_look);
  replies_.clear();
  say({{"command", "project undo"}}, 100, WebRole::operate, "ann");
  EXPECT_EQ(replies_.size(), 1U);  // refused for its role, not for want of room
  EXPECT_EQ(replies_[0]["code"], web_code::not_allowed);
  replies_.clear();
  say({{"command", "project undo"}}, 101);
  EXPECT_THAT(replies_, IsEmpty());
  EXPECT_EQ(replies().size(), 1 + WebCommands::most_of_role_look);
}

TEST_F(WebCommandsTest, WhatIsNotAllowed_IsRefusedWhileNothingHasRoom) {
  script("exit 0\n");
  for (std::uint32_t id = 0; id < WebCommands::most_waiting; ++id)
    say({{"command", "project undo"}}, id, WebRole::configure, std::to_string(id % 4));
  say({{"command", "project undo"}}, 100, WebRole::look);
  EXPECT_EQ(replies_.at(0)["code"], web_code::not_allowed);
  EXPECT_EQ(replies().size(), 1 + WebCommands::most_waiting);
}

TEST_F(WebCommandsTest, Users_TakeTurns) {
  script("exit 0\n");
  for (std::uint32_t id = 1; id <= 4; ++id) say({{"command", "project undo"}}, id, WebRole::configure, "bob");
  for (std::uint32_t id = 11; id <= 12; ++id) say({{"command", "project undo"}}, id);
  say({{"command", "project show"}}, 21, WebRole::look, "");
  std::vector<int> order;
  for (const Json& reply : replies()) order.push_back(reply["id"].get<int>());
  EXPECT_THAT(order, ElementsAre(1, 11, 21, 2, 12, 3, 4));
}

TEST_F(WebCommandsTest, WhatTakesTooLong_IsStopped_AndWhatDoesNotStop_IsKilled) {
  longest_ = std::chrono::milliseconds(50);
  script("trap 'exit 130' INT; while :; do sleep 0.01; done\n");
  say({{"command", "project undo"}}, 1);
  auto replies = this->replies();
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0]["code"], web_code::stopped);
  EXPECT_EQ(replies[0]["message"], "it took too long and was stopped");
  script("trap '' INT TERM; while :; do sleep 0.01; done\n");
  say({{"command", "scan"}}, 2);
  say({{"command", "scan"}}, 3);
  replies = this->replies();
  ASSERT_EQ(replies.size(), 2U);
  EXPECT_EQ(replies[1]["code"], web_code::stopped);
}

TEST_F(WebCommandsTest, WhatDoesNotStopWhenItIsAsked_IsKilled) {
  script("trap '' INT TERM; echo '{}'; while :; do sleep 0.01; done\n");
  say({{"command", "project undo"}}, 1);
  while (replies_.empty()) io_.run_one();
  say({{"command", "stop"}, {"id", 1}}, 2);
  const auto replies = this->replies();
  EXPECT_EQ(replies.back()["id"], 1);
  EXPECT_EQ(replies.back()["code"], web_code::stopped);
}

TEST_F(WebCommandsTest, WhoPrintsWithoutEnd_IsEnded) {
  script("exec yes '{}'\n");
  say({{"command", "project show"}}, 1);
  const Json last = replies().back();
  EXPECT_EQ(last["code"], 128 + 9);
  EXPECT_THAT(last["message"].get<std::string>(), HasSubstr("it printed more than 100000 bytes"));
}

TEST_F(WebCommandsTest, CommandOfThisProcess_IsDoneAtOnce) {
  script("exit 0\n");
  say({{"command", "double"}, {"n", 3}}, 1, WebRole::operate);
  ASSERT_EQ(replies_.size(), 1U);
  EXPECT_EQ(replies_[0]["rows"], Json::parse(R"([{"n": 6}])"));
  say({{"command", "double"}}, 2);
  EXPECT_EQ(replies_[1]["code"], web_code::refused);
  EXPECT_EQ(replies_[1]["message"], "expected n");
  EXPECT_THAT(done_, ElementsAre(R"(ann: {"command":"double","n":3}: 0)",
                                 R"(ann: {"command":"double"}: 5: expected n)"));
}

TEST_F(WebCommandsTest, AFieldThatTheCommandDoesNotHave_IsRefusedByItsName) {
  script("exit 0\n");
  say({{"command", "double"}, {"n", 3}, {"filler", std::string(2'000'000, 'x')}});
  say({{"command", "hello"}, {"n", 3}});
  say({{"command", "arm"}, {"on", true}, {"off", true}});
  say({{"command", "stop"}, {"ID", 1}});
  for (const Json& reply : replies_) EXPECT_EQ(reply["code"], web_code::usage) << reply;
  EXPECT_EQ(replies_[0]["message"], "double: unknown \"filler\"; expected n or text");
  EXPECT_EQ(replies_[1]["message"], "hello: unknown \"n\"; expected no field");
  EXPECT_THAT(done_, ElementsAre("ann: double: 2: double: unknown \"filler\"; expected n or text",
                                 "ann: hello: 2: hello: unknown \"n\"; expected no field",
                                 "ann: arm: 2: arm: unknown \"off\"; expected on",
                                 "ann: stop: 2: stop: unknown \"ID\"; expected id"));
  EXPECT_FALSE(commands_->is_armed());
}

TEST_F(WebCommandsTest, WhatIsKeptOfACommand_IsCut_AndSaysSo) {
  script("for i in 1 2 3 4 5 6 7 8 9 10; do printf '%01000d' 0 >&2; done; exit 1\n");
  const std::string many(2'000'000, 'x');
  say({{"command", many}});
  say({{"command", "double"}, {"n", 3}, {"text", many}});
  say({{"command", "double"}, {many, 3}});
  say({{"command", "project remove"}, {"node", "1"}, {many, 3}});
  say({{"command", "project set"}, {"items", std::vector<std::string>(512, std::string(1000, 'x'))}});
  EXPECT_THAT(replies().back()["message"].get<std::string>(), ::testing::SizeIs(10'000))
      << "its client gets all";
  ASSERT_EQ(done_.size(), 5U);
  for (const std::string& one : done_) {
    EXPECT_LT(one.size(), 2 * WebCommands::longest_noted + 200);
    EXPECT_THAT(one, HasSubstr(" bytes in all)"));
  }
}

TEST_F(WebCommandsTest, Hello_SaysWhoOneIsAndWhatThereIs) {
  script("exit 0\n");
  say({{"command", "hello"}}, 1, WebRole::look);
  EXPECT_EQ(replies_[0]["role"], "look");
  EXPECT_EQ(replies_[0]["user"], "ann");
  EXPECT_EQ(replies_[0]["armed_for"], 0);
  EXPECT_EQ(replies_[0]["buses"][0]["bus"], "line1");
  EXPECT_EQ(replies_[0]["buses"][0]["project"], "line1");
  EXPECT_THAT(done_, IsEmpty());
}

TEST_F(WebCommandsTest, EndOfTheRun_EndsWhatRuns) {
  script("echo $$ > " + (folder_ / "process").string() + "; echo '{}'; exec sleep 1000\n");
  say({{"command", "project add"}, {"file", {{"name", "a"}, {"text", "b"}}}});
  while (replies_.empty()) io_.run_one();
  long process = 0;
  std::ifstream(folder_ / "process") >> process;
  ASSERT_GT(process, 1);
  replies_.clear();
  commands_.reset();
  EXPECT_FALSE(std::filesystem::exists("/proc/" + std::to_string(process)));
  EXPECT_THAT(replies(), IsEmpty());
}

}  // namespace
}  // namespace canopus::web::commands_test
