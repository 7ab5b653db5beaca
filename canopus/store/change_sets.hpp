#pragma once
// Changes of several files of a folder that are made together or not at all, and can be taken back one by one.
//
// New contents first go into a journal, in the folder ".canopus" there. From then on the change is valid:
// after a power cut in the middle the next recover() completes it. The journal keeps the previous contents of
// the files, for undo().

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/store/file_memory.hpp"
#include "canopus/store/files.hpp"

namespace canopus::store {

/// Contents by path below the folder, with '/'; nothing: no such file.
using FileContents = std::map<std::string, std::optional<std::string>>;

/// The names are paths inside of the folder without symbolic links, also those that a journal holds (inner_path.hpp): a
/// journal of a stranger that names others is refused whole. Errors name the file. One process at a time (FolderLock).
class ChangeSets {
 public:
  static constexpr std::size_t most_kept = 50;             ///< changes that can be taken back
  static constexpr std::size_t most_bytes_kept = 8 << 20;  ///< of the files before them
  static constexpr std::size_t longest_file = 16 << 20;    ///< bytes

  /// `files` must outlive it. `records`: the journal's folder, below the folder.
  explicit ChangeSets(std::filesystem::path folder, Files& files = real_files(),
                      const std::filesystem::path& records = ".canopus")
      : folder_(std::move(folder)),
        files_(&files),
        records_(records),
        journal_(folder_ / records, {}, files) {}

  /// Ends a change that a power cut left half done. Call it before anything is read, with write permission.
  [[nodiscard]] std::expected<void, std::string> recover();
  /// For readers, in place of recover(): writes nothing; from then on read() gives what the files were before a
  /// change that is not finished. False when there is none.
  [[nodiscard]] std::expected<bool, std::string> open_read_only();
  /// The message to the user when there is one; `journal`: the path as the user gave it.
  [[nodiscard]] static std::string unfinished_change(std::string_view journal);
  /// The contents of a file; nothing: it does not exist.
  [[nodiscard]] std::expected<std::optional<std::string>, std::string> read(const std::string& name);
  /// Gives the files these contents, making folders as needed. Those that have theirs already are not touched, and nothing
  /// is recorded when that is true of all. `title` describes the change for people.
  [[nodiscard]] std::expected<void, std::string> write(const FileContents& contents, std::string_view title);
  /// Undoes the latest change and removes it from the journal. Returns its title, or nothing when there is
  /// none. Refused when one of its files has been changed otherwise since.
  [[nodiscard]] std::expected<std::optional<std::string>, std::string> undo();

 private:
  using Done = std::expected<void, std::string>;
  using Bytes = std::vector<std::uint8_t>;
  /// A change that can be undone.
  struct Record {
    std::string title;
    FileContents before;
    std::map<std::string, std::optional<std::uint32_t>> after;  // checksums; nothing: no such file
  };
  struct Journal {
    FileContents pending;  // to write
    std::vector<Record> records;
    // The contents of the pending files before; nothing: the last record has them, as with every change that
    // is not an undo.
    std::optional<FileContents> before;
  };
  class Reader;

  [[nodiscard]] Done check(const std::filesystem::path& name);
  [[nodiscard]] Done check_names(const Journal& journal);
  [[nodiscard]] std::expected<Journal, std::string> load();
  [[nodiscard]] Done save(const Journal& journal);
  [[nodiscard]] Done carry_out(Journal journal);
  [[nodiscard]] Done put(const std::string& name, const std::optional<std::string>& content);
  static void drop_oldest(std::vector<Record>& records);
  [[nodiscard]] std::string name_of(const std::filesystem::path& name) const {
    return (folder_ / name).string();
  }

  std::filesystem::path folder_;
  Files* files_;
  std::filesystem::path records_;
  FileMemory journal_;
  FileContents before_;  // of readers: see open_read_only()
};

}  // namespace canopus::store
