#include "canopus/cli/files/device_file_match.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "canopus/cli/output/device_names.hpp"
#include "canopus/text/file_text.hpp"

namespace canopus::cli {

namespace {

namespace fs = std::filesystem;

DeviceFileMatch match(const DeviceFileCandidate& candidate, const client::FoundNode& node) {
  const eds::Identity& file = candidate.identity;
  // A device with only a known profile matches no file.
  if (!node.vendor && !node.product) return DeviceFileMatch::none;
  const auto differs = [](std::optional<std::uint32_t> file_value, std::optional<std::uint32_t> found) {
    return file_value.value_or(0) != found.value_or(0);
  };
  if (differs(file.vendor_id, node.vendor) || differs(file.product_code, node.product))
    return DeviceFileMatch::none;
  if (file.device_type && node.device_type && *file.device_type != *node.device_type)
    return DeviceFileMatch::none;
  return differs(file.revision, node.revision) ? DeviceFileMatch::other_revision : DeviceFileMatch::exact;
}

}  // namespace

std::expected<std::vector<DeviceFileCandidate>, std::string> read_device_files(
    const std::vector<std::string>& names, std::vector<std::string>& skipped) {
  std::vector<std::string> paths;
  std::vector<DeviceFileCandidate> candidates;
  const auto add = [&](const std::string& path) -> std::expected<void, std::string> {
    auto text = text::read_file(path);
    if (!text) return std::unexpected(text.error());
    const eds::ReadResult read = eds::read_device_file(*text);
    if (read.file == nullptr) {
      return std::unexpected(fmt::format("{}:{}: {}", path, read.problems[0].line, read.problems[0].message));
    }
    candidates.push_back({path, std::move(*text), read.file, eds::identity(*read.file)});
    return {};
  };
  for (const std::string& name : names) {
    std::error_code error;
    if (!fs::is_directory(name, error)) {
      if (const auto added = add(name); !added) return std::unexpected(added.error());
      continue;
    }
    paths.clear();
    for (fs::directory_iterator entry(name, error), end; !error && entry != end; entry.increment(error)) {
      std::error_code none;
      if (is_device_file(entry->path()) && entry->is_regular_file(none))
        paths.push_back(entry->path().string());
    }
    if (error) return std::unexpected(fmt::format("{}: {}", name, error.message()));
    std::ranges::sort(paths);
    for (const std::string& path : paths) {
      if (const auto added = add(path); !added) skipped.push_back(added.error());
    }
  }
  if (candidates.empty()) return std::unexpected("--eds: no device file is there");
  return candidates;
}

DeviceFileChoice choose_device_file(const std::vector<DeviceFileCandidate>& candidates,
                                    const client::FoundNode& node) {
  DeviceFileChoice best;
  for (const DeviceFileCandidate& candidate : candidates) {
    const DeviceFileMatch one = match(candidate, node);
    const bool is_newer =
        one == best.match && one == DeviceFileMatch::other_revision &&
        candidate.identity.revision.value_or(0) > best.candidate->identity.revision.value_or(0);
    if (one > best.match || is_newer) best = {&candidate, one};
  }
  return best;
}

std::string_view describe(DeviceFileMatch match) {
  switch (match) {
    case DeviceFileMatch::exact: return "exact";
    case DeviceFileMatch::other_revision: return "other revision";
    case DeviceFileMatch::none: break;
  }
  return "none";
}

}  // namespace canopus::cli
