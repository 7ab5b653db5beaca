#pragma once
// The files of the page, which are part of the program: canopus/serve/web/page/, put into a source file by
// cmake/WebFiles.cmake as they are.

#include <string_view>

namespace canopus::web {

struct WebFile {
  std::string_view path{};  ///< "/page.css"
  std::string_view content_type{};
  std::string_view content{};
};

/// By its path; nullptr when the page has no such file.
[[nodiscard]] const WebFile* find_web_file(std::string_view path) noexcept;

}  // namespace canopus::web
