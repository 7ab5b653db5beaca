#include "canopus/web/trace/uploaded_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "canopus/ascii/counted.hpp"

namespace canopus::web {

std::expected<std::shared_ptr<UploadedFile>, std::string> UploadedFile::make(std::string name,
                                                                             std::uint64_t size) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) return std::unexpected("there is no folder for temporary files");
  std::string path = folder / "canopus-upload-XXXXXX";
  const int descriptor = ::mkostemp(path.data(), O_CLOEXEC);
  if (descriptor < 0) {
    return std::unexpected(fmt::format("{}: cannot make a temporary file: {}", folder.string(),
                                       std::generic_category().message(errno)));
  }
  (void)::unlink(path.c_str());
  return std::shared_ptr<UploadedFile>(new UploadedFile(std::move(name), size, descriptor));
}

UploadedFile::~UploadedFile() { (void)::close(descriptor_); }

std::expected<std::uint64_t, std::string> UploadedFile::add(std::string_view bytes) {
  if (bytes.size() > size_ - received_)
    return std::unexpected(fmt::format("{}: more than its {} came", name_, ascii::counted(size_, "byte")));
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      return std::unexpected(
          fmt::format("{}: cannot be kept here: {}", name_, std::generic_category().message(errno)));
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
    received_ += static_cast<std::uint64_t>(written);
  }
  return received_;
}

std::string UploadedFile::path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

}  // namespace canopus::web
