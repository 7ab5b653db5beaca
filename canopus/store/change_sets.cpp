#include "canopus/store/change_sets.hpp"

#include <cerrno>
#include <span>
#include <utility>

#include "canopus/can/little_endian.hpp"
#include "canopus/store/inner_path.hpp"

namespace canopus::store {
namespace {

constexpr std::string_view journal_name = "journal";

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

void append(std::vector<std::uint8_t>& bytes, std::string_view text) {
  can::append_value(bytes, text.size(), 4);
  const auto more = bytes_of(text);
  bytes.insert(bytes.end(), more.begin(), more.end());
}

void append(std::vector<std::uint8_t>& bytes, const FileContents& contents) {
  can::append_value(bytes, contents.size(), 4);
  for (const auto& [name, content] : contents) {
    append(bytes, name);
    bytes.push_back(content ? 1 : 0);
    if (content) append(bytes, *content);
  }
}

std::optional<std::uint32_t> checksum(const std::optional<std::string>& content) {
  return content ? std::optional(crc32(bytes_of(*content))) : std::nullopt;
}

std::size_t size_of(const FileContents& contents) {
  std::size_t size = 0;
  for (const auto& [name, content] : contents) size += name.size() + (content ? content->size() : 0);
  return size;
}

}  // namespace

/// Parses a journal; missing bytes read as zero and make is_whole() false.
class ChangeSets::Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  std::uint32_t number(std::size_t size) {
    if (left_.size() < size) {
      is_whole_ = false;
      return 0;
    }
    const auto value = static_cast<std::uint32_t>(can::load_value(left_.first(size)));
    left_ = left_.subspan(size);
    return value;
  }
  /// The number of following items of at least one byte.
  std::uint32_t count() {
    const std::uint32_t value = number(4);
    if (value > left_.size()) is_whole_ = false;
    return is_whole_ ? value : 0;
  }
  std::string text() {
    const std::uint32_t size = count();
    std::string value(reinterpret_cast<const char*>(left_.data()), size);
    left_ = left_.subspan(size);
    return value;
  }
  FileContents contents() {
    FileContents all;
    for (std::uint32_t left = count(); left > 0 && is_whole_; --left) {
      std::string name = text();
      std::optional<std::string> content;
      if (number(1) != 0) content = text();
      all.insert_or_assign(std::move(name), std::move(content));
    }
    return all;
  }
  [[nodiscard]] bool is_whole() const noexcept { return is_whole_; }
  [[nodiscard]] bool has_more() const noexcept { return is_whole_ && !left_.empty(); }

 private:
  std::span<const std::uint8_t> left_;
  bool is_whole_ = true;
};

ChangeSets::Done ChangeSets::check(const std::filesystem::path& name) {
  return check_inner_path(*files_, folder_, name.string());
}

/// Checks the names in a journal, by their spelling alone: a file that became a link since must not make the
/// others inaccessible.
ChangeSets::Done ChangeSets::check_names(const Journal& journal) {
  const auto check_all = [this](const FileContents& contents) -> Done {
    for (const auto& [name, content] : contents) {
      if (auto good = check_inner_name(name); !good) {
        return std::unexpected(name_of(records_ / journal_name) + ": " + good.error());
      }
    }
    return {};
  };
  if (auto good = check_all(journal.pending); !good) return good;
  if (auto good = check_all(journal.before.value_or(FileContents{})); !good) return good;
  for (const Record& record : journal.records) {
    if (auto good = check_all(record.before); !good) return good;
  }
  return {};
}

std::expected<ChangeSets::Journal, std::string> ChangeSets::load() {
  if (auto good = check(records_ / journal_name); !good) return std::unexpected(std::move(good.error()));
  const auto stored = journal_.read(journal_name);
  if (stored.state == module::NonVolatileMemory::Content::State::missing) return Journal{};
  if (stored.state != module::NonVolatileMemory::Content::State::good) {
    return std::unexpected(journal_.damage(journal_name));
  }
  Reader reader(stored.bytes);
  Journal journal;
  journal.pending = reader.contents();
  for (std::uint32_t left = reader.count(); left > 0 && reader.is_whole(); --left) {
    Record record;
    record.title = reader.text();
    record.before = reader.contents();
    for (const auto& [name, content] : record.before) {
      const bool is_there = reader.number(1) != 0;
      const std::uint32_t sum = reader.number(4);
      record.after[name] = is_there ? std::optional(sum) : std::nullopt;
    }
    journal.records.push_back(std::move(record));
  }
  if (reader.has_more()) journal.before = reader.contents();
  if (!reader.is_whole()) return std::unexpected(name_of(records_ / journal_name) + ": is damaged");
  if (auto good = check_names(journal); !good) return std::unexpected(std::move(good.error()));
  return journal;
}

ChangeSets::Done ChangeSets::save(const Journal& journal) {
  Bytes bytes;
  append(bytes, journal.pending);
  can::append_value(bytes, journal.records.size(), 4);
  for (const Record& record : journal.records) {
    append(bytes, record.title);
    append(bytes, record.before);
    for (const auto& [name, sum] : record.after) {
      bytes.push_back(sum ? 1 : 0);
      can::append_value(bytes, sum.value_or(0), 4);
    }
  }
  if (journal.before) append(bytes, *journal.before);
  if (auto good = check(records_ / journal_name); !good) return good;
  if (!journal_.write(journal_name, bytes)) return std::unexpected(journal_.error());
  return {};
}

