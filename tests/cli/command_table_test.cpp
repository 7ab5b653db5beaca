// The commands as a table, and what becomes of a command line that is read by it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/app/completion_script.hpp"
#include "canopus/cli/options/command.hpp"
#include "canopus/cli/options/parser.hpp"

namespace canopus::cli::command_table_test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Words = std::vector<std::string>;
using enum Parsing::Result;

/// Two commands; which of them were built.
struct TwoCommands {
  TwoCommands() {
    app.add_subcommand("read", "Read", [this](Command& read) {
      built.emplace_back("read");
      read.add_option("--rate", rate, "How often")->type_name("RATE")->check(one_of_words({"slow", "fast"}));
      read.callback([this] { called.emplace_back("read"); });
    });
    app.add_subcommand("write", "Write", [this](Command& write) {
      built.emplace_back("write");
      write.add_subcommand("file", "Into a file", [this](Command&) { built.emplace_back("write file"); });
    });
  }
  Parsing parse(const Words& words) { return parse_words(app, words); }

  Command app{"Does things", "prog"};
  std::string rate;
  Words built, called;
};

TEST(LazyCommands, ACommandLine_BuildsTheCalledCommandAlone) {
  TwoCommands program;
  EXPECT_EQ(program.parse({"read", "--rate", "slow"}).result, ran);
  EXPECT_THAT(program.built, ElementsAre("read"));
  EXPECT_THAT(program.called, ElementsAre("read"));
  EXPECT_EQ(program.rate, "slow");
}

TEST(LazyCommands, TheProgramsHelp_BuildsNone) {
  TwoCommands program;
  const Parsing parsing = program.parse({"--help"});
  EXPECT_EQ(parsing.result, answered);
  EXPECT_THAT(parsing.text, HasSubstr("write"));
  EXPECT_THAT(program.built, IsEmpty());
}

TEST(LazyCommands, TheHelpOfACommand_DoesNotBuildThoseInIt) {
  TwoCommands program;
  EXPECT_THAT(program.parse({"write", "--help"}).text, HasSubstr("Into a file"));
  EXPECT_THAT(program.built, ElementsAre("write"));
}

TEST(LazyCommands, BuildAll_BuildsEachOnce) {
  TwoCommands program;
  program.app.build_all();
  program.app.build_all();
  EXPECT_THAT(program.built, ElementsAre("read", "write", "write file"));
}

TEST(Choices, FeedTheCompletionOfShells) {
  TwoCommands program;
  program.app.build_all();
  EXPECT_THAT(completion_script(program.app, Shell::bash),
              HasSubstr("prog/read:--rate) echo 'slow fast' ;;\n"));
}

TEST(Choices, RefuseAnotherWord) {
  TwoCommands program;
  const Parsing parsing = program.parse({"read", "--rate", "fats"});
  EXPECT_EQ(parsing.result, wrong);
  EXPECT_EQ(parsing.text, "--rate: \"fats\" is unknown; did you mean \"fast\"?");
  EXPECT_THAT(program.called, IsEmpty());
}

/// A command with names that CLI11 does not take for arguments.
struct OddNames {
  OddNames() {
    set->add_option("FIELD=VALUE", fields, "Fields")->required();
    link->add_option("FROM TO", ends, "Signals")->required()->expected(2);
  }
  Parsing parse(const Words& words) { return parse_words(app, words); }

  Command app{"Does things", "prog"};
  Command* set = app.add_subcommand("set", "Set fields");
  Command* link = app.add_subcommand("link", "Link signals");
  Words fields, ends;
};

TEST(ArgumentNames, WithAnEqualsSign_TakeWords) {
  OddNames program;
  EXPECT_EQ(program.parse({"set", "Node ID=5", "a=b"}).result, ran);
  EXPECT_THAT(program.fields, ElementsAre("Node ID=5", "a=b"));
}

TEST(ArgumentNames, WithAnEqualsSign_AreShownAsTheyAre) {
  OddNames program;
  EXPECT_THAT(program.parse({"set", "--help"}).text, HasSubstr(" FIELD=VALUE..."));
  EXPECT_EQ(program.parse({"set"}).text, "FIELD=VALUE is required");
  EXPECT_EQ(program.set->usage(), "prog set [OPTIONS] FIELD=VALUE...");
}

