#pragma once
// Mistakes in a file that a person wrote, each with its place.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace canopus::text {

/// A position in a file; line 0 = none (a default value).
struct Place {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  friend auto operator<=>(const Place&, const Place&) = default;
};

/// A mistake in a file that a person wrote, or in something it names: nothing is made of it.
struct FileError {
  Place place{};
  std::string message{};
  friend bool operator==(const FileError&, const FileError&) = default;
};

/// Something that a person should know: the file is used, but probably not as it was meant.
struct FileWarning {
  Place place{};
  std::string message{};
  friend bool operator==(const FileWarning&, const FileWarning&) = default;
};

/// "plant.toml:14:9"; the path alone for nowhere.
[[nodiscard]] std::string describe(Place place, std::string_view path);
/// "plant.toml:14:9: node = 128: a node-ID is 1 to 127"
[[nodiscard]] std::string describe(const FileError& error, std::string_view path);
/// "plant.toml:14:9: warning: node 3 waits for SYNC, but no node on bus \"line1\" produces it"
[[nodiscard]] std::string describe(const FileWarning& warning, std::string_view path);

class FileErrors {
 public:
  template <typename... Arguments>
  void add(Place place, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    errors_.push_back({place, fmt::format(text, std::forward<Arguments>(arguments)...)});
  }
  void add(const std::vector<FileError>& others) {
    errors_.insert(errors_.end(), others.begin(), others.end());
  }
  [[nodiscard]] bool empty() const noexcept { return errors_.empty(); }
  [[nodiscard]] std::vector<FileError> release() { return std::exchange(errors_, {}); }

 private:
  std::vector<FileError> errors_;
};

}  // namespace canopus::text
