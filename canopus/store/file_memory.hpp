#pragma once
// Non-volatile memory of modules in a folder: one file per blob. A write goes to a temporary file, is flushed
// to the medium, and then takes the old file's place in one step, so that whatever moment the power goes off
// at, the old or the new content is there; when write() or erase() has returned, it is the new one. A
// checksum tells damage that came from elsewhere.
//
// File: "CNPS", version 1 (1 byte), three zero bytes, length of the content (8 bytes), CRC-32 of the content
// (4 bytes), the content. Little-endian.

#include <cstdint>
#include <filesystem>
#include <string>

#include "canopus/module/module.hpp"
#include "canopus/store/files.hpp"

namespace canopus::store {

/// CRC-32 (polynomial 04C11DB7H reflected, as in zip and Ethernet).
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept;

class FileMemory final : public module::NonVolatileMemory {
 public:
  /// Blobs live in `folder`, which is made when the first one is written. Names may hold letters, digits,
  /// '-', '_' and '.'; other names are refused. `files` must outlive the memory.
  explicit FileMemory(std::filesystem::path folder, Files& files = real_files())
      : folder_(std::move(folder)), files_(&files) {}

  [[nodiscard]] Content read(std::string_view name) override;
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override;
  bool erase(std::string_view name) override;

  /// Why the last write() or erase() failed; empty after a good one.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  bool make_folder();
  int write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
  bool fail(std::string_view what, const std::filesystem::path& path, int why);

  std::filesystem::path folder_;
  Files* files_;
  std::string error_;
  bool folder_made_ = false;
};

}  // namespace canopus::store
