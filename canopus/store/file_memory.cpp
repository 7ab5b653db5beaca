#include "canopus/store/file_memory.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

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

// A file that closes itself.
class OpenFile {
 public:
  OpenFile(Files& files, int number) : files_(files), number_(number) {}
  ~OpenFile() { files_.close(number_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

 private:
  Files& files_;
  int number_;
};

// Makes the folder and those above it that are missing; each name is on the medium before the next is made.
int make_folders(Files& files, const std::filesystem::path& folder) {
  const std::filesystem::path parent = folder.parent_path();
  int why = files.make_folder(folder);
  if (why == ENOENT && !parent.empty() && parent != folder) {
    why = make_folders(files, parent);
    if (why == 0) why = files.make_folder(folder);
  }
  if (why != 0 && why != EEXIST) return why;
  // Also when it is there already: who made it may have been cut off right then.
  files.flush_folder(parent.empty() ? "." : parent);
  return 0;
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
  auto read = files_->read(folder_ / name, header_size + largest_content);
  if (!read) {
    const bool missing = read.error() == ENOENT || read.error() == ENOTDIR;
    return {.state = missing ? State::missing : State::damaged, .bytes = {}};
  }
  std::vector<std::uint8_t>& bytes = *read;
  if (bytes.size() < header_size || !std::equal(magic.begin(), magic.end(), bytes.begin())) {
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
  if (!make_folder()) return false;
  const std::filesystem::path path = folder_ / name;
  std::filesystem::path temporary = path;
  temporary += temporary_suffix;

  std::vector<std::uint8_t> content(magic.begin(), magic.end());
  content.reserve(header_size + bytes.size());
  put(content, bytes.size(), 8);
  put(content, crc32(bytes), 4);
  content.insert(content.end(), bytes.begin(), bytes.end());
  if (const int why = write_file(temporary, content); why != 0) {
    static_cast<void>(files_->remove(temporary));
    return fail("cannot write", temporary, why);
  }
  if (const int why = files_->rename(temporary, path); why != 0) {
    static_cast<void>(files_->remove(temporary));
    return fail("cannot put in place", path, why);
  }
  // The new name must be on the medium too; where a folder cannot be flushed the rename alone has to do.
  files_->flush_folder(folder_);
  return true;
}

bool FileMemory::erase(std::string_view name) {
  error_.clear();
  if (!is_good_name(name)) return fail("not a name for stored data", name, 0);
  const int why = files_->remove(folder_ / name);
  if (why == ENOENT || why == ENOTDIR) return true;
  if (why != 0) return fail("cannot erase", folder_ / name, why);
  files_->flush_folder(folder_);
  return true;
}

bool FileMemory::make_folder() {
  if (folder_made_) return true;
  if (const int why = make_folders(*files_, folder_); why != 0) {
    return fail("cannot make the folder", folder_, why);
  }
  folder_made_ = true;
  return true;
}

int FileMemory::write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  const auto file = files_->create(path);
  if (!file) return file.error();
  const OpenFile closes_itself(*files_, *file);
  while (!bytes.empty()) {
    const auto written = files_->write(*file, bytes);
    if (!written) return written.error();
    bytes = bytes.subspan(*written);
  }
  return files_->flush(*file);
}

bool FileMemory::fail(std::string_view what, const std::filesystem::path& path, int why) {
  error_ = path.string() + ": " + std::string(what);
  if (why != 0) error_ += ": " + std::generic_category().message(why);
  return false;
}

}  // namespace canopus::store
