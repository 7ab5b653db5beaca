#include "canopus/store/file_memory.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace canopus::store {

namespace {

constexpr std::array<std::uint8_t, 8> magic{'C', 'N', 'P', 'S', 1, 0, 0, 0};
constexpr std::size_t header_size = magic.size() + 8 + 4;
constexpr std::uint64_t largest_content = 64ULL << 20;
constexpr std::string_view temporary_suffix = ".new";

constexpr std::array<std::uint32_t, 256> crc_table = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1 ^ 0xEDB88320U : crc >> 1;
    table[byte] = crc;
  }
  return table;
}();

bool is_good_name(std::string_view name) {
  return !name.empty() && name.front() != '.' && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  });
}

// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }

 private:
  int number_;
};

bool write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

// False when the file cannot be read to its end or is larger than anything written here.
bool read_all(int file, std::vector<std::uint8_t>& bytes) {
  std::array<std::uint8_t, 16384> piece{};
  for (;;) {
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count < 0) {
      if (errno == EINTR) continue;
      return false;
    }
    if (count == 0) return true;
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + count);
    if (bytes.size() > largest_content + header_size) return false;
  }
}

std::uint64_t get(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

void put(std::vector<std::uint8_t>& bytes, std::uint64_t value, unsigned length) {
  for (unsigned i = 0; i < length; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xFF));
}

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ crc_table[(crc ^ byte) & 0xFF];
  return ~crc;
}

module::NonVolatileMemory::Content FileMemory::read(std::string_view name) {
  using State = Content::State;
  if (!is_good_name(name)) return {};
  const Descriptor file(::open((folder_ / name).c_str(), O_RDONLY | O_CLOEXEC));
  if (!file)
    return {.state = errno == ENOENT || errno == ENOTDIR ? State::missing : State::damaged, .bytes = {}};
  std::vector<std::uint8_t> bytes;
  if (!read_all(file.get(), bytes) || bytes.size() < header_size ||
      !std::equal(magic.begin(), magic.end(), bytes.begin())) {
    return {.state = State::damaged, .bytes = {}};
  }
  const std::span<const std::uint8_t> all(bytes);
  const std::uint64_t length = get(all.subspan(magic.size(), 8));
  const std::span<const std::uint8_t> content = all.subspan(header_size);
  if (length != content.size() || crc32(content) != get(all.subspan(magic.size() + 8, 4))) {
    return {.state = State::damaged, .bytes = {}};
  }
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header_size));
  return {.state = State::good, .bytes = std::move(bytes)};
}

bool FileMemory::write(std::string_view name, std::span<const std::uint8_t> bytes) {
  error_.clear();
  if (!is_good_name(name)) return fail("not a name for stored data", name, 0);
  if (bytes.size() > largest_content) return fail("too much to store", name, 0);
  std::error_code code;
  std::filesystem::create_directories(folder_, code);
  if (code) return fail("cannot make the folder", folder_, code.value());
  const std::filesystem::path path = folder_ / name;
  std::filesystem::path temporary = path;
  temporary += temporary_suffix;

  std::vector<std::uint8_t> content(magic.begin(), magic.end());
  content.reserve(header_size + bytes.size());
  put(content, bytes.size(), 8);
  put(content, crc32(bytes), 4);
  content.insert(content.end(), bytes.begin(), bytes.end());
  {
    const Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
    if (!file) return fail("cannot open", temporary, errno);
    if (!write_all(file.get(), content) || ::fsync(file.get()) != 0) {
      const int why = errno;
      ::unlink(temporary.c_str());
      return fail("cannot write", temporary, why);
    }
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const int why = errno;
    ::unlink(temporary.c_str());
    return fail("cannot put in place", path, why);
  }
  // The new name must be on the medium too; where a folder cannot be flushed the rename alone has to do.
  if (const Descriptor folder(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)); folder) {
    static_cast<void>(::fsync(folder.get()));
  }
  ++writes_;
  return true;
}

bool FileMemory::erase(std::string_view name) {
  error_.clear();
  if (!is_good_name(name)) return fail("not a name for stored data", name, 0);
  if (::unlink((folder_ / name).c_str()) != 0 && errno != ENOENT && errno != ENOTDIR) {
    return fail("cannot erase", folder_ / name, errno);
  }
  return true;
}

bool FileMemory::fail(std::string_view what, const std::filesystem::path& path, int why) {
  error_ = path.string() + ": " + std::string(what);
  if (why != 0) error_ += ": " + std::generic_category().message(why);
  return false;
}

}  // namespace canopus::store