TEST(ArgumentNames, WithASpace_AreShownAsTheyAre) {
  OddNames program;
  const Parsing parsing = program.parse({"link", "a"});
  EXPECT_THAT(parsing.text, HasSubstr("FROM TO"));
  EXPECT_NE(parsing.result, ran);
}

/// `prog move FILE --from TIME --in-format FORMAT --bus ADDRESS`, which had other options once.
struct OldSpellings {
  OldSpellings() {
    move->add_option("FILE", file, "File")->required();
    move->add_option("--from", from, "Time");
    move->add_option("--in-format", format, "Format");
    move->add_option("--bus", bus, "Bus");
    move->add_old_spelling({.old = "--dcf", .now = ""});
    move->add_old_spelling({.old = "--start", .now = "--from"});
    move->add_old_spelling({.old = "--from", .now = "--in-format", .value = [](std::string_view value) {
                              return value == "csv" ? std::optional<std::string>(value) : std::nullopt;
                            }});
    move->add_old_spelling({.old = "", .now = "--bus", .value = [](std::string_view word) {
                              return word.contains(':') ? std::optional<std::string>(word) : std::nullopt;
                            }});
    move->callback([this] { hints_at_call = hints.size(); });
  }
  Parsing parse(const Words& words) {
    return parse_words(app, words, [this](std::string_view hint) { hints.emplace_back(hint); });
  }

  Command app{"Does things", "prog"};
  Command* move = app.add_subcommand("move", "Move");
  std::string file, from, format, bus;
  Words hints;
  std::size_t hints_at_call = 0;
};

TEST(OldSpelling, OfAnOption_IsTheNewOne_WithAHintBeforeTheCommandRuns) {
  OldSpellings program;
  EXPECT_EQ(program.parse({"move", "a", "--start", "2s"}).result, ran);
  EXPECT_EQ(program.from, "2s");
  EXPECT_THAT(program.hints,
              ElementsAre("prog move: --start is an old spelling, which the next release does not know; "
                          "expected \"--from=2s\""));
  EXPECT_EQ(program.hints_at_call, 1U);
  EXPECT_EQ(program.parse({"move", "a", "--start=3s"}).result, ran);
  EXPECT_EQ(program.from, "3s");
}

TEST(OldSpelling, OfAnOptionThatIsAnArgumentNow_FillsIt) {
  OldSpellings program;
  EXPECT_EQ(program.parse({"move", "--dcf", "network.toml"}).result, ran);
  EXPECT_EQ(program.file, "network.toml");
  EXPECT_THAT(program.hints, ElementsAre(HasSubstr("--dcf is an old spelling")));
}

TEST(OldSpelling, OfAnArgumentThatIsAnOptionNow_LeavesValuesOfOptionsAlone) {
  OldSpellings program;
  EXPECT_EQ(program.parse({"move", "a", "can:0"}).result, ran);
  EXPECT_EQ(program.bus, "can:0");
  program.hints.clear();
  EXPECT_EQ(program.parse({"move", "a", "--from", "12:30", "--bus", "can:1"}).result, ran);
  EXPECT_EQ(program.bus, "can:1");
  EXPECT_EQ(program.from, "12:30");
  EXPECT_THAT(program.hints, IsEmpty());
}

TEST(OldSpelling, WhoseNameMeansSomethingElseToday_DependsOnTheValue) {
  OldSpellings program;
  EXPECT_EQ(program.parse({"move", "a", "--from", "csv", "--from", "1s"}).result, ran);
  EXPECT_EQ(program.format, "csv");
  EXPECT_EQ(program.from, "1s");
  EXPECT_EQ(program.hints.size(), 1U);
}

TEST(OldSpelling, BehindTwoDashes_IsAnArgument) {
  OldSpellings program;
  EXPECT_EQ(program.parse({"move", "--", "--start"}).result, ran);
  EXPECT_EQ(program.file, "--start");
  EXPECT_THAT(program.hints, IsEmpty());
}

