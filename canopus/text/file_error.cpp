#include "canopus/text/file_error.hpp"

namespace canopus::text {

std::string describe(Place place, std::string_view path) {
  return place.line == 0 ? std::string(path) : fmt::format("{}:{}:{}", path, place.line, place.column);
}

std::string describe(const FileError& error, std::string_view path) {
  return fmt::format("{}: {}", describe(error.place, path), error.message);
}

std::string describe(const FileWarning& warning, std::string_view path) {
  return fmt::format("{}: warning: {}", describe(warning.place, path), warning.message);
}

}  // namespace canopus::text
