// Errors and warnings of a run with a table: kept, printed once, bounded.

#include "canopus/cli/run/run_messages.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/run/live_table.hpp"
#include "canopus/cli/run/screen.hpp"
#include "canopus/plant/event.hpp"
#include "canopus/text/file_error.hpp"

namespace canopus::cli::run_messages_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

TEST(RunMessages, ArePrintedAsWithoutATable_ButNotTwice) {
  RunMessages messages;
  messages.add({can::Time{}, "plant.toml:3:1: warning: nobody sends", false, true});
  messages.add({can::Time{1500ms}, "real time: the plant is 60.0 ms late", true});
  EXPECT_EQ(messages.errors(), 1U);
  EXPECT_EQ(messages.warnings(), 1U);
  EXPECT_EQ(messages.latest(5).size(), 2U);
  TextOutput out;
  messages.print(out);
  EXPECT_EQ(out.text(), "    1.500000  real time: the plant is 60.0 ms late\n");
}

TEST(RunMessages, OfVeryMany_TheFirstAndTheLatestAreKept) {
  RunMessages messages;
  for (int i = 0; i < 100'000; ++i) messages.add({can::Time{}, fmt::format("error {}!", i)});
  EXPECT_EQ(messages.errors(), 100'000U);
  EXPECT_EQ(messages.latest(2).back().text, "error 99999!");
  TextOutput out;
  messages.print(out);
  EXPECT_THAT(out.text(), HasSubstr("  error 99!\n              ... 99500 more here, which were not kept\n"));
  EXPECT_THAT(out.text(), HasSubstr("  error 99600!\n"));
  EXPECT_THAT(out.text(), Not(HasSubstr("  error 99599!\n")));
}

TEST(RunMessages, WhereErrorsGoToAFile_TheyAreThereAtOnce) {
  plant::Plant* plant = nullptr;
  TextOutput file;
  LiveTable table(plant, &file);
  table.on({can::Time{1s}, plant::Failure{"real time", "late"}});
  EXPECT_EQ(file.text(), "    1.000000  real time: late\n");
  TextOutput end;
  table.messages().print(end);
  EXPECT_EQ(end.text(), "");
}

TEST(Screen, EachLineIsPut_NoneIsWrittenBehindTheLastColumn) {
  const std::vector<TableLine> lines{{{"ab", TableStyle::error}, {"c"}}, {{"1234"}}};
  EXPECT_EQ(drawn(lines, {3, 4}, false), "\x1b[1;1Habc\x1b[K\x1b[2;1H1234\x1b[3;1H\x1b[J");
  EXPECT_EQ(drawn(lines, {2, 4}, true), "\x1b[1;1H\x1b[31mab\x1b[0mc\x1b[K\x1b[2;1H1234");
  EXPECT_THAT(drawn({{{"x\x1b[2J"}}}, {2, 40}, true), Not(HasSubstr("\x1b[2J")));
}

}  // namespace
}  // namespace canopus::cli::run_messages_test
