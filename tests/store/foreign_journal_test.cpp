// A journal of a stranger, and one that a power cut left: what it names outside of its folder stays as it is, and looking
// writes nothing.

#include <array>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "canopus/store/change_sets.hpp"
#include "canopus/store/inner_path.hpp"

namespace canopus::store::foreign_journal_test {
namespace {

namespace fs = std::filesystem;

std::string number(std::uint64_t value, unsigned size) {
  std::string bytes;
  for (unsigned i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  return bytes;
}

std::string counted(const std::string& text) { return number(text.size(), 4) + text; }

std::string contents(const FileContents& files) {
  std::string bytes = number(files.size(), 4);
  for (const auto& [name, content] : files) {
    bytes += counted(name) + (content ? '\1' + counted(*content) : std::string(1, '\0'));
  }
  return bytes;
}

/// The state after the change has these checksums.
std::string record(const FileContents& before, std::uint32_t sum) {
  std::string bytes = counted("a change") + contents(before);
  for (std::size_t i = 0; i < before.size(); ++i) bytes += '\1' + number(sum, 4);
  return bytes;
}

std::uint32_t checksum(const std::string& text) {
  return crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string file_of(const std::string& body) {
  return std::string("CNPS\1\0\0\0", 8) + number(body.size(), 8) + number(checksum(body), 4) + body;
}

std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whatever is below a folder: names, kinds, contents, times of change.
std::map<std::string, std::string> listing(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path().parent_path(), folder) / entry.path().filename();
    if (entry.is_symlink()) {
      all[name] = "-> " + fs::read_symlink(entry.path()).string();
    } else {
      const auto time = std::to_string(fs::last_write_time(entry.path()).time_since_epoch().count());
      all[name] = time + (entry.is_directory() ? " folder" : " " + slurp(entry.path()));
    }
  }
  return all;
}

/// A project's folder, and somebody else's beside it.
class ForeignJournal : public testing::Test {
 protected:
  ForeignJournal() {
    fs::remove_all(top);
    fs::create_directories(project / ".canopus");
    fs::create_directories(victim);
    write(victim / "keep.txt", "precious");
    write(project / "a", "old a");
  }
  ~ForeignJournal() override { fs::remove_all(top); }

  static void write(const fs::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
  }
  void journal(const FileContents& pending, const std::vector<std::string>& records = {}) {
    std::string body = contents(pending) + number(records.size(), 4);
    for (const std::string& one : records) body += one;
    write(project / ".canopus" / "journal", file_of(body));
  }
  /// Looks, recovers, writes and takes back; each refused with these words, and nothing anywhere has changed.
  void expect_refused(const std::string& words) {
    const auto before = listing(top);
    const auto expect = [&](const auto& done) {
      ASSERT_FALSE(done);
      EXPECT_NE(done.error().find(words), std::string::npos) << done.error();
    };
    expect(ChangeSets(project).open_read_only());
    expect(ChangeSets(project).recover());
    expect(ChangeSets(project).write({{"a", "new"}}, "a change"));
    expect(ChangeSets(project).undo());
    EXPECT_EQ(listing(top), before);
  }

  const fs::path top = fs::path(testing::TempDir()) / "foreign-journal";
  const fs::path project = top / "project";
  const fs::path victim = top / "victim";
};

TEST_F(ForeignJournal, PendingNamesOutside_AreRefused_WithFileAndName) {
  const std::string absolute = (victim / "keep.txt").string();
  for (const std::string& name : std::array{std::string("../victim/keep.txt"), absolute,
                                            std::string("x/../../victim/keep.txt"), std::string("..")}) {
    journal({{name, "overwritten"}});
    expect_refused("project/.canopus/journal: \"" + name + "\" is not a path inside the folder");
    journal({{name, std::nullopt}});
    expect_refused("is not a path inside the folder");
  }
}

TEST_F(ForeignJournal, RecordsThatNameFilesOutside_AreRefused_BeforeAnythingIsTakenBack) {
  journal({}, {record({{"../victim/keep.txt", "overwritten"}}, checksum("precious"))});
  expect_refused("project/.canopus/journal: \"../victim/keep.txt\" is not a path inside the folder");
  journal({}, {record({{(victim / "keep.txt").string(), std::nullopt}}, checksum("precious"))});
  expect_refused("is not a path inside the folder");
}

TEST_F(ForeignJournal, ANameOfControlCharacters_IsRefused_AndShownWithoutThem) {
  journal({{"a\x1B[2J", "x"}});
  expect_refused("\"a?[2J\" is not a path inside the folder");
}

TEST_F(ForeignJournal, ALinkedFolder_IsNotWrittenThrough) {
  fs::create_symlink(victim, project / "dcf");
  journal({{"a", "new a"}, {"dcf/keep.txt", "overwritten"}});
  const auto before = listing(top);
  const auto done = ChangeSets(project).recover();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), (project / "dcf").string() +
                              ": is a symbolic link, which is not followed: expected a file or folder");
  EXPECT_EQ(listing(top), before);
}

TEST_F(ForeignJournal, Undo_DoesNotWriteThroughALinkedFolder) {
  fs::create_symlink(victim, project / "dcf");
  journal({}, {record({{"dcf/keep.txt", "overwritten"}}, checksum("precious"))});
  const auto before = listing(top);
  EXPECT_FALSE(ChangeSets(project).undo());
  EXPECT_EQ(listing(top), before);
}

