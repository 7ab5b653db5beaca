#include "canopus/web/http/page_files.hpp"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::web {
namespace {

namespace fs = std::filesystem;

struct Type {
  std::string_view ending;
  std::string_view content_type;
};

constexpr std::array types{
    Type{".html", "text/html; charset=utf-8"},
    Type{".css", "text/css; charset=utf-8"},
    Type{".js", "text/javascript; charset=utf-8"},
    Type{".svg", "image/svg+xml"},
    Type{".png", "image/png"},
    Type{".woff2", "font/woff2"},
    Type{".json", "application/json"},
    Type{".txt", "text/plain; charset=utf-8"},
};

/// Empty: that is no name of a file of a page.
std::string_view type_of(std::string_view name) {
  const auto is_allowed = [](char letter) {
    return ascii::is_letter(letter) || ascii::is_digit(letter) || std::string_view("._-").contains(letter);
  };
  if (name.starts_with('.') || !std::ranges::all_of(name, is_allowed)) return {};
  const auto type = std::ranges::find_if(types, [&](const Type& one) { return name.ends_with(one.ending); });
  return type == types.end() ? std::string_view() : type->content_type;
}

/// FNV-1a, 64 bits: it distinguishes the builds of a file, and protects nothing.
std::string tag_of(std::string_view content) {
  std::uint64_t hash = 0xCBF2'9CE4'8422'2325;
  for (const char byte : content) {
    hash ^= static_cast<unsigned char>(byte);
    hash *= 0x100'0000'01B3;
  }
  return fmt::format("\"{:016x}\"", hash);
}

}  // namespace

bool PageFiles::add(const std::string& name, std::string content) {
  const std::string_view type = type_of(name);
  if (type.empty()) return false;
  PageFile file{.content_type = type, .tag = tag_of(content)};
  file.content = std::make_shared<const std::string>(std::move(content));
  files_.insert_or_assign('/' + name, std::move(file));
  return true;
}

const PageFile* PageFiles::find(std::string_view path) const noexcept {
  const auto file = files_.find(path == "/" ? std::string_view("/index.html") : path);
  return file == files_.end() ? nullptr : &file->second;
}

std::expected<PageFiles, std::string> PageFiles::read(const fs::path& folder) {
  PageFiles files;
  std::error_code error;
  std::uintmax_t bytes = 0;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (type_of(name).empty() || entry->symlink_status(error).type() != fs::file_type::regular) continue;
    bytes += entry->file_size(error);
    if (error) break;
    if (files.files_.size() >= most_files || bytes > most_bytes) {
      return std::unexpected(fmt::format("{}: expected up to {} files of a page with up to {} MiB together",
                                         folder.string(), most_files, most_bytes >> 20));
    }
    auto content = text::read_file(entry->path().string());
    if (!content) return std::unexpected(content.error());
    files.add(name, std::move(*content));
  }
  if (error) return std::unexpected(fmt::format("{}: {}", folder.string(), error.message()));
  for (const char* needed : {"/index.html", "/login.html"}) {
    if (files.find(needed) == nullptr)
      return std::unexpected(fmt::format("{}: expected the file {}", folder.string(), needed + 1));
  }
  return files;
}

std::expected<PageFiles, std::string> PageFiles::of_program(const fs::path& program) {
  std::error_code error;
  const fs::path folder = fs::canonical(program, error).parent_path();
  if (error) return std::unexpected(fmt::format("{}: {}", program.string(), error.message()));
  const std::array places{folder / "page", (folder / "../share/canopus/page").lexically_normal()};
  for (const fs::path& place : places) {
    if (fs::is_directory(place, error)) return read(place);
  }
  return std::unexpected(fmt::format("expected them in {} or {}", places[0].string(), places[1].string()));
}

}  // namespace canopus::web
