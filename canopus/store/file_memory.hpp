#pragma once
// Non-volatile memory of modules in a folder: one file per blob. A write goes to a temporary file, is flushed
// to the medium, and then takes the old file's place in one step, so that after a power cut at any moment the
// old or the new content is there; when write() or erase() has returned, it is the new one. A
// checksum shows damage that came from elsewhere.
//
// File: "CNPS", version (1 byte), three zero bytes, length of the content (8 bytes), CRC-32 of the content
// (4 bytes), the content. In version 2 the content begins with the owner's name: its length (2 bytes), and UTF-8.
// Version 1 has no owner. Little-endian.

#include <cstdint>
#include <filesystem>
#include <string>

#include "canopus/module/interface/non_volatile_memory.hpp"
#include "canopus/store/files.hpp"

namespace canopus::store {

/// Makes a folder and those above it that are missing; each name is on the medium before the next is made.
/// 0, or why not.
[[nodiscard]] int make_folders(Files& files, const std::filesystem::path& folder);

/// CRC-32 (polynomial 04C11DB7H reflected, as in zip and Ethernet).
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept;

class FileMemory final : public module::NonVolatileMemory {
 public:
  /// Blobs live in `folder`, which is made when the first one is written. Names may hold letters, digits,
  /// '-', '_', '%' and '.'; other names are refused. `owner` names the owner of the blobs for people; each keeps
  /// it, and one of another owner counts as damaged. Empty: files of version 1 are written, and those of any
  /// owner read. `files` must outlive the memory.
  explicit FileMemory(std::filesystem::path folder, std::string owner = {}, Files& files = real_files())
      : folder_(std::move(folder)), owner_(std::move(owner)), files_(&files) {}

  [[nodiscard]] Content read(std::string_view name) override;
  /// Why read() finds damage, as a sentence with the path: "state/U000/words: cannot read: Permission denied".
  /// Empty when it finds none, or nothing.
  [[nodiscard]] std::string damage(std::string_view name);
  bool write(std::string_view name, std::span<const std::uint8_t> bytes) override;
  bool erase(std::string_view name) override;

  /// Why the last write() or erase() failed; empty after a good one.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  struct Stored {
    Content content{};
    std::string damage{};
  };
  [[nodiscard]] Stored load(std::string_view name);
  bool make_folder();
  int write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
  bool fail(std::string_view what, const std::filesystem::path& path, int why);

  std::filesystem::path folder_;
  std::string owner_;
  Files* files_;
  std::string error_;
  bool folder_made_ = false;
};

}  // namespace canopus::store