TEST_F(ForeignJournal, ALinkedFile_IsNeitherReadNorWritten) {
  fs::create_symlink(victim / "keep.txt", project / "linked");
  ChangeSets sets(project);
  const auto read = sets.read("linked");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error(), (project / "linked").string() +
                              ": is a symbolic link, which is not followed: expected a file or folder");
  EXPECT_FALSE(sets.write({{"linked", "new"}}, "a change"));
  EXPECT_TRUE(fs::is_symlink(project / "linked"));
  EXPECT_FALSE(read_inner_file(project, "linked"));
  EXPECT_FALSE(read_inner_file(project, "../victim/keep.txt"));
  EXPECT_EQ(read_inner_file(project, "./a").value_or("?"), "old a");
}

TEST_F(ForeignJournal, ALinkedFolderOfRecords_IsNotUsed) {
  fs::remove_all(project / ".canopus");
  fs::create_symlink(victim, project / ".canopus");
  expect_refused("project/.canopus: is a symbolic link");
}

TEST_F(ForeignJournal, Looking_ShowsWhatWasBeforeTheChange_AndWritesNothing) {
  write(project / "b", "new b");  // the change got as far as this
  journal({{"a", "new a"}, {"b", "new b"}, {"c", "new c"}},
          {record({{"a", "old a"}, {"b", "old b"}, {"c", std::nullopt}}, 0)});
  const auto before = listing(top);
  ChangeSets sets(project);
  EXPECT_TRUE(sets.open_read_only().value_or(false));
  EXPECT_EQ(sets.read("a").value_or("?"), "old a");
  EXPECT_EQ(sets.read("b").value_or("?"), "old b");
  EXPECT_EQ(sets.read("c").value_or("?"), std::nullopt);
  EXPECT_EQ(listing(top), before);
  ASSERT_TRUE(ChangeSets(project).recover());
  EXPECT_EQ(slurp(project / "a"), "new a");
  EXPECT_EQ(slurp(project / "c"), "new c");
  EXPECT_FALSE(ChangeSets(project).open_read_only().value_or(true));
}

TEST_F(ForeignJournal, LookingAtAnUnfinishedUndo_ShowsWhatWasBeforeIt) {
  ASSERT_TRUE(ChangeSets(project).write({{"a", "second"}, {"b", "second"}}, "first"));
  ASSERT_TRUE(ChangeSets(project).write({{"a", "third"}, {"b", "third"}}, "second"));
  // A folder where the new content of b is to be written: the undo cannot end.
  fs::create_directories(project / "b.new" / "x");
  EXPECT_FALSE(ChangeSets(project).undo());
  EXPECT_EQ(slurp(project / "a"), "second");
  ChangeSets sets(project);
  EXPECT_TRUE(sets.open_read_only().value_or(false));
  EXPECT_EQ(sets.read("a").value_or("?"), "third");
  EXPECT_EQ(sets.read("b").value_or("?"), "third");
  fs::remove_all(project / "b.new");
  ASSERT_TRUE(ChangeSets(project).recover());
  EXPECT_EQ(slurp(project / "b"), "second");
}

TEST_F(ForeignJournal, PendingContentsWithoutARecord_AreNotShown) {
  journal({{"a", "new a"}});
  ChangeSets sets(project);
  EXPECT_TRUE(sets.open_read_only().value_or(false));
  EXPECT_EQ(sets.read("a").value_or("?"), "old a");
}

/// What a stranger may write into names and bytes.
rc::Gen<std::string> foreign_name() {
  return rc::gen::map(rc::gen::container<std::vector<std::string>>(
                          rc::gen::element<std::string>("..", "/", "../", "victim", "keep.txt", "linked", "a",
                                                        ".", "dcf", "", "/tmp", "\\", std::string(1, '\0'))),
                      [](const std::vector<std::string>& parts) {
                        std::string name;
                        for (const std::string& part : parts) name += part;
                        return name;
                      });
}

RC_GTEST_FIXTURE_PROP(ForeignJournal, WhateverTheJournalHolds_NothingOutsideChanges, ()) {
  fs::create_symlink(victim, project / "linked");
  const auto name = *foreign_name();
  const auto second = *foreign_name();
  FileContents files = {{name, "overwritten"}};
  if (*rc::gen::arbitrary<bool>()) files[second] = std::nullopt;
  std::string body = contents(files) + number(1, 4) + record({{second, "overwritten"}}, checksum("precious"));
  const auto flips = *rc::gen::container<std::vector<std::pair<std::size_t, std::uint8_t>>>(
      rc::gen::pair(rc::gen::inRange<std::size_t>(0, body.size()), rc::gen::arbitrary<std::uint8_t>()));
  if (*rc::gen::inRange(0, 3) == 0) {
    for (const auto& [at, value] : flips) body[at] = static_cast<char>(value);
  }
  write(project / ".canopus" / "journal", file_of(body));
  const auto before = listing(victim);
  const auto inside = listing(project);
  static_cast<void>(ChangeSets(project).open_read_only());
  RC_ASSERT(listing(project) == inside);
  static_cast<void>(ChangeSets(project).recover());
  static_cast<void>(ChangeSets(project).undo());
  RC_ASSERT(listing(victim) == before);
  RC_ASSERT(std::distance(fs::directory_iterator(top), fs::directory_iterator()) == 2);
}

}  // namespace
}  // namespace canopus::store::foreign_journal_test
