// Several files changed together, taken back, and cut off in the middle.

#include "canopus/store/change_sets.hpp"

#include <gtest/gtest.h>

#include "store/cut_files.hpp"

namespace canopus::store::change_sets_test {
namespace {

const std::filesystem::path folder = "line";
using Text = std::optional<std::string>;

struct Disk {
  CutFiles files;
  Disk() { EXPECT_EQ(files.make_folder(folder), 0); }
  Text operator[](const std::string& name) {
    const auto* content = files.content(folder / name);
    return content == nullptr ? Text() : Text(std::string(content->begin(), content->end()));
  }
  void write(const FileContents& contents, std::string_view title = "a change") {
    const auto done = ChangeSets(folder, files).write(contents, title);
    EXPECT_TRUE(done) << done.error();
  }
  Text undo() {
    const auto title = ChangeSets(folder, files).undo();
    EXPECT_TRUE(title) << title.error();
    return title.value_or(std::nullopt);
  }
};

TEST(ChangeSets, Files_AreWrittenMadeAndTakenAway) {
  Disk disk;
  disk.write({{"a", "1"}, {"dcf/b", "2"}});
  EXPECT_EQ(disk["a"], "1");
  EXPECT_EQ(disk["dcf/b"], "2");
  disk.write({{"a", std::nullopt}, {"dcf/b", "3"}});
  EXPECT_EQ(disk["a"], std::nullopt);
  EXPECT_EQ(disk["dcf/b"], "3");
}

TEST(ChangeSets, Undo_TakesBackOneChangeAfterTheOther) {
  Disk disk;
  disk.write({{"a", "1"}, {"b", "2"}}, "make a and b");
  disk.write({{"a", "3"}}, "change a");
  disk.write({{"a", std::nullopt}, {"c", "4"}}, "a becomes c");
  EXPECT_EQ(disk.undo(), "a becomes c");
  EXPECT_EQ(disk["a"], "3");
  EXPECT_EQ(disk["c"], std::nullopt);
  EXPECT_EQ(disk.undo(), "change a");
  EXPECT_EQ(disk["a"], "1");
  EXPECT_EQ(disk["b"], "2");
  EXPECT_EQ(disk.undo(), "make a and b");
  EXPECT_EQ(disk["a"], std::nullopt);
  EXPECT_EQ(disk["b"], std::nullopt);
  EXPECT_EQ(disk.undo(), std::nullopt);
}

TEST(ChangeSets, WhatIsAsItShouldBe_IsNoChange) {
  Disk disk;
  disk.write({{"a", "1"}}, "make a");
  disk.write({{"a", "1"}, {"b", std::nullopt}}, "nothing");
  EXPECT_EQ(disk.undo(), "make a");
}

TEST(ChangeSets, Undo_LeavesWhatSomebodyElseHasChanged) {
  Disk disk;
  disk.write({{"a", "1"}, {"b", "1"}}, "make both");
  *disk.files.content(folder / "b") = {'2'};
  const auto title = ChangeSets(folder, disk.files).undo();
  ASSERT_FALSE(title);
  EXPECT_EQ(title.error(),
            "line/b: has been changed since \"make both\", which can therefore not be taken back");
  EXPECT_EQ(disk["a"], "1");
  EXPECT_EQ(disk["b"], "2");
  *disk.files.content(folder / "b") = {'1'};
  EXPECT_EQ(disk.undo(), "make both");
}

TEST(ChangeSets, TheLatestFifty_AreKept) {
  Disk disk;
  for (int i = 0; i < 60; ++i) disk.write({{"a", std::to_string(i)}});
  unsigned taken_back = 0;
  while (disk.undo()) ++taken_back;
  EXPECT_EQ(taken_back, 50U);
  EXPECT_EQ(disk["a"], "9");
}

TEST(ChangeSets, MoreThanEightMegabytesBefore_AreDropped_ButNotTheLatest) {
  Disk disk;
  disk.write({{"small", "1"}});
  disk.write({{"big", std::string(9 << 20, 'x')}});
  disk.write({{"big", "small now"}}, "make it small");
  EXPECT_EQ(disk.undo(), "make it small");
  EXPECT_EQ(disk["big"]->size(), 9U << 20);
  EXPECT_EQ(disk.undo(), std::nullopt);
}

TEST(ChangeSets, ADamagedJournal_IsSaid_AndNothingIsWritten) {
  Disk disk;
  disk.write({{"a", "1"}});
  disk.files.content(folder / ".canopus" / "journal")->back() ^= 1;
  const auto done = ChangeSets(folder, disk.files).write({{"a", "2"}}, "another");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), "line/.canopus/journal: is damaged (length or checksum)");
  EXPECT_EQ(disk["a"], "1");
}

TEST(ChangeSets, WhatCannotBeWrittenWhole_IsNotWrittenAtAll) {
  const std::filesystem::path real = std::filesystem::path(testing::TempDir()) / "change-sets";
  std::filesystem::remove_all(real);
  ASSERT_TRUE(std::filesystem::create_directory(real));
  ChangeSets sets(real);
  ASSERT_TRUE(sets.write({{"a", "1"}}, "make a"));
  const auto done = sets.write({{"0", "first"}, {"a/b", "in a file"}}, "impossible");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), (real / "a/b").string() + ": Not a directory");
  EXPECT_EQ(sets.read("0").value_or("?"), std::nullopt);
  EXPECT_EQ(sets.read("a").value_or("?"), "1");
  EXPECT_TRUE(sets.recover());
  EXPECT_EQ(sets.undo().value_or("?"), "make a");
  std::filesystem::remove_all(real);
}

/// The power goes off at every call and byte of `change`; afterwards the files are all old or all new.
template <typename Change>
void cut_everywhere(Change change, const FileContents& before, const FileContents& after) {
  bool done = false;
  unsigned old = 0;
  for (std::uint64_t cut = 0; !done; ++cut) {
    for (unsigned round = 0; round < 10; ++round) {
      Disk disk;
      std::mt19937 random(static_cast<unsigned>(cut) * 10 + round);
      disk.write(before, "before");
      done = false;
      disk.files.cut_after(cut);
      try {
        change(disk);
        done = true;
      } catch (const PowerCut&) {
      }
      disk.files.power_back(random);
      const auto recovered = ChangeSets(folder, disk.files).recover();
      ASSERT_TRUE(recovered) << recovered.error() << ", cut after " << cut;
      const bool is_old = disk["a"] == before.at("a");
      old += is_old ? 1 : 0;
      ASSERT_FALSE(is_old && done);
      for (const auto& [name, content] : is_old ? before : after) {
        ASSERT_EQ(disk[name], content) << name << ", cut after " << cut;
      }
      disk.write({{"a", "the next one"}});
      ASSERT_EQ(disk["a"], "the next one");
    }
  }
  EXPECT_GT(old, 0U);
}

TEST(ChangeSets, PowerCut_LeavesAllFilesOldOrAllNew) {
  const FileContents before = {{"a", "old"}, {"b", "old too"}, {"c", std::nullopt}};
  const FileContents after = {{"a", "new"}, {"b", std::nullopt}, {"c", "new too"}};
  cut_everywhere([&](Disk& disk) { disk.write(after); }, before, after);
}

TEST(ChangeSets, PowerCutOfAnUndo_LeavesAllFilesOldOrAllNew) {
  const FileContents first = {{"a", "1"}, {"b", "1"}};
  const FileContents none = {{"a", std::nullopt}, {"b", std::nullopt}};
  cut_everywhere([](Disk& disk) { disk.undo(); }, first, none);
}

}  // namespace
}  // namespace canopus::store::change_sets_test
