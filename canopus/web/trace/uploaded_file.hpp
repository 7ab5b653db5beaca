#pragma once
// A trace file that comes from the browser's machine, part by part.

#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <string_view>

namespace canopus::web {

/// It stands in the system's folder for temporary files without a name there, and is gone with this object, however the process ends.
class UploadedFile {
 public:
  /// `name`: as the browser has it, for sentences alone. `size`: bytes that will come. The error is a sentence.
  [[nodiscard]] static std::expected<std::shared_ptr<UploadedFile>, std::string> make(std::string name,
                                                                                      std::uint64_t size);
  ~UploadedFile();
  UploadedFile(const UploadedFile&) = delete;
  UploadedFile& operator=(const UploadedFile&) = delete;

  /// The next bytes. Returns how many have come. The error is a sentence: more than `size`, or the disk refuses them.
  [[nodiscard]] std::expected<std::uint64_t, std::string> add(std::string_view bytes);
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] bool is_whole() const noexcept { return received_ == size_; }
  /// Where this process reads it from its begin on.
  [[nodiscard]] std::string path() const;

 private:
  UploadedFile(std::string name, std::uint64_t size, int descriptor)
      : name_(std::move(name)), size_(size), descriptor_(descriptor) {}

  std::string name_;
  std::uint64_t size_;
  std::uint64_t received_ = 0;
  int descriptor_;
};

}  // namespace canopus::web
