#pragma once
// The files of the page (canopus/web/page, built by tools/page): read once from their folder, then served from memory.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace canopus::web {

struct PageFile {
  std::string_view content_type{};
  std::string tag{};  ///< of the content, for ETag: `"0123456789abcdef"`
  std::shared_ptr<const std::string> content{};
};

class PageFiles {
 public:
  static constexpr std::size_t most_files = 200;
  static constexpr std::uintmax_t most_bytes = 64U << 20;  ///< of all files together
  /// The answer of a server without files.
  static constexpr std::string_view missing =
      "The files of this page are not built. In the source tree `tools/page build/page` builds them beside "
      "build/canopus "
      "(Node 18 or newer, npm); the Debian package and the image have them in share/canopus/page. Then start "
      "this run again.";

  /// Of the folder those regular files (no links) whose name is one of a page's: letters, digits and `. _ -`, ending with
  /// .html, .css, .js, .svg, .png, .woff2, .json or .txt. Error, as a sentence: index.html or login.html is missing, a file
  /// cannot be read, or they are more than `most_files` or `most_bytes`.
  [[nodiscard]] static std::expected<PageFiles, std::string> read(const std::filesystem::path& folder);
  /// Of the folder `page` beside this program, else of `../share/canopus/page`. The error names both.
  [[nodiscard]] static std::expected<PageFiles, std::string> of_program(const std::filesystem::path& program);

  /// False: that is no name of a file of a page.
  bool add(const std::string& name, std::string content);
  /// "/page.css", and "/" for "/index.html"; nullptr: there is no such file.
  [[nodiscard]] const PageFile* find(std::string_view path) const noexcept;
  [[nodiscard]] bool empty() const noexcept { return files_.empty(); }

 private:
  std::map<std::string, PageFile, std::less<>> files_;  // by path
};

}  // namespace canopus::web
