#include "canopus/cli/module_settings/node_files.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "canopus/cli/output/device_names.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::cli {
namespace {

namespace fs = std::filesystem;

std::expected<NodeFile, std::string> read_node_file(const std::string& path) {
  const auto text = text::read_file(path);
  if (!text) return std::unexpected(text.error());
  const eds::ReadResult read = eds::read_device_file(*text);
  if (read.file == nullptr)
    return std::unexpected(fmt::format("{}:{}: {}", path, read.problems[0].line, read.problems[0].message));
  const eds::Identity identity = eds::identity(*read.file);
  return NodeFile{.version = read.file->file.version,
                  .revision = read.file->file.revision,
                  .vendor = identity.vendor_id.value_or(0),
                  .product = identity.product_code.value_or(0),
                  .device_revision = identity.revision};
}

std::vector<std::string> device_files_in(const std::string& folder) {
  constexpr std::size_t most = 1000;
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end && paths.size() < most;
       entry.increment(error)) {
    std::error_code unknown;
    if (is_device_file(entry->path()) && entry->is_regular_file(unknown))
      paths.push_back(entry->path().string());
  }
  std::ranges::sort(paths);
  return paths;
}

}  // namespace

std::expected<std::vector<NodeFile>, std::string> read_node_files(const std::vector<std::string>& names) {
  std::vector<NodeFile> files;
  for (const std::string& name : names) {
    std::error_code error;
    const bool is_folder = fs::is_directory(name, error);
    for (const std::string& path : is_folder ? device_files_in(name) : std::vector{name}) {
      auto file = read_node_file(path);
      if (file) files.push_back(*file);
      if (!file && !is_folder) return std::unexpected(file.error());
    }
  }
  return files;
}

const NodeFile* file_of_node(const std::vector<NodeFile>& files, std::uint32_t vendor, std::uint32_t product,
                             std::uint32_t revision) noexcept {
  const NodeFile* found = nullptr;
  for (const NodeFile& file : files) {
    if (file.vendor != vendor || file.product != product) continue;
    if (file.device_revision == revision) return &file;
    if (!file.device_revision && found == nullptr) found = &file;
  }
  return found;
}

}  // namespace canopus::cli
