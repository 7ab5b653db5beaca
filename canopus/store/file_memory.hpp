#pragma once
// Non-volatile memory of modules in a folder: one file per blob. A write goes to a temporary file, is flushed
// to the medium, and then takes the old file's place in one step, so that whatever moment the power goes off
// at, the old or the new content is there. A checksum tells damage that came from elsewhere.
//
// File: "CNPS", version 1 (1 byte), three zero bytes, length of the content (8 bytes), CRC-32 of the content
// (4 bytes), the content. Little-endian.

#include <cstdint>
#include <filesystem>
#include <string>

#include "canopus/module/module.hpp"

namespace canopus::store {

/// CRC-32 (polynomial 04C11DB7H reflected, as in zip and Ethernet).
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept;

class FileMemory final : public module::NonVolatileMemory {
 public:
  /// Blobs live in `folder`, which is made when the first one is written. Names may hold letters, digits,
  /// '-', '_' and
  /// '.'; other names are refused.
  explicit FileMemory(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] Content read(std::string_view name) override;
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override;
  bool erase(std::string_view name) override;

  /// Why the last write() or erase() failed; empty after a good one.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }
  /// Writes done since construction, as a flash memory would wear.
  [[nodiscard]] std::uint64_t writes() const noexcept { return writes_; }

 private:
  bool fail(std::string_view what, const std::filesystem::path& path, int why);

  std::filesystem::path folder_;
  std::string error_;
  std::uint64_t writes_ = 0;
};

}  // namespace canopus::store
