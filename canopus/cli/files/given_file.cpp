#include "canopus/cli/files/given_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* plant_of_folder = "plant.toml";
constexpr const char* list_of_folder = "nodelist.cpj";

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// A network file has slaves where a plant has buses.
FileKind kind_of_tables(const std::string& text) {
  FileKind kind = FileKind::unknown;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view word = std::string_view(line).substr(0, line.find(']'));
    if (word == "[[bus" || word == "[plant" || word == "[[plc") return FileKind::plant;
    if (word == "[[slave" || word == "[master") kind = FileKind::network;
  }
  return kind;
}

FileKind kind_of_toml(const std::string& path) {
  const auto text = text::read_file(path);
  return text ? kind_of_tables(*text) : FileKind::unknown;
}

FileKind kind_of_folder(const fs::path& folder) {
  if (is_there(folder / plant_of_folder)) return FileKind::plant;
  return is_there(folder / list_of_folder) ? FileKind::project : FileKind::folder;
}

}  // namespace

FileKind kind_of_file(const std::string& path) {
  constexpr auto device_files = std::to_array<std::string_view>({".eds", ".dcf", ".xdd", ".xdc"});
  constexpr auto traces =
      std::to_array<std::string_view>({".log", ".pcap", ".pcapng", ".asc", ".trc", ".csv", ".blf"});
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return kind_of_folder(path);
  const std::string extension = ascii::lower(fs::path(path).extension().string());
  if (extension == ".toml") return kind_of_toml(path);
  if (extension == ".cpj") return FileKind::project;
  if (extension == ".xml") return FileKind::module_project;
  if (std::ranges::find(device_files, extension) != device_files.end()) return FileKind::device_file;
  return std::ranges::find(traces, extension) != traces.end() ? FileKind::trace : FileKind::unknown;
}

std::string describe_given_file(const std::string& path, FileKind kind) {
  switch (kind) {
    case FileKind::plant:
      return fmt::format("{0} is a plant file; `canopus run {0}` runs it, `canopus check {0}` checks it",
                         path);
    case FileKind::network:
      return fmt::format("{0} is a network file for a master without a PLC; `canopus master {0}` boots it",
                         path);
    case FileKind::device_file:
      return fmt::format(
          "{0} is a device file; `canopus eds show {0}` shows it, `canopus new FOLDER --device {0}` writes a "
          "plant with it",
          path);
    case FileKind::project:
      return fmt::format(
          "{0} is a project of CiA 306; `canopus web {0}` simulates its nodes, `canopus project check {0}` "
          "checks it",
          path);
    case FileKind::module_project:
      return fmt::format(
          "{0} is a project of module settings; `canopus web {0}` shows it, `canopus configure check {0}` "
          "checks it",
          path);
    case FileKind::trace:
      return fmt::format("{0} is a trace; `canopus trace show {0}` shows it, `canopus replay {0}` sends it",
                         path);
    case FileKind::unknown: return path;
    case FileKind::folder: break;
  }
  return fmt::format(
      "{} is a folder with neither a {} nor a {}; `canopus new {} --module MODEL` writes a plant", path,
      plant_of_folder, list_of_folder, path);
}

GivenPlant given_plant(const std::string& path) {
  std::error_code ignored;
  const FileKind kind = kind_of_file(path);
  if (kind == FileKind::unknown) return {.path = path};
  if (kind != FileKind::plant) return {.path = path, .wrong = describe_given_file(path, kind)};
  if (!fs::is_directory(path, ignored)) return {.path = path};
  return {.path = (fs::path(path) / plant_of_folder).lexically_normal().string()};
}

}  // namespace canopus::cli
