#include "canopus/web/access/inside_folder.hpp"

#include <algorithm>
#include <cstdlib>
#include <system_error>

namespace canopus::web {

namespace fs = std::filesystem;

bool is_inside(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  if (!fs::is_symlink(file, error)) return true;
  const fs::path real = fs::canonical(file, error);
  const fs::path top = fs::canonical(folder, error);
  return !error && std::ranges::mismatch(top, real).in1 == top.end();
}

std::string shown_folder(const fs::path& folder) {
  const char* const home = std::getenv("HOME");
  if (home == nullptr || !fs::path(home).is_absolute()) return folder.string();
  const fs::path below = folder.lexically_relative(home);
  if (below.empty() || *below.begin() == "..") return folder.string();
  return below == "." ? "~" : "~/" + below.string();
}

}  // namespace canopus::web
