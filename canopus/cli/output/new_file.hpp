#pragma once
// A file that is renamed when complete: until then it is NAME.PID.part in the same folder, and an error or a
// signal (SIGINT, SIGTERM, SIGHUP) leaves nothing behind, and what was there before as it was.
//
// What is no regular file (a pipe, /dev/stdout, a device) is written directly, and so is a file in a folder that takes no
// new one.

#include <expected>
#include <string>
#include <string_view>

namespace canopus::cli {

class NewFile {
 public:
  /// One at a time. A symbolic link stays one: its target is replaced.
  explicit NewFile(const std::string& name);
  /// Removes what is not kept.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// The path to open and write.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// It is whole and closed. The error names it.
  [[nodiscard]] std::expected<void, std::string> commit();

 private:
  std::string name_;
  std::string path_;
  bool is_beside_ = false;
};

/// A whole file at once. The error names it.
[[nodiscard]] std::expected<void, std::string> write_new_file(const std::string& name,
                                                              std::string_view content);

// A command must not write over what it reads.

/// Whether `in` (- is the standard input) and `out` are one regular file, even by different names. An `out`
/// of - is never one.
[[nodiscard]] bool is_same_file(const std::string& in, const std::string& out);

}  // namespace canopus::cli
