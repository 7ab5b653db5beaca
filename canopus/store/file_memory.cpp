#include "canopus/store/file_memory.hpp"

#include <algorithm>
#include <array>
#include <cerrno>

#include "canopus/ascii/words.hpp"
#include "canopus/can/little_endian.hpp"

namespace canopus::store {

namespace {

using Head = std::array<std::uint8_t, 8>;
constexpr Head without_owner{'C', 'N', 'P', 'S', 1, 0, 0, 0};
constexpr Head with_owner{'C', 'N', 'P', 'S', 2, 0, 0, 0};
constexpr std::size_t header_size = sizeof(Head) + 8 + 4;
constexpr std::size_t longest_owner = 65'535;
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
    return ascii::is_letter(c) || ascii::is_digit(c) || c == '-' || c == '_' || c == '%' || c == '.';
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

// The whole file.
std::vector<std::uint8_t> file_of(std::string_view owner, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> content;
  content.reserve(2 + owner.size() + bytes.size());
  if (!owner.empty()) {
    owner = owner.substr(0, longest_owner);
    can::append_value(content, owner.size(), 2);
    content.insert(content.end(), owner.begin(), owner.end());
  }
  content.insert(content.end(), bytes.begin(), bytes.end());
  const Head& head = owner.empty() ? without_owner : with_owner;
  std::vector<std::uint8_t> file(head.begin(), head.end());
  file.reserve(header_size + content.size());
  can::append_value(file, content.size(), 8);
  can::append_value(file, crc32(content), 4);
  file.insert(file.end(), content.begin(), content.end());
  return file;
}

bool begins_with(std::span<const std::uint8_t> bytes, const Head& head) {
  return bytes.size() >= header_size && std::equal(head.begin(), head.end(), bytes.begin());
}

}  // namespace

int make_folders(Files& files, const std::filesystem::path& folder) {
  const std::filesystem::path parent = folder.parent_path();
  int why = files.make_folder(folder);
  if (why == ENOENT && !parent.empty() && parent != folder) {
    why = make_folders(files, parent);
    if (why == 0) why = files.make_folder(folder);
  }
  if (why != 0 && why != EEXIST) return why;
  // Also when it is there already: the power may have been cut right after it was made.
  files.flush_folder(parent.empty() ? "." : parent);
  return 0;
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ crc_table[(crc ^ byte) & 0xFF];
  return ~crc;
}

FileMemory::Stored FileMemory::load(std::string_view name) {
  using State = Content::State;
  if (!is_good_name(name)) return {};
  const std::filesystem::path path = folder_ / name;
  const auto damaged = [&path](const std::string& why) {
    return Stored{.content = {.state = State::damaged, .bytes = {}}, .damage = path.string() + ": " + why};
  };
  if (files_->is_link(path)) return damaged("it is a symbolic link, which is not followed");
  auto read = files_->read(path, header_size + largest_content);
  if (!read) {
    if (read.error() == ENOENT || read.error() == ENOTDIR) return {};
    return damaged("cannot read: " + describe_error(read.error()));
  }
  std::vector<std::uint8_t>& bytes = *read;
  const std::span<const std::uint8_t> all(bytes);
  const bool has_owner = begins_with(all, with_owner);
  if (!has_owner && !begins_with(all, without_owner)) {
    return damaged("is damaged, or not a file that Canopus has stored");
  }
  const std::span<const std::uint8_t> content = all.subspan(header_size);
  const bool is_whole = can::load_value(all.subspan(sizeof(Head), 8)) == content.size() &&
                        can::load_value(all.subspan(sizeof(Head) + 8, 4)) == crc32(content);
  std::size_t owner_size = 0;
  if (has_owner && content.size() >= 2)
    owner_size = 2 + static_cast<std::size_t>(can::load_value(content.first(2)));
  if (!is_whole || owner_size > content.size() || (has_owner && owner_size == 0)) {
    return damaged("is damaged (length or checksum)");
  }
  if (has_owner && !owner_.empty()) {
    const std::string owner(content.begin() + 2, content.begin() + static_cast<std::ptrdiff_t>(owner_size));
    if (owner != owner_) return damaged("belongs to " + owner + ", not to " + owner_);
  }
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header_size + owner_size));
  return {.content = {.state = State::good, .bytes = std::move(bytes)}, .damage = {}};
}

module::NonVolatileMemory::Content FileMemory::read(std::string_view name) { return load(name).content; }

std::string FileMemory::damage(std::string_view name) { return load(name).damage; }

bool FileMemory::write(std::string_view name, std::span<const std::uint8_t> bytes) {
  error_.clear();
  if (!is_good_name(name)) return fail("not a name for stored data", name, 0);
  if (bytes.size() > largest_content - longest_owner) return fail("too much to store", name, 0);
  if (!make_folder()) return false;
  const std::filesystem::path path = folder_ / name;
  std::filesystem::path temporary = path;
  temporary += temporary_suffix;

  if (const int why = write_file(temporary, file_of(owner_, bytes)); why != 0) {
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
  if (why != 0) error_ += ": " + describe_error(why);
  return false;
}

}  // namespace canopus::store
