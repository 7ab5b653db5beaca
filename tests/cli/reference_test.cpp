// The commands as data, and the pages and scripts that are made from it. What shells and mandoc make of them:
// tests/interop/reference_checks.py.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/app/completion_script.hpp"
#include "canopus/cli/app/manual_page.hpp"
#include "canopus/cli/options/command.hpp"

namespace canopus::cli::reference_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A program with one group of commands, and with everything that is awkward in a description.
struct Program {
  Program() {
    app.set_help_flag("-h,--help", "Say it");
    Command* group = app.add_subcommand("bus", "What is on the bus");
    Command* send = group->add_subcommand("send", "Send a frame");
    send->add_option("FRAME", text, "As 181#0102, or a \\ and a 'quote'")->required();
    send->add_option("FILE", files, "More of them");
    send->add_option("-r,--rate", text, "How often: [fast] or not")
        ->type_name("RATE")
        ->check(one_of_words({"slow", "fast"}));
    send->add_flag("--quiet", flag, "Say nothing");
    send->footer(".A line that begins with a dot\n'and one with a quote");
  }
  Command app{"Does things", "prog"};
  std::string text;
  std::vector<std::string> files;
  bool flag = false;

  const Command& described() { return app; }
  const Command& send() { return *bus().find("send"); }
  const Command& bus() { return *app.find("bus"); }
};

TEST(CommandTable, NamesACommandByAllItsWords) {
  Program program;
  EXPECT_EQ(program.described().full_name(), "prog");
  EXPECT_EQ(program.send().full_name(), "prog bus send");
  EXPECT_EQ(program.send().name(), "send");
  EXPECT_EQ(program.described().usage(), "prog [OPTIONS] COMMAND");
  EXPECT_EQ(program.send().usage(), "prog bus send [OPTIONS] FRAME [FILE...]");
}

TEST(CommandTable, KnowsWhatAnOptionTakes) {
  Program program;
  const auto options = program.send().options();
  const auto rate = std::ranges::find_if(
      options, [](const auto& option) { return option.get().names().back() == "--rate"; });
  ASSERT_NE(rate, options.end());
  EXPECT_THAT(rate->get().names(), ElementsAre("-r", "--rate"));
  EXPECT_EQ(rate->get().value(), "RATE");
  EXPECT_THAT(rate->get().choices(), ElementsAre("slow", "fast"));
  EXPECT_FALSE(rate->get().is_several());
  const auto quiet = std::ranges::find_if(
      options, [](const auto& option) { return option.get().names().back() == "--quiet"; });
  ASSERT_NE(quiet, options.end());
  EXPECT_EQ(quiet->get().value(), "");
  EXPECT_THAT(quiet->get().choices(), IsEmpty());
  EXPECT_TRUE(program.send().arguments()[0].get().data().required);
  EXPECT_TRUE(program.send().arguments()[1].get().is_several());
}

TEST(ManualPage, PrintsEveryTextAsItIs) {
  Program program;
  const std::string page = manual_page(program.bus(), "1.2.3");
  EXPECT_THAT(page, HasSubstr(".TH prog\\-bus 1 \"\" \"canopus 1.2.3\""));
  EXPECT_THAT(page, HasSubstr("As 181#0102, or a \\e and a \\(aqquote\\(aq\n"));
  EXPECT_THAT(page, HasSubstr("\n\\&.A line that begins with a dot\n\\(aqand one with a quote\n"));
  EXPECT_THAT(page, HasSubstr("How often: [fast] or not; one of: slow, fast\n"));
}

TEST(ManualPage, TheProgramsOwnPageNamesThePagesOfItsCommands) {
  Program program;
  const std::string page = manual_page(program.described(), "1.2.3");
  EXPECT_THAT(page, HasSubstr("\\fBprog\\-bus\\fR(1)\nWhat is on the bus\n"));
  EXPECT_THAT(page, Not(HasSubstr("Send a frame")));
}

TEST(MarkdownPage, KeepsItsTablesWhole) {
  Program program;
  const std::string page = markdown_page(program.described());
  EXPECT_THAT(page, HasSubstr("\n### prog bus send\n\nSend a frame.\n"));
  EXPECT_THAT(page, HasSubstr("| `-r, --rate RATE` | How often: \\[fast\\] or not; one of: slow, fast |\n"));
  EXPECT_THAT(page, HasSubstr("| `FRAME` | As 181#0102, or a \\\\ and a 'quote' |\n"));
}

TEST(CompletionScript, QuotesWhatAShellWouldRead) {
  Program program;
  const Command& described = program.described();
  EXPECT_THAT(completion_script(described, Shell::fish),
              HasSubstr("-s r -l rate -x -a 'slow fast' -d 'How often: [fast] or not'"));
  EXPECT_THAT(completion_script(described, Shell::zsh),
              HasSubstr("'--rate[How often\\: (fast) or not]:RATE:(slow fast)'"));
  EXPECT_THAT(completion_script(described, Shell::bash),
              HasSubstr("prog/bus/send:--rate) echo 'slow fast' ;;\n"));
  EXPECT_EQ(shell_of("tcsh"), std::nullopt);
}

}  // namespace
}  // namespace canopus::cli::reference_test
