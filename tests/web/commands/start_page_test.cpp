// What the page offers before there is a plant or project. Programs are played by a script, which prints its arguments.

#include "canopus/web/commands/start_page.hpp"

#include <chrono>
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
  EXPECT_EQ(found["folder"], folder_.string());
  EXPECT_EQ(found["plants"].dump(), R"(["b.toml","x/a.toml"])");
  EXPECT_EQ(found["projects"].dump(), R"(["line/nodelist.cpj","x/y/nodelist.cpj"])");
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
            "configure new --model=RJ71CN91 -- " + file + "\nweb --json -- " + file + "\n");
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
  start.make_project("line 1", say());
  EXPECT_THAT(said(), ElementsAre(HasSubstr("http")));
  EXPECT_TRUE(fs::is_directory(folder_ / "line 1"));
  EXPECT_EQ(arguments(), "web --json -- " + (folder_ / "line 1").string() + "\n");
  for (const char* name : {"", "../x", "a/b", ".x", "a\\b", "\x1B[2J"}) {
    start.make_project(name, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: expected a name"))) << name;
  }
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
  EXPECT_EQ(start.list()["plants"].dump(), R"(["b.toml","inside.toml"])");
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
  EXPECT_EQ(start.list()["plants"].dump(), R"(["b.toml"])");
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
    start.make_project(name, say());
    EXPECT_THAT(said(), ElementsAre(HasSubstr("error: there is something with the name"))) << name;
  }
  EXPECT_FALSE(fs::exists(top_ / "elsewhere"));
  for (const std::string& name : {std::string(101, 'x'), std::string("a\nb"), std::string("\xFF"),
                                  std::string("a\0b", 3), std::string("..")}) {
    start.make_project(name, say());
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
