// The walls between folders: cmake/walls.txt names for each folder of canopus/ the folders that it may include
// from. The includes, CMakeLists.txt and the table of rooms in docs/architecture.md are compared with it.

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

/// The lines "folder: seen seen ..." of cmake/walls.txt.
Rooms walls() {
  Rooms rooms;
  std::istringstream text(text_of(source / "cmake/walls.txt"));
  for (std::string line; std::getline(text, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with('#') || colon == std::string::npos) continue;
    auto& sees = rooms[line.substr(0, colon)];
    std::istringstream words(line.substr(colon + 1));
    for (std::string word; words >> word;) sees.insert(word);
  }
  return rooms;
}

/// The folder of `path` below canopus/, as cmake/walls.txt names it.
std::string folder_of(const std::string& path) { return fs::path(path).parent_path().generic_string(); }

std::string room_of(const std::string& folder) { return folder.substr(0, folder.find('/')); }

/// Every header and source of canopus/, and what it includes of them, both relative to canopus/.
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

TEST(Rooms, TheListOfWalls_HasEveryFolder) {
  const Rooms rooms = walls();
  std::set<std::string> folders;
  for (const auto& [file, found] : includes()) folders.insert(folder_of(file));
  for (const std::string& folder : folders) EXPECT_TRUE(rooms.contains(folder)) << folder;
  for (const auto& [room, sees] : rooms) EXPECT_TRUE(folders.contains(room)) << room << " is not there";
}

TEST(Rooms, AnInclude_CrossesNoWallThatTheListDoesNotOpen) {
  const Rooms rooms = walls();
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

TEST(Rooms, TheListOfWalls_OpensNoneThatNoIncludeUses) {
  Rooms used;
  for (const auto& [file, found] : includes()) {
    for (const std::string& included : found) used[folder_of(file)].insert(folder_of(included));
  }
  for (const auto& [room, sees] : walls()) {
    for (const std::string& other : sees) EXPECT_TRUE(used[room].contains(other)) << room << " -> " << other;
  }
}

TEST(Rooms, Arrows_MakeNoCircle) {
  Rooms left = walls();
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

TEST(Rooms, CMake_HasTheRoomsAndArrowsOfTheListOfWalls) {
  Rooms rooms;
  for (const auto& [folder, sees] : walls()) {
    auto& room = rooms[room_of(folder)];
    for (const std::string& other : sees) {
      if (room_of(other) != room_of(folder)) room.insert(room_of(other));
    }
  }
  EXPECT_EQ(cmake_rooms(), rooms);
}

/// The rows "| `room` | what it is |" of the table of rooms.
TEST(Rooms, ArchitecturePage_HasARowForEachRoomOfCMake) {
  const std::string page = text_of(source / "docs/architecture.md");
  for (const auto& [room, sees] : cmake_rooms()) {
    EXPECT_TRUE(page.contains("\n| `" + room + "` |"))
        << "docs/architecture.md, Rooms: " << room << " is missing";
  }
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
