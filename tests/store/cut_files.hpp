#pragma once
// A file system whose power can be cut at every system call and after every byte, and that then forgets what
// a real one may forget: names that were not flushed with their folder, and bytes not flushed with their
// file, come through, or not, or in part and in any order, whatever the dice say. Only a rename is in one
// step.

#include <cerrno>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "canopus/store/files.hpp"

namespace canopus::store {

/// Thrown at the moment of the cut.
struct PowerCut {};

class CutFiles final : public Files {
 public:
  static constexpr std::size_t write_at_most = 1024;  // of one call
  static constexpr std::size_t sector = 512;          // comes through whole or not at all

  /// The power goes off when so many system calls and bytes have been done.
  void cut_after(std::uint64_t steps) { steps_left_ = steps; }
  void never_cut() { steps_left_ = std::numeric_limits<std::uint64_t>::max(); }

  /// The power comes back: what is left is what the medium holds.
  void power_back(std::mt19937& random) {
    never_cut();
    open_.clear();
    for (auto& [path, folder] : folders_) {
      for (const NameChange& change : folder.pending) {
        if (random() % 2 == 0) apply(change, folder.durable);
      }
      folder.cached = folder.durable;
      folder.pending.clear();
      for (auto& [name, file] : folder.cached) survive(*file, random);
    }
    forget_lost_folders();
  }

  /// What a program sees of a file now; nullptr when it is not there.
  [[nodiscard]] std::vector<std::uint8_t>* content(const std::filesystem::path& path) {
    const auto file = find(path);
    return file == nullptr ? nullptr : &file->cached;
  }

  std::expected<std::vector<std::uint8_t>, int> read(const std::filesystem::path& path,
                                                     std::size_t at_most) override {
    step();
    const auto file = find(path);
    if (file == nullptr) return std::unexpected(ENOENT);
    if (file->cached.size() > at_most) return std::unexpected(EFBIG);
    return file->cached;
  }
  bool is_link(const std::filesystem::path& /*path*/) override { return false; }
  int make_folder(const std::filesystem::path& path) override {
    step();
    if (folders_.contains(path.string())) return EEXIST;
    const std::filesystem::path parent = path.parent_path();
    if (!parent.empty()) {
      const auto above = folders_.find(parent.string());
      if (above == folders_.end()) return ENOENT;
      change(above->second, {.name = path.filename().string(), .file = std::make_shared<File>()});
    }
    folders_[path.string()];
    return 0;
  }
  std::expected<int, int> create(const std::filesystem::path& path) override {
    step();
    Folder* folder = folder_of(path);
    if (folder == nullptr) return std::unexpected(ENOENT);
    std::shared_ptr<File> file = find(path);
    if (file == nullptr) {
      file = std::make_shared<File>();
      change(*folder, {.name = path.filename().string(), .file = file});
    }
    file->cached.clear();
    file->flushed = false;
    open_[++last_file_] = file;
    return last_file_;
  }
  std::expected<std::size_t, int> write(int file, std::span<const std::uint8_t> bytes) override {
    step();
    const std::size_t length = std::min(bytes.size(), write_at_most);
    const auto possible = static_cast<std::size_t>(std::min<std::uint64_t>(length, steps_left_));
    File& open = *open_.at(file);
    open.cached.insert(open.cached.end(), bytes.begin(),
                       bytes.begin() + static_cast<std::ptrdiff_t>(possible));
    open.flushed = false;
    steps_left_ -= possible;
    if (possible < length) throw PowerCut{};
    return length;
  }
  int flush(int file) override {
    step();
    File& open = *open_.at(file);
    open.durable = open.cached;
    open.flushed = true;
    return 0;
  }
  void close(int file) noexcept override { open_.erase(file); }
  int rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    step();
    Folder* folder = folder_of(from);
    const std::shared_ptr<File> file = find(from);
    if (file == nullptr || from.parent_path() != to.parent_path()) return ENOENT;
    change(*folder, {.name = to.filename().string(), .gone = from.filename().string(), .file = file});
    return 0;
  }
  int remove(const std::filesystem::path& path) override {
    step();
    if (find(path) == nullptr) return ENOENT;
    change(*folder_of(path), {.gone = path.filename().string()});
    return 0;
  }
  int flush_folder(const std::filesystem::path& path) override {
    step();
    const auto folder = folders_.find(path.string());
    if (folder == folders_.end()) return path == "." ? 0 : ENOENT;
    for (const NameChange& change : folder->second.pending) apply(change, folder->second.durable);
    folder->second.pending.clear();
    return 0;
  }

 private:
  struct File {
    std::vector<std::uint8_t> durable;  // at the last flush
    std::vector<std::uint8_t> cached;
    bool flushed = false;  // cached is durable
  };
  using Names = std::map<std::string, std::shared_ptr<File>>;
  struct NameChange {
    std::string name{};  // appears
    std::string gone{};  // disappears
    std::shared_ptr<File> file{};
  };
  struct Folder {
    Names durable;
    Names cached;
    std::vector<NameChange> pending;
  };

  void step() {
    if (steps_left_ == 0) throw PowerCut{};
    --steps_left_;
  }
  static void apply(const NameChange& change, Names& names) {
    if (!change.gone.empty()) names.erase(change.gone);
    if (!change.name.empty()) names[change.name] = change.file;
  }
  static void change(Folder& folder, NameChange change) {
    apply(change, folder.cached);
    folder.pending.push_back(std::move(change));
  }
  Folder* folder_of(const std::filesystem::path& path) {
    const auto found = folders_.find(path.parent_path().string());
    return found == folders_.end() ? nullptr : &found->second;
  }
  std::shared_ptr<File> find(const std::filesystem::path& path) {
    Folder* folder = folder_of(path);
    if (folder == nullptr) return nullptr;
    const auto found = folder->cached.find(path.filename().string());
    return found == folder->cached.end() ? nullptr : found->second;
  }
  // Of bytes that were not flushed: the old ones, the new ones, or new ones of any length with sectors
  // missing.
  static void survive(File& file, std::mt19937& random) {
    if (!file.flushed) {
      switch (random() % 4) {
        case 0: file.cached = file.durable; break;
        case 1: break;
        default: {
          if (!file.cached.empty()) file.cached.resize(random() % (file.cached.size() + 1));
          for (std::size_t first = 0; first < file.cached.size(); first += sector) {
            if (random() % 2 == 0) continue;
            const std::size_t last = std::min(first + sector, file.cached.size());
            for (std::size_t i = first; i < last; ++i) {
              file.cached[i] = i < file.durable.size() ? file.durable[i] : std::uint8_t{0};
            }
          }
        }
      }
    }
    file.durable = file.cached;
    file.flushed = true;
  }
  // A folder whose own name did not come through is lost with all that is in it. Parents come first in the
  // map.
  void forget_lost_folders() {
    for (auto folder = folders_.begin(); folder != folders_.end();) {
      const std::filesystem::path path = folder->first;
      const bool top = path.parent_path().empty();
      folder = top || find(path) != nullptr ? std::next(folder) : folders_.erase(folder);
    }
  }

  std::map<std::string, Folder> folders_;
  std::map<int, std::shared_ptr<File>> open_;
  int last_file_ = 0;
  std::uint64_t steps_left_ = std::numeric_limits<std::uint64_t>::max();
};

}  // namespace canopus::store
