#pragma once
// Which device file describes a device that was found on a bus: by 1000H and the identity 1018H.

#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/client/bus_scan.hpp"
#include "canopus/eds/device_file.hpp"

namespace canopus::cli {

struct DeviceFileCandidate {
  std::string path;
  std::string text;
  std::shared_ptr<const eds::DeviceFile> file;  ///< never null
  eds::Identity identity;
};

/// Files and folders by name. A file must be a device file, else the error names it; in folders other files are left out, and
/// those that cannot be read go into `skipped` with the reason. None at all is an error.
[[nodiscard]] std::expected<std::vector<DeviceFileCandidate>, std::string> read_device_files(
    const std::vector<std::string>& names, std::vector<std::string>& skipped);

enum class DeviceFileMatch : std::uint8_t { none, other_revision, exact };

/// "exact", "other revision", "none".
[[nodiscard]] std::string_view describe(DeviceFileMatch match);

struct DeviceFileChoice {
  const DeviceFileCandidate* candidate = nullptr;  ///< nullptr: none matches
  DeviceFileMatch match = DeviceFileMatch::none;
};

/// The best one; where only other revisions are there, the newest of them.
[[nodiscard]] DeviceFileChoice choose_device_file(const std::vector<DeviceFileCandidate>& candidates,
                                                  const client::FoundNode& node);

}  // namespace canopus::cli
