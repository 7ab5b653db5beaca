#include "canopus/store/user_state.hpp"

#include <cstdint>
#include <cstdlib>
#include <span>

#include "canopus/store/files.hpp"

namespace canopus::store {

namespace fs = std::filesystem;

fs::path user_state_folder() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state != '\0') return fs::path(state) / "canopus";
  const char* const home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') return {};
  return fs::path(home) / ".local" / "state" / "canopus";
}

std::string write_whole(const fs::path& path, const std::string& text, FileReaders readers) {
  Files& files = real_files();
  fs::path beside = path;
  beside += ".new";
  const auto file = files.create(beside);
  if (!file) return path.string() + ": " + describe_error(file.error());
  auto left = std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  int failure = 0;
  if (readers == FileReaders::owner) {
    std::error_code error;
    fs::permissions(beside, fs::perms::owner_read | fs::perms::owner_write, error);
    failure = error.value();
  }
  while (!left.empty() && failure == 0) {
    const auto written = files.write(*file, left);
    if (written) left = left.subspan(*written);
    failure = written ? 0 : written.error();
  }
  if (failure == 0) failure = files.flush(*file);
  files.close(*file);
  if (failure == 0) failure = files.rename(beside, path);
  if (failure == 0) return {};
  (void)files.remove(beside);
  return path.string() + ": " + describe_error(failure);
}

}  // namespace canopus::store
