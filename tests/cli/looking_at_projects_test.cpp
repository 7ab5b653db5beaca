// Projects of a stranger, and those that a power cut left: looking writes nothing, and no file outside of the folder is read or
// written.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopus/cli/app/command_line.hpp"
#include "canopus/master/network_file.hpp"
#include "canopus/store/file_memory.hpp"
#include "canopus/store/folder_lock.hpp"

#include "paths.hpp"

namespace canopus::cli::looking_at_projects_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Said {
  int code;
  std::string out, error;
};

Said said(std::vector<std::string> words) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run_command_line(words);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// Whatever is below a folder: names, times of change, contents.
std::map<std::string, std::string> listing(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::string& what = all[entry.path().string()];
    if (entry.is_symlink()) {
      what = fs::read_symlink(entry.path()).string();
    } else {
      what = std::to_string(fs::last_write_time(entry.path()).time_since_epoch().count());
      if (entry.is_regular_file()) what += slurp(entry.path());
    }
  }
  return all;
}

std::string number(std::uint64_t value, unsigned size) {
  std::string bytes;
  for (unsigned i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  return bytes;
}
std::string counted(const std::string& text) { return number(text.size(), 4) + text; }
std::uint32_t checksum(const std::string& text) {
  return store::crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}
std::string file_of(const std::string& body) {
  return std::string("CNPS\1\0\0\0", 8) + number(body.size(), 8) + number(checksum(body), 4) + body;
}
std::string one_file(const std::string& name, const std::string& content) {
  return number(1, 4) + counted(name) + '\1' + counted(content);
}

class LookingAtProjects : public testing::Test {
 protected:
  LookingAtProjects() {
    fs::remove_all(top);
    fs::create_directories(top / "victim");
    write(top / "victim" / "keep.txt", "precious");
    EXPECT_EQ(said({"project", "new", line, "--name", "Line"}).code, 0);
    EXPECT_EQ(
        said({"project", "add", line, CANOPUS_SOURCE_DIR "/examples/devices/drive.eds", "--name", "drive"})
            .code,
        0);
  }
  ~LookingAtProjects() override { fs::remove_all(top); }

  [[nodiscard]] fs::path journal() const { return fs::path(line) / ".canopus" / "journal"; }
  /// A change of `name` that is about to be written.
  void leave_pending(const std::string& name, const std::string& before, const std::string& after) const {
    write(journal(), file_of(one_file(name, after) + number(1, 4) + counted("a change") +
                             one_file(name, before) + '\1' + number(checksum(after), 4)));
  }
  void leave_record(const fs::path& path, const std::string& name) const {
    write(path, file_of(number(0, 4) + number(1, 4) + counted("a change") + one_file(name, "overwritten") +
                        '\1' + number(checksum("precious"), 4)));
  }

  const fs::path top = fs::path(testing::TempDir()) / "looking-at-projects";
  const std::string line = (top / "line").string();
  const std::string list = line + "/nodelist.cpj";
};

TEST_F(LookingAtProjects, AJournalThatNamesFilesOutside_IsRefused_AndWritesNothing) {
  for (const std::string& name :
       {std::string("../victim/keep.txt"), (top / "victim" / "keep.txt").string()}) {
    leave_pending(name, "precious", "overwritten");
    const auto before = listing(top);
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"project", "show", line},
                                               {"project", "check", line},
                                               {"project", "pdo", "list", line},
                                               {"web", line, "--for", "1ms"}}) {
      const Said shown = said(words);
      EXPECT_EQ(shown.code, 3) << shown.error;
      EXPECT_THAT(shown.error,
                  HasSubstr(".canopus/journal: \"" + name + "\" is not a path inside the folder"));
      EXPECT_EQ(listing(top), before);
    }
  }
}

TEST_F(LookingAtProjects, Undo_DoesNotFollowRecordsOutside) {
  leave_record(journal(), "../victim/keep.txt");
  const Said undone = said({"project", "undo", line});
  EXPECT_EQ(undone.code, 3);
  EXPECT_THAT(undone.error, HasSubstr("\"../victim/keep.txt\" is not a path inside the folder"));
  EXPECT_EQ(slurp(top / "victim" / "keep.txt"), "precious");
}

TEST_F(LookingAtProjects, UndoOfSettings_DoesNotFollowRecordsOutside) {
  const std::string file = (top / "module.xml").string();
  write(file, "<x/>");
  const fs::path records = top / ".canopus" / "settings" / "module.xml";
  fs::create_directories(records);
  for (const std::string& name :
       {std::string("victim/../../keep.txt"), (top / "victim" / "keep.txt").string()}) {
    leave_record(records / "journal", name);
    const Said undone = said({"configure", "undo", file});
    EXPECT_NE(undone.code, 0);
    EXPECT_THAT(undone.error, HasSubstr("is not a path inside the folder"));
    EXPECT_EQ(slurp(top / "victim" / "keep.txt"), "precious");
  }
}

TEST_F(LookingAtProjects, ALinkedFolderOfSettingsRecords_IsNotWrittenInto) {
  const std::string file = (top / "module.xml").string();
  write(file, "<x/>");
  fs::create_symlink("victim", top / ".canopus");
  EXPECT_THAT(said({"configure", "undo", file}).error, HasSubstr(".canopus: is a symbolic link"));
  EXPECT_FALSE(fs::exists(top / "victim" / "settings"));
}

