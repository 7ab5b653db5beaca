#include "canopus/cli/output/device_names.hpp"

#include <fmt/format.h>

#include "canopus/ascii/words.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::cli {

bool is_device_file(const std::filesystem::path& path) {
  const std::string extension = ascii::lower(path.extension().string());
  return extension == ".eds" || extension == ".dcf" || extension == ".xdd" || extension == ".xdc";
}

std::expected<std::shared_ptr<const eds::DeviceFile>, std::string> device_file_of_names(
    const std::string& file) {
  const auto text = text::read_file_or_reason(file);
  if (!text) return std::unexpected(fmt::format("{}: {}", file, text.error()));
  eds::ReadResult result = eds::read_device_file(*text);
  if (!result.file) return std::unexpected(fmt::format("{}: {}", file, result.problems.front().message));
  return std::move(result.file);
}

}  // namespace canopus::cli
