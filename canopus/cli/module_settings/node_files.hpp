#pragma once
// Device files of the nodes of a module's network: what "EDS file version" and "EDS file revision" of the tool are.

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

namespace canopus::cli {

/// FileVersion and FileRevision of a device file, and the identity of its device: vendor-ID, product code,
/// revision number.
struct NodeFile {
  std::uint32_t version = 0;
  std::uint32_t revision = 0;
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
  std::optional<std::uint32_t> device_revision{};  ///< nothing: the file is for all revisions
};

/// The device files of this name (EDS, DCF, XDD, XDC), or in this folder, 1000 at most. A path of a file must
/// be a device file; in folders other files are skipped.
[[nodiscard]] std::expected<std::vector<NodeFile>, std::string> read_node_files(
    const std::vector<std::string>& names);

/// The file of a node with this identity (1018H); nullptr: no file matches. A file of the node's own revision
/// has priority over one without a revision.
[[nodiscard]] const NodeFile* file_of_node(const std::vector<NodeFile>& files, std::uint32_t vendor,
                                           std::uint32_t product, std::uint32_t revision) noexcept;

}  // namespace canopus::cli