TEST_F(LookingAtProjects, AJournalOfAPowerCut_IsWarnedOf_AndTheProjectBeforeItIsShown) {
  const std::string old = slurp(list);
  std::string changed = old;
  changed.replace(changed.find("NetName=Line"), 12, "NetName=Hall");
  leave_pending("nodelist.cpj", old, changed);
  for (const std::string& on_disk : {old, changed}) {  // not begun, and half applied
    write(list, on_disk);
    const auto before = listing(top);
    const Said shown = said({"project", "show", line});
    EXPECT_EQ(shown.code, 0);
    EXPECT_THAT(shown.out, HasSubstr("Line"));
    EXPECT_THAT(shown.error, HasSubstr("the next command that changes the project finishes it first"));
    EXPECT_EQ(std::ranges::count(shown.error, '\n'), 1);
    EXPECT_EQ(listing(top), before);
  }
  write(list, old);
  ASSERT_EQ(said({"project", "note", line, "1", "spare"}).code, 0);
  EXPECT_EQ(slurp(list), changed);
  const Said shown = said({"project", "show", line});
  EXPECT_THAT(shown.out, HasSubstr("Hall"));
  EXPECT_EQ(shown.error, "");
}

TEST_F(LookingAtProjects, SettingsWithAJournalOfAPowerCut_AreShownAsBefore_WithAWarning) {
  const std::string file = (top / "module.xml").string();
  ASSERT_EQ(said({"configure", "new", file, "--module", "FX3U-CAN"}).code, 0);
  const std::string old = slurp(file);
  ASSERT_EQ(said({"configure", "set", file, "basic", "Node ID=77"}).code, 0);
  const std::string changed = slurp(file);
  ASSERT_NE(changed, old);
  const fs::path records = top / ".canopus" / "settings" / "module.xml";
  write(records / "journal", file_of(one_file("module.xml", changed) + number(1, 4) + counted("a change") +
                                     one_file("module.xml", old) + '\1' + number(checksum(changed), 4)));
  write(file, old);
  const std::string shown_before = said({"configure", "show", file}).out;
  for (const std::string& on_disk : {old, changed}) {  // not begun, and done but for the journal
    write(file, on_disk);
    const auto before = listing(top);
    for (const char* command : {"show", "check"}) {
      const Said shown = said({"configure", command, file});
      EXPECT_EQ(shown.error,
                "canopus configure: " + (records / "journal").string() +
                    ": a change is not finished (a power cut, or another command at work); this is the "
                    "project before it, and the next command that changes the project finishes it "
                    "first\n");
    }
    EXPECT_EQ(said({"configure", "show", file}).out, shown_before);
    EXPECT_EQ(listing(top), before);
  }
}

TEST_F(LookingAtProjects, AProjectThatIsAboutToBeMade_IsMadeByTheNextCommand) {
  const std::string whole = slurp(list);
  write(journal(), file_of(one_file("nodelist.cpj", whole) + number(1, 4) + counted("new") + number(1, 4) +
                           counted("nodelist.cpj") + '\0' + '\1' + number(checksum(whole), 4)));
  fs::remove(list);
  EXPECT_EQ(said({"project", "show", line}).code, 3);
  EXPECT_EQ(said({"project", "note", line, "1", "spare"}).code, 0);
  EXPECT_EQ(slurp(list), whole);
}

TEST_F(LookingAtProjects, AFolderThatMayNotBeWritten_IsShown_AndLockedByNothing) {
  fs::remove_all(fs::path(line) / ".canopus");
  const auto before = listing(top);
  fs::permissions(line, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(said({"project", "show", line}).code, 0);
  fs::permissions(line, fs::perms::owner_all);
  EXPECT_EQ(listing(top), before);
}

TEST_F(LookingAtProjects, Show_GoesOnBesideACommandThatChangesTheProject) {
  const auto lock = store::FolderLock::acquire(fs::path(line) / ".canopus");
  ASSERT_TRUE(lock);
  EXPECT_EQ(said({"project", "show", line}).code, 0);
  EXPECT_NE(said({"project", "note", line, "1", "spare"}).code, 0);
}

TEST_F(LookingAtProjects, ADcfThatIsALink_IsNotRead) {
  const fs::path dcf = fs::path(line) / "drive.dcf";
  ASSERT_TRUE(fs::exists(dcf));
  fs::rename(dcf, top / "victim" / "drive.dcf");
  fs::create_symlink("../victim/drive.dcf", dcf);
  EXPECT_THAT(said({"project", "check", line}).out, HasSubstr("is a symbolic link, which is not followed"));
  const fs::path plant = top / "plant.toml";
  write(plant, "[[bus]]\nname = \"b\"\nbit_rate = 500_000\nproject = \"line/nodelist.cpj\"\n");
  EXPECT_THAT(said({"check", plant.string()}).error, HasSubstr("is a symbolic link, which is not followed"));
  const auto network = master::read_project(list);
  ASSERT_FALSE(network.errors.empty());
  EXPECT_THAT(network.errors.front().message, HasSubstr("is a symbolic link, which is not followed"));
}

}  // namespace
}  // namespace canopus::cli::looking_at_projects_test