TEST(OldSpelling, IsInNoHelpAndNoCompletion) {
  OldSpellings program;
  EXPECT_THAT(program.parse({"move", "--help"}).text, Not(HasSubstr("--start")));
  EXPECT_THAT(completion_script(program.app, Shell::bash), Not(HasSubstr("--start")));
}

/// A command with an option of each kind.
struct Kinds {
  Kinds() {
    app.add_flag("--fast", fast, "Fast");
    app.add_flag("--text", text, "Text")->type_name("[TEXT]");
    app.add_option("--list", list, "List")->allow_extra_args(false);
    app.add_option("--number", number, "Number")->check(number_from(1, 9))->capture_default_str();
    app.add_option("--port", port, "Port");
    slow = app.add_flag_callback(
        "--slow", [this] { fast = false; }, "Slow");
    app.add_option_function(
        "--name", [](const std::string& name) { return name == "x" ? "there is no x" : std::string(); },
        "Name");
    app.add_option("FILE", file, "File");
    app.callback([this] { slow_given = slow->count(); });
  }
  Parsing parse(const Words& words) { return parse_words(app, words); }

  Command app{"Does things", "prog"};
  bool fast = false;
  std::string text, file;
  Words list;
  unsigned number = 3;
  std::optional<std::uint16_t> port;
  Option* slow = nullptr;
  std::size_t slow_given = 0;
};

TEST(CommandTable, Values_GetToTheirTargets) {
  Kinds program;
  EXPECT_EQ(program
                .parse({"--fast", "--text=a", "--list", "1", "file", "--list", "2", "--number", "4", "--port",
                        "5007"})
                .result,
            ran);
  EXPECT_TRUE(program.fast);
  EXPECT_EQ(program.text, "a");
  EXPECT_THAT(program.list, ElementsAre("1", "2"));
  EXPECT_EQ(program.number, 4U);
  EXPECT_EQ(program.port, 5007);
  EXPECT_EQ(program.file, "file");
  EXPECT_EQ(program.slow_given, 0U);
}

TEST(CommandTable, AFlagWithoutValue_GivesAStringTrue) {
  Kinds program;
  EXPECT_EQ(program.parse({"--text", "--slow"}).result, ran);
  EXPECT_EQ(program.text, "true");
  EXPECT_EQ(program.slow_given, 1U);
}

TEST(CommandTable, AFunction_SaysWhatIsWrongWithItsValue) {
  Kinds program;
  const Parsing parsing = program.parse({"--name", "x"});
  EXPECT_EQ(parsing.result, wrong);
  EXPECT_EQ(parsing.text, "--name: there is no x");
}

TEST(CommandTable, AWordThatNothingTakes_IsLeftOver) {
  Kinds program;
  const Parsing parsing = program.parse({"file", "more", "--nothing"});
  EXPECT_EQ(parsing.result, misfit);
  ASSERT_EQ(parsing.commands.size(), 1U);
  EXPECT_THAT(parsing.commands.front().left_over, ElementsAre("more", "--nothing"));
}

TEST(CommandTable, ARemovedOption_IsNoLongerExcluded) {
  Kinds program;
  program.app.get_option("--fast")->excludes(program.slow);
  program.app.remove_option(program.slow);
  EXPECT_EQ(program.app.get_option("--slow"), nullptr);
  EXPECT_THAT(help_of(program.app), Not(HasSubstr("Excludes")));
}

TEST(CommandTable, TheHelp_HasWhatAnOptionExcludesInTheOrderOfTheTable) {
  Kinds program;
  program.app.get_option("--fast")
      ->excludes(program.app.get_option("--port"))
      ->excludes(program.slow)
      ->excludes(program.app.get_option("--list"));
  EXPECT_THAT(help_of(program.app), HasSubstr("Excludes: --list --port --slow"));
}

TEST(CommandTable, TheHelp_ShowsACapturedDefault) {
  Kinds program;
  EXPECT_THAT(help_of(program.app), ContainsRegex("--number UINT(=3| \\[3\\])"));  // CLI11 2.1, 2.4
}

}  // namespace
}  // namespace canopus::cli::command_table_test
