#include "canopus/c_program/shared_object.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

namespace canopus::c_program {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = 256U << 20U;

std::string system_error() { return std::strerror(errno); }

/// Empty: the whole file has been copied.
std::string copy(const std::string& path, int to) {
  std::error_code unknown;
  if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown)) return "expected a file";
  std::ifstream from(path, std::ios::binary);
  if (!from) return system_error();
  std::array<char, 65536> bytes{};
  std::size_t size = 0;
  while (from.read(bytes.data(), bytes.size()) || from.gcount() > 0) {
    const auto count = static_cast<std::size_t>(from.gcount());
    size += count;
    if (size > most_bytes) return "expected a shared object of at most 256 MB";
    for (std::size_t done = 0; done < count;) {
      const ssize_t written = ::write(to, bytes.data() + done, count - done);
      if (written < 0) return system_error();
      done += static_cast<std::size_t>(written);
    }
  }
  return from.bad() ? system_error() : std::string();
}

}  // namespace

SharedObject::SharedObject(SharedObject&& other) noexcept
    : file_(std::exchange(other.file_, -1)), handle_(std::exchange(other.handle_, nullptr)) {}

SharedObject::~SharedObject() {
  if (handle_ != nullptr) ::dlclose(handle_);
  if (file_ >= 0) ::close(file_);
}

std::expected<SharedObject, std::string> SharedObject::open(const std::string& path) {
  SharedObject made(::memfd_create("program", MFD_CLOEXEC));
  if (made.file_ < 0) return std::unexpected(system_error());
  if (std::string error = copy(path, made.file_); !error.empty()) return std::unexpected(std::move(error));
  const std::string name = "/proc/self/fd/" + std::to_string(made.file_);
  made.handle_ = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (made.handle_ != nullptr) return made;
  const char* const reason = ::dlerror();
  std::string error = reason == nullptr ? "unknown error" : reason;
  if (error.starts_with(name + ": ")) error.erase(0, name.size() + 2);
  return std::unexpected("expected a shared object of this machine: " + error);
}

void* SharedObject::symbol(const char* name) const { return ::dlsym(handle_, name); }

}  // namespace canopus::c_program
