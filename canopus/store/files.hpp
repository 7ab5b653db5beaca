#pragma once
// The interface to the file system for stored data: the real one in a program, one that loses its power in a
// test. Errors are errno values, or not_a_file.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace canopus::store {

/// There is something of that name, but it is neither a file nor a folder: a FIFO, a device.
inline constexpr int not_a_file = -1;
/// "Permission denied", "it is not a file".
[[nodiscard]] std::string describe_error(int why);

class Files {
 public:
  virtual ~Files() = default;

  /// The whole file; EFBIG when it is longer than `at_most`, EISDIR for a folder, not_a_file for a FIFO or a device,
  /// which would have to be waited for.
  [[nodiscard]] virtual std::expected<std::vector<std::uint8_t>, int> read(const std::filesystem::path& path,
                                                                           std::size_t at_most) = 0;
  /// Whether the name itself is a symbolic link, wherever that leads.
  [[nodiscard]] virtual bool is_link(const std::filesystem::path& path) = 0;
  /// Makes one folder: 0, EEXIST, ENOENT when its parent is missing, ...
  [[nodiscard]] virtual int make_folder(const std::filesystem::path& path) = 0;
  /// Makes an empty file for writing. One that has this name is taken away first, a link as such: nothing that
  /// is there already is written into. The number is for write(), flush() and close().
  [[nodiscard]] virtual std::expected<int, int> create(const std::filesystem::path& path) = 0;
  /// Appends; may take less than all.
  [[nodiscard]] virtual std::expected<std::size_t, int> write(int file,
                                                              std::span<const std::uint8_t> bytes) = 0;
  /// Flushes written data to the medium.
  [[nodiscard]] virtual int flush(int file) = 0;
  virtual void close(int file) noexcept = 0;
  /// Takes the place of a file that is there, in one step.
  [[nodiscard]] virtual int rename(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  [[nodiscard]] virtual int remove(const std::filesystem::path& path) = 0;
  /// The names in the folder are on the medium afterwards.
  virtual int flush_folder(const std::filesystem::path& path) = 0;
};

/// The machine's own.
[[nodiscard]] Files& real_files() noexcept;

}  // namespace canopus::store
