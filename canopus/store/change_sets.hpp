#pragma once
// Changes of several files of a folder that are made together or not at all, and can be taken back one by one.
//
// What is going to be written is first put into a journal, in the folder ".canopus" there. From then on the change counts:
// a power cut in the middle is made up for by the next recover(). The journal keeps what the files were before, for undo().

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

  /// `files` must outlive it. `records`: where the journal lies, below the folder.
  explicit ChangeSets(std::filesystem::path folder, Files& files = real_files(),
                      const std::filesystem::path& records = ".canopus")
      : folder_(std::move(folder)),
        files_(&files),
        records_(records),
        journal_(folder_ / records, {}, files) {}

  /// Ends a change that a power cut left half done. To be called before anything is read, by a caller that may write.
  [[nodiscard]] std::expected<void, std::string> recover();
  /// For readers, in place of recover(): writes nothing; from then on read() gives what the files were before a
  /// change that is not finished. False when there is none.
  [[nodiscard]] std::expected<bool, std::string> look();
  /// What people should know when there is one; `journal`: as they know its path.
  [[nodiscard]] static std::string unfinished_change(std::string_view journal);
  /// A file as it stands; nothing: it is not there.
  [[nodiscard]] std::expected<std::optional<std::string>, std::string> read(const std::string& name);
  /// Gives the files these contents, making folders as needed. Those that have theirs already are not touched, and nothing
  /// is recorded when that is true of all. `title` describes the change for people.
  [[nodiscard]] std::expected<void, std::string> write(const FileContents& contents, std::string_view title);
  /// Takes the latest change back and forgets it: its title, or nothing when there is none. Refused when one of its
  /// files has been changed otherwise since.
  [[nodiscard]] std::expected<std::optional<std::string>, std::string> undo();

 private:
  using Done = std::expected<void, std::string>;
  using Bytes = std::vector<std::uint8_t>;
  /// What can be taken back.
  struct Record {
    std::string title;
    FileContents before;
    std::map<std::string, std::optional<std::uint32_t>> after;  // checksums; nothing: no such file
  };
  struct Journal {
    FileContents pending;  // to be written
    std::vector<Record> records;
    // What the pending files were; nothing: the last record has it, as with every change that is not an undo.
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
  FileContents before_;  // of readers: see look()
};

}  // namespace canopus::store
