// The walls of the house: docs/architecture.md has a table of the rooms and of what each may see. The sources
// and CMakeLists.txt are compared with it.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "paths.hpp"

namespace canopus::rooms {
namespace {

namespace fs = std::filesystem;

using Rooms = std::map<std::string, std::set<std::string>>;  // room, or folder of one -> what it sees

const fs::path source = CANOPUS_SOURCE_DIR;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::set<std::string> words_in_backquotes(const std::string& text) {
  static const std::regex word("`([^`]+)`");
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), word), end; match != end; ++match) {
    found.insert((*match)[1]);
  }
  return found;
}

/// The rows "| `room` | what | sees |" of the picture.
Rooms picture() {
  static const std::regex row(R"(^\| `([a-z0-9_/]+)` \|[^|]*\|([^|]*)\|$)");
  Rooms rooms;
  std::istringstream text(text_of(source / "docs/architecture.md"));
  for (std::string line; std::getline(text, line);) {
    std::smatch match;
    if (std::regex_match(line, match, row)) rooms[match[1]] = words_in_backquotes(match[2]);
  }
  return rooms;
}

/// The folder of `path` below canopus/, as the picture names it.
std::string folder_of(const std::string& path) { return fs::path(path).parent_path().generic_string(); }

std::string room_of(const std::string& folder) { return folder.substr(0, folder.find('/')); }

/// Every file of the house and what it includes of it, both relative to canopus/.
std::map<std::string, std::set<std::string>> includes() {
  static const std::regex include(R"re(^#include "canopus/([^"]+)")re");
  std::map<std::string, std::set<std::string>> all;
  for (const auto& entry : fs::recursive_directory_iterator(source / "canopus")) {
    const std::string extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    auto& found = all[fs::relative(entry.path(), source / "canopus").generic_string()];
    std::istringstream text(text_of(entry.path()));
    for (std::string line; std::getline(text, line);) {
      std::smatch match;
      if (std::regex_search(line, match, include)) found.insert(match[1]);
    }
  }
  return all;
}

TEST(Rooms, APictureOfTheHouse_HasEveryFolder) {
  const Rooms rooms = picture();
  std::set<std::string> folders;
  for (const auto& [file, found] : includes()) folders.insert(folder_of(file));
  for (const std::string& folder : folders) EXPECT_TRUE(rooms.contains(folder)) << folder;
  for (const auto& [room, sees] : rooms) EXPECT_TRUE(folders.contains(room)) << room << " is not there";
}

TEST(Rooms, AnInclude_CrossesNoWallThatThePictureDoesNotOpen) {
  const Rooms rooms = picture();
  for (const auto& [file, found] : includes()) {
    const std::string folder = folder_of(file);
    const auto row = rooms.find(folder);
    if (row == rooms.end()) continue;
    for (const std::string& included : found) {
      const std::string other = folder_of(included);
      EXPECT_TRUE(other == folder || row->second.contains(other))
          << "canopus/" << file << " includes \"canopus/" << included << "\": " << folder << " does not see "
          << other;
    }
  }
}

TEST(Rooms, ThePicture_OpensNoWallThatNobodyUses) {
  Rooms used;
  for (const auto& [file, found] : includes()) {
    for (const std::string& included : found) used[folder_of(file)].insert(folder_of(included));
  }
  for (const auto& [room, sees] : picture()) {
    for (const std::string& other : sees) EXPECT_TRUE(used[room].contains(other)) << room << " -> " << other;
  }
}

TEST(Rooms, Arrows_MakeNoCircle) {
  Rooms left = picture();
  for (bool removed = true; removed;) {
    removed = false;
    for (auto room = left.begin(); room != left.end(); ++room) {
      const bool sees_another =
          std::ranges::any_of(room->second, [&](const std::string& other) { return left.contains(other); });
      if (sees_another) continue;
      left.erase(room);
      removed = true;
      break;
    }
  }
  for (const auto& [room, sees] : left) ADD_FAILURE() << room << " is in a circle, or sees one";
}

/// canopus_room(NAME ROOMS a b LIBRARIES ...) of CMakeLists.txt.
Rooms cmake_rooms() {
  static const std::regex call(R"(canopus_room\(([a-z0-9_]+)([^)]*)\))");
  const std::string text = text_of(source / "CMakeLists.txt");
  Rooms rooms;
  for (std::sregex_iterator match(text.begin(), text.end(), call), end; match != end; ++match) {
    auto& sees = rooms[(*match)[1]];
    std::istringstream words((*match)[2]);
    bool naming_rooms = false;
    for (std::string word; words >> word;) {
      if (word == "ROOMS" || word == "LIBRARIES" || word == "PRIVATE_LIBRARIES") {
        naming_rooms = word == "ROOMS";
      } else if (naming_rooms) {
        sees.insert(word);
      }
    }
  }
  return rooms;
}

TEST(Rooms, CMake_HasTheRoomsAndArrowsOfThePicture) {
  Rooms rooms;
  for (const auto& [folder, sees] : picture()) {
    auto& room = rooms[room_of(folder)];
    for (const std::string& other : sees) {
      if (room_of(other) != room_of(folder)) room.insert(room_of(other));
    }
  }
  EXPECT_EQ(cmake_rooms(), rooms);
}

// What comes from a stranger is bounded in depth and size where its text is parsed, once for each library.
TEST(Rooms, ParserOfALibrary_IsCalledInOneFileAlone) {
  const std::multimap<std::string, std::string> parsers{
      {"text/toml.cpp", "toml::parse("},       {"text/toml.cpp", "toml::parse_file("},
      {"text/json_library.cpp", "nlohmann/"},  {"eds/xml/document.cpp", ".load_buffer"},
      {"eds/xml/document.cpp", ".load_file("}, {"eds/xml/document.cpp", ".load_string("},
  };
  for (const auto& [file, found] : includes()) {
    const std::string text = text_of(source / "canopus" / file);
    for (const auto& [only, call] : parsers)
      EXPECT_TRUE(file == only || !text.contains(call)) << file << " parses as " << only << " does";
  }
}

}  // namespace
}  // namespace canopus::rooms
