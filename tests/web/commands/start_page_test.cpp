// What the page offers before there is a plant or project. Programs are played by a script, which prints its arguments.

#include "canopus/web/commands/start_page.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "canopus/web/commands/example_files.hpp"

namespace canopus::web::start_page_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class WebStartTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "canopus-test-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    top_ = name;
    folder_ = top_ / "work";
    fs::create_directory(folder_);
  }
  void TearDown() override {
    start_.reset();
    fs::remove_all(top_);
  }
  WebStart& start(const std::string& text) {
    const fs::path program = top_ / "canopus";
    std::ofstream(program) << "#!/bin/sh\n" << text;
    fs::permissions(program, fs::perms::owner_all);
    return start_.emplace(io_, folder_, program.string());
  }
  void write(const fs::path& path, const std::string& text) {
    fs::create_directories((folder_ / path).parent_path());
    std::ofstream(folder_ / path) << text;
  }
  static std::vector<std::string> plants_of(const WebStart::Json& found) {
    std::vector<std::string> paths;
    for (const WebStart::Json& one : found["plants"]) paths.push_back(one["path"].get<std::string>());
    return paths;
  }
  WebStart::Done say() {
    return [this](std::expected<WebStart::Json, std::string> row) {
      said_.push_back(row ? row->dump() : "error: " + row.error());
    };
  }
  /// What was said, and the arguments that the script wrote down.
  std::vector<std::string> said() {
    io_.restart();
    while (said_.empty() && io_.run_one() != 0) {
    }
    return std::exchange(said_, {});
  }
  std::string arguments() {
    std::ifstream file(top_ / "arguments");
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::string shows_page() const {
    return "echo \"$@\" > " + (top_ / "arguments").string() +
           "; echo '{\"event\":\"nmt\"}'; echo "
           "'{\"event\":\"listen\",\"protocol\":\"web\",\"address\":\"http://127.0.0.1:1/#key=2\"}'; "
           "exec sleep 1000\n";
  }

  fs::path top_;
  fs::path folder_;
  boost::asio::io_context io_{1};
  std::optional<WebStart> start_;
  std::vector<std::string> said_;
};

TEST_F(WebStartTest, TheFolder_IsShownAsPeopleKnowIt) {
  const char* const home = std::getenv("HOME");
  const std::string before = home == nullptr ? "" : home;
  const auto shown = [&](const fs::path& of_user) {
    ::setenv("HOME", of_user.c_str(), 1);
    return start("").list()["folder"].get<std::string>();
  };
  EXPECT_EQ(shown("/nowhere"), folder_.string());
  EXPECT_EQ(shown(folder_.string() + "x"), folder_.string());
  EXPECT_EQ(shown(folder_.parent_path()), "~/" + folder_.filename().string());
  EXPECT_EQ(shown(folder_), "~");
  EXPECT_EQ(shown(""), folder_.string());
  ::setenv("HOME", before.c_str(), 1);
}

TEST_F(WebStartTest, PlantsAndProjectsOfTheFolder_TwoFoldersDown) {
  write("b.toml", "[[bus]]\n");
  write("other.toml", "[package]\n");
  write(".hidden/c.toml", "[[bus]]\n");
  write(".b.toml", "[[bus]]\n");
  write("x/a.toml", "[[bus]]\n");
  write("x/y/nodelist.cpj", "");
  write("x/y/z/deep.toml", "[[bus]]\n");
  write("line/nodelist.cpj", "");
  const WebStart::Json found = start("").list();
  EXPECT_THAT(plants_of(found), ElementsAre("b.toml", "x/a.toml"));
  EXPECT_EQ(found["projects"].dump(), R"(["line/nodelist.cpj","x/y/nodelist.cpj"])");
}