std::expected<std::optional<std::string>, std::string> ChangeSets::read(const std::string& name) {
  if (const auto before = before_.find(name); before != before_.end()) return before->second;
  if (auto good = check(name); !good) return std::unexpected(std::move(good.error()));
  const auto bytes = files_->read(folder_ / name, longest_file);
  if (bytes) return std::string(bytes->begin(), bytes->end());
  if (bytes.error() == ENOENT || bytes.error() == ENOTDIR) return std::nullopt;
  return std::unexpected(name_of(name) + ": " + describe_error(bytes.error()));
}

ChangeSets::Done ChangeSets::put(const std::string& name, const std::optional<std::string>& content) {
  const std::filesystem::path path = folder_ / name;
  const auto failed = [&path](int why) {
    return std::unexpected(path.string() + ": " + describe_error(why));
  };
  if (!content) {
    const int why = files_->remove(path);
    if (why != 0 && why != ENOENT && why != ENOTDIR) return failed(why);
    files_->flush_folder(path.parent_path());
    return {};
  }
  if (const int why = make_folders(*files_, path.parent_path()); why != 0) return failed(why);
  std::filesystem::path beside = path;
  beside += ".new";
  const auto file = files_->create(beside);
  if (!file) return failed(file.error());
  auto left = bytes_of(*content);
  int why = 0;
  while (!left.empty() && why == 0) {
    const auto written = files_->write(*file, left);
    if (written) left = left.subspan(*written);
    why = written ? 0 : written.error();
  }
  if (why == 0) why = files_->flush(*file);
  files_->close(*file);
  if (why == 0) why = files_->rename(beside, path);
  if (why != 0) {
    static_cast<void>(files_->remove(beside));
    return failed(why);
  }
  files_->flush_folder(path.parent_path());
  return {};
}

/// `journal` has something pending.
ChangeSets::Done ChangeSets::carry_out(Journal journal) {
  for (const auto& [name, content] : journal.pending) {
    if (auto good = check(name); !good) return good;
  }
  for (const auto& [name, content] : journal.pending) {
    if (auto done = put(name, content); !done) return done;
  }
  journal.pending.clear();
  journal.before.reset();
  return save(journal);
}

ChangeSets::Done ChangeSets::recover() {
  auto journal = load();
  if (!journal) return std::unexpected(std::move(journal.error()));
  if (journal->pending.empty()) return {};
  return carry_out(std::move(*journal));
}

std::expected<bool, std::string> ChangeSets::open_read_only() {
  before_.clear();
  auto journal = load();
  if (!journal) return std::unexpected(std::move(journal.error()));
  if (journal->pending.empty()) return false;
  if (journal->before) {
    before_ = std::move(*journal->before);
  } else if (!journal->records.empty()) {
    before_ = std::move(journal->records.back().before);
  }
  std::erase_if(before_, [&](const auto& file) { return !journal->pending.contains(file.first); });
  return true;
}

std::string ChangeSets::unfinished_change(std::string_view journal) {
  return std::string(journal) +
         ": a change is not finished (a power cut, or another command at work); this is the project before "
         "it, and "
         "the next command that changes the project finishes it first";
}

void ChangeSets::drop_oldest(std::vector<Record>& records) {
  std::size_t bytes = 0;
  std::size_t kept = 0;
  while (kept < records.size() && kept < most_kept) {
    bytes += size_of(records[records.size() - 1 - kept].before);
    if (kept > 0 && bytes > most_bytes_kept) break;
    ++kept;
  }
  records.erase(records.begin(), records.end() - static_cast<std::ptrdiff_t>(kept));
}

ChangeSets::Done ChangeSets::write(const FileContents& contents, std::string_view title) {
  auto journal = load();
  if (!journal) return std::unexpected(std::move(journal.error()));
  Record record{.title = std::string(title), .before = {}, .after = {}};
  for (const auto& [name, content] : contents) {
    auto before = read(name);
    if (!before) return std::unexpected(std::move(before.error()));
    if (*before == content) continue;
    record.after[name] = checksum(content);
    record.before[name] = std::move(*before);
    journal->pending[name] = content;
  }
  if (journal->pending.empty()) return {};
  const Journal old{.pending = record.before, .records = journal->records, .before = record.before};
  journal->records.push_back(std::move(record));
  drop_oldest(journal->records);
  if (auto saved = save(*journal); !saved) return saved;
  auto done = carry_out(std::move(*journal));
  if (done) return {};
  // A full disk, a folder that may not be written: all is as it was again.
  if (auto saved = save(old); saved) static_cast<void>(carry_out(old));
  return done;
}

std::expected<std::optional<std::string>, std::string> ChangeSets::undo() {
  auto journal = load();
  if (!journal) return std::unexpected(std::move(journal.error()));
  if (journal->records.empty()) return std::nullopt;
  Record record = std::move(journal->records.back());
  journal->before.emplace();
  for (const auto& [name, sum] : record.after) {
    auto now = read(name);
    if (!now) return std::unexpected(now.error());
    if (checksum(*now) != sum) {
      return std::unexpected(name_of(name) + ": has been changed since \"" + record.title +
                             "\", which can therefore not be taken back");
    }
    journal->before->emplace(name, std::move(*now));
  }
  journal->records.pop_back();
  journal->pending = std::move(record.before);
  if (auto saved = save(*journal); !saved) return std::unexpected(std::move(saved.error()));
  if (auto done = carry_out(std::move(*journal)); !done) return std::unexpected(std::move(done.error()));
  return std::move(record.title);
}

}  // namespace canopus::store
