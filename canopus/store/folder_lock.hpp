#pragma once
// A folder of stored data belongs to one process at a time: two that write the same files would overwrite each
// other. The lock is the system's (flock) on the file ".lock" in the folder; it ends with the process, however
// that ends. The file stays and names the process that had it last.

#include <expected>
#include <filesystem>
#include <string>
#include <utility>

namespace canopus::store {

class FolderLock {
 public:
  /// Makes the folder if it is missing. The error is a sentence without the folder's name: "another process
  /// (1234) uses it", "cannot make the folder: Permission denied".
  [[nodiscard]] static std::expected<FolderLock, std::string> acquire(const std::filesystem::path& folder);

  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  FolderLock& operator=(FolderLock&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }

 private:
  explicit FolderLock(int file) noexcept : file_(file) {}
  int file_;
};

}  // namespace canopus::store
