// Any bytes as the journal of a folder's changes. Who only looks writes nothing; whoever recovers, writes or takes changes back
// touches nothing outside of the folder. The first byte says whether the rest has a head with a good checksum, and what is done.

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "canopus/store/change_sets.hpp"

#include "input.hpp"

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using canopus::fuzz::expect;

constexpr const char* folder = "project";

/// Files in memory; folders are there as soon as one is in them.
class MemoryFiles final : public canopus::store::Files {
 public:
  std::expected<Bytes, int> read(const fs::path& path, std::size_t at_most) override {
    const auto found = files.find(inner(path));
    if (found == files.end()) return std::unexpected(ENOENT);
    if (found->second.size() > at_most) return std::unexpected(EFBIG);
    return found->second;
  }
  bool is_link(const fs::path& path) override { return inner(path) == "project/link"; }
  int make_folder(const fs::path& path) override {
    (void)changed(path);
    return 0;
  }
  std::expected<int, int> create(const fs::path& path) override {
    open_ = changed(path);
    files[open_].clear();
    return 3;
  }
  std::expected<std::size_t, int> write(int /*file*/, std::span<const std::uint8_t> bytes) override {
    files[open_].insert(files[open_].end(), bytes.begin(), bytes.end());
    return bytes.size();
  }
  int flush(int /*file*/) override { return 0; }
  void close(int /*file*/) noexcept override {}
  int rename(const fs::path& from, const fs::path& to) override {
    const auto found = files.find(changed(from));
    if (found == files.end()) return ENOENT;
    Bytes moved = std::move(found->second);
    files.erase(found);
    files[changed(to)] = std::move(moved);
    return 0;
  }
  int remove(const fs::path& path) override { return files.erase(changed(path)) == 1 ? 0 : ENOENT; }
  int flush_folder(const fs::path& /*path*/) override { return 0; }

  std::map<std::string, Bytes> files;
  bool may_change = true;

 private:
  /// Nothing else is looked at.
  static std::string inner(const fs::path& path) {
    const std::string name = path.lexically_normal().string();
    expect(name == folder || name.starts_with(std::string(folder) + '/'));
    return name;
  }
  std::string changed(const fs::path& path) const {
    expect(may_change);
    return inner(path);
  }
  std::string open_;
};

void append(Bytes& bytes, std::uint64_t value, unsigned size) {
  for (unsigned i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

Bytes with_head(std::span<const std::uint8_t> body) {
  Bytes file{'C', 'N', 'P', 'S', 1, 0, 0, 0};
  append(file, body.size(), 8);
  append(file, canopus::store::crc32(body), 4);
  file.insert(file.end(), body.begin(), body.end());
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using canopus::store::ChangeSets;
  if (size == 0) return 0;
  const unsigned what = data[0];
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  MemoryFiles files;
  files.files["project/.canopus/journal"] =
      (what & 1U) != 0 ? with_head(rest) : Bytes(rest.begin(), rest.end());
  files.files["project/a"] = {'o', 'l', 'd'};
  const auto before = files.files;

  files.may_change = false;
  ChangeSets looking(folder, files);
  if (looking.open_read_only()) {
    for (const char* name : {"a", "b/c", "link"}) (void)looking.read(name);
  }
  expect(files.files == before);

  files.may_change = true;
  ChangeSets changes(folder, files);
  if (!changes.recover()) return 0;
  if ((what & 2U) != 0) expect(changes.write({{"a", "new"}, {"b/c", std::nullopt}}, "a change").has_value());
  for (unsigned turn = 0; turn < ChangeSets::most_kept + 2; ++turn) {
    const auto undone = changes.undo();
    if (!undone || !*undone) break;
  }
  return 0;
}
