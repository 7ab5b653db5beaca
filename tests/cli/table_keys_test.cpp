// The keys of the live table: what terminals send for them, and what they do.

#include "canopus/cli/run/table_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canopus::cli::table_keys_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Key = TableKey;

TEST(TableKeys, AreRead_HoweverTerminalsSendThem) {
  EXPECT_THAT(keys_in("\x1b[A\x1b[B\x1b[5~\x1b[6~\x1b[H\x1b[F"),
              ElementsAre(Key::up, Key::down, Key::page_up, Key::page_down, Key::home, Key::end));
  EXPECT_THAT(keys_in("\x1bOA\x1bOB\x1bOH\x1bOF"), ElementsAre(Key::up, Key::down, Key::home, Key::end));
  EXPECT_THAT(keys_in("\x1b[1~\x1b[4~\x1b[7~\x1b[8~"), ElementsAre(Key::home, Key::end, Key::home, Key::end));
  EXPECT_THAT(keys_in("\x1b[1;5A\x1b[6;2~"), ElementsAre(Key::up, Key::page_down)) << "with Ctrl, with Shift";
  EXPECT_THAT(keys_in("q?"), ElementsAre(Key::quit, Key::help));
}

TEST(TableKeys, OthersAreLeftOut) {
  EXPECT_THAT(keys_in("ab\x1b[3~\x1b[15~\x1b[200~\x1b[?1;2c\x1b[<0;1;1M \r\n\xC3\xA4\x1bq"), IsEmpty());
  EXPECT_THAT(keys_in("\x1b"), IsEmpty()) << "Esc alone";
  EXPECT_THAT(keys_in("\x1b["), IsEmpty());
  EXPECT_THAT(keys_in("\x1bO"), IsEmpty());
  EXPECT_THAT(keys_in("\x1b[1;"), IsEmpty());
  EXPECT_THAT(keys_in("\x1b[5~q"), ElementsAre(Key::page_up, Key::quit));
}

TEST(TableKeys, ScrollWithinTheTable) {
  const auto first_after = [](std::size_t first, Key key) {
    const TablePicture shown{.lines = {}, .first = first, .last = 100, .page = 12};
    return after_key({.first = first}, key, shown).first;
  };
  EXPECT_EQ(first_after(0, Key::up), 0U);
  EXPECT_EQ(first_after(0, Key::down), 1U);
  EXPECT_EQ(first_after(5, Key::page_up), 0U);
  EXPECT_EQ(first_after(50, Key::page_up), 38U);
  EXPECT_EQ(first_after(50, Key::page_down), 62U);
  EXPECT_EQ(first_after(95, Key::page_down), 100U);
  EXPECT_EQ(first_after(100, Key::down), 100U);
  EXPECT_EQ(first_after(50, Key::home), 0U);
  EXPECT_EQ(first_after(50, Key::end), 100U);
  EXPECT_TRUE(after_key({}, Key::help, {}).help);
  EXPECT_FALSE(after_key({.help = true}, Key::help, {}).help);
}

}  // namespace
}  // namespace canopus::cli::table_keys_test