TEST_F(WebStartTest, Plants_AreShownByWhatTheyHave) {
  write(
      "good.toml",
      "[plant]\nname = \"press\"\n[[bus]]\nname = \"line1\"\nbit_rate = 250_000\n[[bus]]\nname = "
      "\"far\"\nbit_rate = "
      "500_000\nlink = \"socketcan:can0\"\n[[device]]\nbus = \"line1\"\nnode = 3\nname = \"encoder\"\neds = "
      "\"e.eds\"\n[[device]]\nbus = \"line1\"\nnode = 4\neds = \"e.eds\"\n[[plc]]\nlisten = "
      "\"off\"\n[[plc.module]]\nmodel = \"ME3CAN1-Q\"\nbus = \"line1\"\nnode = 1\n");
  write("wrong.toml", "[[bus]]\nname = \"a\"\nbit_rate = 1\n");
  write("large.toml", "[[bus]]\n" + std::string(300'000, '#'));
  const WebStart::Json found = start("").list();
  const WebStart::Json& good = found["plants"][0];
  EXPECT_EQ(good["name"], "press");
  EXPECT_EQ(
      good["buses"].dump(),
      R"([{"bus":"line1","bit_rate":250000,"live":false,"modules":["ME3CAN1-Q"],"devices":["encoder","node 4"]},)"
      R"({"bus":"far","bit_rate":500000,"live":true,"modules":[],"devices":[]}])");
  EXPECT_EQ(found["plants"][1].dump(), R"({"path":"large.toml"})");
  EXPECT_THAT(found["plants"][2]["problem"].get<std::string>(), HasSubstr("wrong.toml:3:"));
  EXPECT_THAT(found["models"].dump(), HasSubstr("\"ME3CAN1-Q\""));
}

TEST_F(WebStartTest, SettingsOfModules_AreListedAndOpened_OtherXmlIsNot) {
  write("m.xml", "<?xml version=\"1.0\"?>\n<canopus-module format=\"1\"/>\n");
  write("device.xml", "<ISO15745ProfileContainer/>\n");
  write("settings.toml", "<canopus-module\n");
  WebStart& start = this->start(shows_page());
  EXPECT_EQ(start.list()["settings"].dump(), R"(["m.xml"])");
  EXPECT_THAT(start.list()["plants"], IsEmpty());
  start.open("m.xml", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  EXPECT_EQ(arguments(), "web --json -- " + (folder_ / "m.xml").string() + "\n");
  start.open("device.xml", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("error: there is no plant or project ")));
}

TEST_F(WebStartTest, NewSettings_AreMadeAndOpened) {
  const std::string log = (top_ / "log").string();
  WebStart& start = this->start("echo \"$@\" >> " + log + "; [ $1 = configure ] && exit 0; " + shows_page());
  start.make_settings("press", "RJ71CN91", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  const std::string file = (folder_ / "press.xml").string();
  std::ifstream written(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(written), {}),
            "configure new --module=RJ71CN91 -- " + file + "\nweb --json -- " + file + "\n");
  for (const char* name : {"", ".x", "a/b", "a\\b", "../x"}) {
    start.make_settings(name, "RJ71CN91", say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: expected a name"))) << name;
  }
  write("there.xml", "");
  start.make_settings("there.xml", "RJ71CN91", say());
  EXPECT_THAT(said(), ElementsAre("error: there is something with the name there.xml already"));
}

TEST_F(WebStartTest, SaveAs_CopiesListedSettings_AndOpensTheCopy) {
  const std::string log = (top_ / "log").string();
  WebStart& start = this->start("echo \"$@\" >> " + log + "; [ $1 = configure ] && exit 0; " + shows_page());
  write("m.xml", "<canopus-module format=\"1\"/>\n");
  write("there.xml", "");
  start.save_settings_as("m.xml", "copy", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  const std::string copy = (folder_ / "copy.xml").string();
  std::ifstream written(log);
  EXPECT_EQ(
      std::string(std::istreambuf_iterator<char>(written), {}),
      "configure export -- " + (folder_ / "m.xml").string() + " " + copy + "\nweb --json -- " + copy + "\n");
  for (const auto& [path, name, error] :
       {std::array{"m.xml", "there.xml", "error: there is something with the name there.xml already"},
        {"m.xml", "../x", "error: expected a name"},
        {"there.xml", "other", "error: there are no settings there.xml"},
        {"/etc/passwd", "other", "error: there are no settings /etc/passwd"},
        {"", "other", "error: there are no settings "}}) {
    start.save_settings_as(path, name, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr(error))) << path;
  }
}

TEST_F(WebStartTest, RecentProjects_AreThoseThatAreStillThere_AndOpenWhereverTheyLie) {
  const fs::path state = top_ / "state";
  ::setenv("XDG_STATE_HOME", state.c_str(), 1);
  write("in.xml", "<canopus-module format=\"1\"/>\n");
  std::ofstream(top_ / "out.xml") << "<canopus-module format=\"1\"/>\n";
  const std::string out = (top_ / "out.xml").string();
  const std::string in = (folder_ / "in.xml").string();
  fs::create_directories(state / "canopus");
  std::ofstream(state / "canopus" / "recent-projects") << out << "\n"
                                                       << in << "\n"
                                                       << (top_ / "gone.xml").string() << "\n/etc/passwd\n";
  WebStart& start = this->start(shows_page());
  EXPECT_EQ(start.recent(), (WebStart::Json{{"recent", {out, in}}}));
  start.open(out, say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  EXPECT_EQ(arguments(), "web --json -- " + out + "\n");
  start.open("/etc/passwd", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("error: there is no plant or project ")));
  // Those who are on another machine get nothing from outside of the folder.
  start_.emplace(io_, folder_, "/bin/false", WebAccess{.users = "users"});
  EXPECT_EQ(start_->recent(), (WebStart::Json{{"recent", {in}}}));
  start_->open(out, say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("error: there is no plant or project ")));
  ::unsetenv("XDG_STATE_HOME");
}

TEST_F(WebStartTest, Exit_AnswersAndThenEndsTheProgram) {
  start("").exit(say());
  EXPECT_EQ(said_, std::vector<std::string>{"{\"exit\":true}"});
  EXPECT_FALSE(io_.stopped());
  // Something that would keep it running for ever.
  const auto work = boost::asio::make_work_guard(io_);
  io_.run();
  EXPECT_TRUE(io_.stopped());
}

TEST_F(WebStartTest, AFolderThatIsNotThere_OffersNothing) {
  fs::remove(folder_);
  EXPECT_THAT(start("").list()["plants"], IsEmpty());
}

TEST_F(WebStartTest, PlantAndProject_AreRun_AndTheirPageIsSaid) {
  write("b.toml", "[[bus]]\n");
  write("line/nodelist.cpj", "");
  WebStart& start = this->start(shows_page());
  start.open("b.toml", say());
  EXPECT_THAT(said(), ElementsAre("{\"url\":\"http://127.0.0.1:1/#key=2\"}"));
  EXPECT_EQ(arguments(), "run --json --web --free-ports -- " + (folder_ / "b.toml").string() + "\n");
  start.open("line/nodelist.cpj", say());
  EXPECT_THAT(said(), ElementsAre("{\"url\":\"http://127.0.0.1:1/#key=2\"}"));
  EXPECT_EQ(arguments(), "web --json -- " + (folder_ / "line/nodelist.cpj").string() + "\n");
}

TEST_F(WebStartTest, NothingElseIsOpened) {
  std::ofstream(top_ / "outside.toml") << "[[bus]]\n";
  write("b.toml", "[[bus]]\n");
  WebStart& start = this->start(shows_page());
  for (const char* path : {"../outside.toml", "c.toml", "./b.toml", "/etc/passwd", "b.toml/"}) {
    start.open(path, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: there is no plant or project "))) << path;
  }
  EXPECT_EQ(arguments(), "");
}

TEST_F(WebStartTest, BuiltInPlant_IsWrittenForItsRun_AndGoneAfterwards) {
  start(shows_page()).open("", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  const std::string words = arguments();
  const fs::path plant = words.substr(words.find("-- ") + 3, words.size() - words.find("-- ") - 4);
  for (const ExampleFile& file : example_files()) {
    std::ifstream written(plant.parent_path().parent_path() / file.path);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(written), {}), file.content) << file.path;
  }
  EXPECT_GE(example_files().size(), 4U);
  start_.reset();
  EXPECT_FALSE(fs::exists(plant.parent_path().parent_path()));
}

TEST_F(WebStartTest, WhatDoesNotStart_SaysWhy) {
  write("b.toml", "[[bus]]\n");
  start("echo 'canopus: oh' >&2; exit 2\n").open("b.toml", say());
  EXPECT_THAT(said(), ElementsAre("error: canopus: oh\n"));
  start("exit 3\n").open("b.toml", say());
  EXPECT_THAT(said(), ElementsAre("error: it ended with exit code 3"));
}

TEST_F(WebStartTest, NewProject_IsMadeAndOpened) {
  WebStart& start = this->start("if [ $1 = project ]; then mkdir \"$5\"; exit 0; fi\n" + shows_page());
  start.make_project({{"name", "line 1"}}, say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  EXPECT_TRUE(fs::is_directory(folder_ / "line 1"));
  EXPECT_EQ(arguments(), "web --json -- " + (folder_ / "line 1").string() + "\n");
  for (const char* name : {"", "../x", "a/b", ".x", "a\\b", "\x1B[2J"}) {
    start.make_project({{"name", name}}, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: expected a name"))) << name;
  }
}

constexpr std::string_view servo_file =
    "[DeviceInfo]\nVendorNumber=1\n[1000]\nParameterName=T\nDataType=7\nAccessType=ro\nDefaultValue="
    "0x20192\n";
const WebStart::Json servo{{"file", {{"name", "Servo 1.eds"}, {"text", servo_file}}}, {"name", "servo"}};

TEST_F(WebStartTest, NewPlant_IsAFolderWithItsFiles_CheckedAndRun) {
  const std::string log = (top_ / "log").string();
  WebStart& start = this->start("echo \"$@\" >> " + log + "; [ $1 = check ] && exit 0; " + shows_page());
  WebStart::Json valve = servo;
  valve["node_id"] = 2U;
  start.make_plant(
      {{"name", "press"}, {"model", "FX3U-CAN"}, {"bit_rate", "125k"}, {"devices", {servo, valve}}}, say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  const std::string file = (folder_ / "press/plant.toml").string();
  std::ifstream written(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(written), {}),
            "check -- " + file + "\nrun --json --web --free-ports -- " + file + "\n");
  std::ifstream plant(file);
  const std::string text(std::istreambuf_iterator<char>(plant), {});
  EXPECT_THAT(text, HasSubstr("bit_rate = 125000\n"));
  EXPECT_THAT(text, HasSubstr("[[device]]\nnode = 3\nname = \"servo\"\neds = \"node-3-Servo_1.eds\"\n"))
      << "the lowest node-ID that is free";
  EXPECT_THAT(text, HasSubstr("[[device]]\nnode = 2\nname = \"servo\"\neds = \"node-2-Servo_1.eds\"\n"));
  EXPECT_THAT(text, HasSubstr("model = \"FX3U-CAN\"\nposition = 0\nnode = 1\nmaster = true "));
  EXPECT_TRUE(fs::is_regular_file(folder_ / "press/node-3-Servo_1.eds"));
}

TEST_F(WebStartTest, NewPlantThatIsWrong_IsNotKept) {
  WebStart& start = this->start("echo 'plant.toml:9:1: oh' >&2; exit 2\n");
  start.make_plant({{"name", "press"}, {"model", "ME3CAN1-Q"}, {"devices", {servo}}}, say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("plant.toml:9:1: oh")));
  EXPECT_FALSE(fs::exists(folder_ / "press"));
  const auto refused = [&](const WebStart::Json& wish) {
    start.make_plant(wish, say());
    return said().front();
  };
  write("there", "");
  EXPECT_THAT(refused({{"name", "there"}, {"model", "ME3CAN1-Q"}}),
              HasSubstr("there is something with the name there"));
  EXPECT_THAT(refused({{"name", "../x"}, {"model", "ME3CAN1-Q"}}), HasSubstr("expected a name without /"));
  EXPECT_THAT(refused({{"name", "a"}, {"model", "X"}}), HasSubstr("model: expected one of ME3CAN1-Q"));
  EXPECT_THAT(refused({{"name", "a"}, {"model", "ME3CAN1-Q"}, {"bit_rate", "3k"}}),
              HasSubstr("bit_rate: expected 10k, "));
  const auto with = [&](const WebStart::Json& device) {
    return refused(
        {{"name", "a"}, {"model", "ME3CAN1-Q"}, {"devices", WebStart::Json::array({servo, device})}});
  };
  EXPECT_THAT(with("x"), HasSubstr("device 2: expected \"file\" with its name and its text"));
  EXPECT_THAT(with({{"file", {{"name", "x.exe"}, {"text", "x"}}}}),
              HasSubstr("device 2: \"file\": expected a name that ends"));
  WebStart::Json twin = servo;
  twin["node_id"] = 128U;
  EXPECT_THAT(with(twin), HasSubstr("device 2: \"node_id\": expected 1 to 127"));
  twin["node_id"] = 1U;
  EXPECT_THAT(with(twin), HasSubstr("node-ID 1: two nodes have it, the module is one of them"));
  WebStart::Json outside = servo;
  outside["file"]["name"] = "../../x.eds";
  start.make_plant({{"name", "b"}, {"model", "ME3CAN1-Q"}, {"devices", WebStart::Json::array({outside})}},
                   say());
  (void)said();
  EXPECT_FALSE(fs::exists(top_ / "x.eds") || fs::exists(folder_ / "x.eds"));
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

TEST_F(WebStartTest, NewProjectWithDevices_IsMadeByTheCommands_AndGoesWhenOneFails) {
  const std::string log = (top_ / "log").string();
  WebStart& start =
      this->start("echo \"$@\" >> " + log + "; if [ $2 = new ]; then mkdir \"$5\"; exit 0; fi\n" +
                  "if [ $2 = add ]; then case \"$*\" in *bad*) echo 'canopus project: oh' >&2; exit 3;; "
                  "esac; exit 0; fi\n" +
                  shows_page());
  start.make_project({{"name", "line"}, {"bit_rate", "500k"}, {"devices", {servo}}}, say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  std::ifstream written(log);
  const std::string lines(std::istreambuf_iterator<char>(written), {});
  EXPECT_THAT(lines, HasSubstr("project add --json --node-id=1 --bit-rate=500k --name=servo -- " +
                               (folder_ / "line").string() + " /"));
  EXPECT_THAT(lines, HasSubstr("/node-1-Servo_1.eds\n"));
  WebStart::Json bad = servo;
  bad["name"] = "bad";
  start.make_project({{"name", "other"}, {"devices", WebStart::Json::array({bad})}}, say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("oh")));
  EXPECT_FALSE(fs::exists(folder_ / "other"));
}

TEST_F(WebStartTest, NotMoreThanSoMany) {
  WebStart& start = this->start(shows_page());
  for (std::size_t i = 0; i < WebStart::most_running; ++i) {
    start.open("", say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  }
  start.open("", say());
  EXPECT_THAT(said(), ElementsAre("error: 8 are running already; end one of them first"));
}

TEST_F(WebStartTest, WhatRunsAlready_IsShownAgain_AndEnded) {
  write("a.toml", "[[bus]]\n");
  WebStart& start = this->start(shows_page());
  start.open("a.toml", say());
  start.open("a.toml", say());  // it starts still
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http"), HasSubstr("http")));
  start.open("a.toml", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  EXPECT_EQ(start.list()["running"].dump(), R"([{"number":0,"path":"a.toml"}])") << "one of them";
  start.end(7, say());
  EXPECT_THAT(said(), ElementsAre("error: nothing runs under this number"));
  start.end(0, say());
  EXPECT_THAT(said(), ElementsAre(R"({"ended":"a.toml"})"));
  for (int i = 0; i < 100 && !start.list()["running"].empty(); ++i) io_.run_one();
  EXPECT_THAT(start.list()["running"], IsEmpty());
}

TEST_F(WebStartTest, NotMoreWaitForAPageThanSoMany) {
  write("a.toml", "[[bus]]\n");
  WebStart& start = this->start("exec sleep 1000\n");
  for (std::size_t i = 0; i < WebStart::most_openers; ++i) start.open("a.toml", say());
  EXPECT_THAT(said_, IsEmpty());
  start.open("a.toml", say());
  EXPECT_THAT(said(), ElementsAre("error: it is being opened; try again"));
}

TEST_F(WebStartTest, LinksThatLeadOut_AreNotOffered) {
  std::ofstream(top_ / "outside.toml") << "[[bus]]\n";
  std::ofstream(top_ / "outside.cpj") << "";
  write("b.toml", "[[bus]]\n");
  fs::create_symlink("b.toml", folder_ / "inside.toml");
  fs::create_symlink("../outside.toml", folder_ / "out.toml");
  fs::create_symlink(top_ / "outside.cpj", folder_ / "out.cpj");
  fs::create_symlink("nowhere.toml", folder_ / "dangling.toml");
  fs::create_symlink("loop.toml", folder_ / "loop.toml");
  fs::create_directory_symlink(top_, folder_ / "folder");
  ASSERT_EQ(::mkfifo((folder_ / "fifo.cpj").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder_ / "fifo.toml").c_str(), 0600), 0);
  WebStart& start = this->start(shows_page());
  EXPECT_THAT(plants_of(start.list()), ElementsAre("b.toml", "inside.toml"));
  EXPECT_THAT(start.list()["projects"], IsEmpty());
  for (const char* path : {"out.toml", "out.cpj", "folder/outside.toml", "fifo.cpj"}) {
    start.open(path, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: there is no plant or project "))) << path;
  }
  EXPECT_EQ(arguments(), "");
}

TEST_F(WebStartTest, WhatChanges_IsReadAgain) {
  write("b.toml", "[[car]]\n");
  WebStart& start = this->start("");
  EXPECT_THAT(start.list()["plants"], IsEmpty());
  write("b.toml", "[[bus]]\n");
  fs::last_write_time(folder_ / "b.toml", fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_THAT(plants_of(start.list()), ElementsAre("b.toml"));
}

TEST_F(WebStartTest, NotMoreIsReadThanSoManyBytes) {
  const std::string plant = "[[bus]]\n" + std::string(4'000'000, '#');
  for (int i = 10; i < 30; ++i) write(std::to_string(i) + ".toml", plant);
  WebStart& start = this->start("");
  EXPECT_EQ(start.list()["plants"].size(), WebStart::most_read / plant.size());
  EXPECT_EQ(start.list()["plants"].size(), 20U);  // the others now
}

TEST_F(WebStartTest, HostileNames_AreShownAsTheyAre_OrNot) {
  const std::string newline = "a\nb\x1B[2J<img>.toml";
  const std::string longest = std::string(250, 'x') + ".toml";
  for (const std::string& name : {newline, longest, std::string("--for.toml")}) write(name, "[[bus]]\n");
  write("\xFF.toml", "[[bus]]\n");
  WebStart& start = this->start(shows_page());
  const WebStart::Json plants = start.list()["plants"];
  EXPECT_EQ(plants.size(), 4U);
  for (const std::string& name : {newline, longest, std::string("--for.toml")}) {
    start.open(name, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("http"))) << name;
    EXPECT_EQ(arguments(), "run --json --web --free-ports -- " + (folder_ / name).string() + "\n");
  }
}

TEST_F(WebStartTest, NewProject_TakesNothingThatIsThere) {
  write("b", "");
  fs::create_symlink(top_ / "elsewhere", folder_ / "link");
  WebStart& start = this->start("mkdir -p \"$5\"\n" + shows_page());
  for (const char* name : {"b", "link"}) {
    start.make_project({{"name", name}}, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: there is something with the name"))) << name;
  }
  EXPECT_FALSE(fs::exists(top_ / "elsewhere"));
  for (const std::string& name : {std::string(101, 'x'), std::string("a\nb"), std::string("\xFF"),
                                  std::string("a\0b", 3), std::string("..")}) {
    start.make_project({{"name", name}}, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: expected a name"))) << name;
  }
}

TEST_F(WebStartTest, WithUsers_ThePagesThatAreOpened_HaveThemToo) {
  write("b.toml", "[[bus]]\n");
  write("nodelist.cpj", "");
  (void)start(shows_page());
  start_.emplace(io_, folder_, (top_ / "canopus").string(), WebAccess{.users = "u", .audit = "log"});
  start_->open("b.toml", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  EXPECT_EQ(arguments(), "run --json --web --free-ports --web-users=u --web-audit=log -- " +
                             (folder_ / "b.toml").string() + "\n");
  start_->open("nodelist.cpj", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  EXPECT_EQ(arguments(), "web --json --users=u --audit=log -- " + (folder_ / "nodelist.cpj").string() + "\n");
}

}  // namespace
}  // namespace canopus::web::start_page_test
