#include "canopus/store/inner_path.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "canopus/ascii/words.hpp"

namespace canopus::store {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

/// For messages: the name of a stranger must not control a terminal, nor fill it.
std::string shown(std::string_view name) {
  constexpr std::size_t longest = 200;
  std::string text(name.substr(0, longest));
  std::ranges::replace_if(text, is_control, '?');
  return name.size() > longest ? text + "..." : text;
}

}  // namespace

std::expected<void, std::string> check_inner_name(std::string_view name) {
  bool is_inside = !name.empty() && name.front() != '/' && std::ranges::none_of(name, is_control);
  for (std::size_t at = 0; is_inside && at <= name.size();) {
    const std::size_t end = std::min(name.find('/', at), name.size());
    is_inside = name.substr(at, end - at) != "..";
    at = end + 1;
  }
  if (is_inside) return {};
  return std::unexpected("\"" + shown(name) + "\" is not a path inside the folder");
}

std::expected<void, std::string> check_inner_path(Files& files, const std::filesystem::path& folder,
                                                  std::string_view name) {
  if (auto good = check_inner_name(name); !good) {
    return std::unexpected(folder.string() + ": " + good.error());
  }
  std::filesystem::path path = folder;
  for (const std::filesystem::path& part : std::filesystem::path(name)) {
    path /= part;
    if (files.is_link(path)) {
      return std::unexpected(path.string() +
                             ": is a symbolic link, which is not followed: expected a file or folder");
    }
  }
  return {};
}

std::expected<std::string, std::string> read_inner_file(const std::filesystem::path& folder,
                                                        std::string_view name) {
  constexpr std::size_t longest = 64 << 20;
  if (auto good = check_inner_path(real_files(), folder, name); !good) {
    return std::unexpected(std::move(good.error()));
  }
  const auto bytes = real_files().read(folder / name, longest);
  if (bytes) return std::string(bytes->begin(), bytes->end());
  return std::unexpected("cannot read " + (folder / name).string() + ": " + describe_error(bytes.error()));
}

std::optional<std::string> find_inner_file(const std::filesystem::path& folder, std::string_view name) {
  namespace fs = std::filesystem;
  constexpr std::size_t most_entries = 10'000;
  if (!check_inner_name(name)) return std::nullopt;
  fs::path found;
  for (const fs::path& part : fs::path(name)) {
    std::error_code error;
    fs::directory_iterator entry(folder / found, error);
    std::vector<fs::path> alike;
    for (std::size_t count = 0; !error && entry != fs::directory_iterator() && count < most_entries;
         ++count) {
      const fs::path own = entry->path().filename();
      if (own == part) alike.assign(1, own);
      if (own == part) break;
      if (ascii::equal_ignoring_case(own.string(), part.string())) alike.push_back(own);
      entry.increment(error);
    }
    if (alike.size() != 1) return std::nullopt;
    found /= alike.front();
  }
  return found.generic_string();
}

}  // namespace canopus::store
