#include "canopus/campaign/results.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <functional>
#include <queue>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace canopus::campaign {
namespace {

namespace fs = std::filesystem;
using Result = std::expected<void, std::string>;

constexpr std::string_view sorted_name = "results.jsonl";
constexpr std::string_view growing_name = "results.part.jsonl";
constexpr std::string_view failed_mark = "\"outcome\":\"failed\"";
constexpr std::size_t longest_line = std::size_t{1} << 20U;
constexpr text::JsonLimits line_limits{.bytes = longest_line, .depth = 16};

std::string in(const std::string& folder, std::string_view name) {
  return (fs::path(folder) / name).string();
}

std::string reason() { return std::strerror(errno); }

/// The whole lines of a file, one after the other. A torn last line is left out. The file is open while it is read alone: there may be
/// more shards than a process may have files.
class LineReader {
 public:
  explicit LineReader(std::string path, std::size_t block = std::size_t{256} << 10U)
      : path_(std::move(path)), block_(block) {}

  /// False: there is none any more. The error is a sentence.
  std::expected<bool, std::string> next() {
    std::size_t end = text_.find('\n', at_);
    while (end == std::string::npos) {
      text_.erase(0, std::exchange(at_, 0));
      if (text_.size() > longest_line) return too_long();
      const std::size_t before = text_.size();
      if (const Result good = read_block(); !good) return std::unexpected(good.error());
      if (text_.size() == before) return false;
      end = text_.find('\n', before);
    }
    if (end - at_ > longest_line) return too_long();
    line_ = std::string_view(text_).substr(at_, end - at_);
    begin_ = end_;
    end_ += line_.size() + 1;
    at_ = end + 1;
    ++number_;
    return true;
  }
  [[nodiscard]] std::string_view line() const noexcept { return line_; }
  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }  ///< of the line, from 1
  [[nodiscard]] std::uint64_t begin() const noexcept { return begin_; }    ///< where it begins in the file
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }        ///< where the next one does
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  [[nodiscard]] std::unexpected<std::string> too_long() const {
    return std::unexpected(fmt::format("{}:{}: the line is longer than 1 MiB", path_, number_ + 1));
  }
  Result read_block() {
    const FilePointer file(std::fopen(path_.c_str(), "rb"));
    if (file == nullptr || ::fseeko(file.get(), static_cast<off_t>(read_), SEEK_SET) != 0)
      return std::unexpected(fmt::format("cannot read {}: {}", path_, reason()));
    const std::size_t before = text_.size();
    text_.resize(before + block_);
    const std::size_t count = std::fread(text_.data() + before, 1, block_, file.get());
    text_.resize(before + count);
    read_ += count;
    if (std::ferror(file.get()) != 0)
      return std::unexpected(fmt::format("cannot read {}: {}", path_, reason()));
    return {};
  }

  std::string path_;
  std::size_t block_;
  std::string text_;
  std::string_view line_;
  std::size_t at_ = 0;
  std::uint64_t read_ = 0;
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t number_ = 0;
};

/// Calls `each` with every line behind the head, and gives the head; nothing: not even that is whole.
template <typename Each>
std::expected<std::optional<ResultsHead>, std::string> each_line(LineReader& reader, Each each) {
  std::optional<ResultsHead> head;
  while (true) {
    const auto more = reader.next();
    if (!more) return std::unexpected(more.error());
    if (!*more) return head;
    if (head) {
      each(*head, reader);
      continue;
    }
    auto found = read_head(reader.line());
    if (!found) return std::unexpected(fmt::format("{}:1: {}", reader.path(), found.error()));
    head = std::move(*found);
  }
}

/// Runs of one file, by their numbers.
class RunSource {
 public:
  RunSource() = default;
  virtual ~RunSource() = default;
  RunSource(const RunSource&) = delete;
  RunSource& operator=(const RunSource&) = delete;
  /// False: there is none any more. The error is a sentence.
  virtual std::expected<bool, std::string> next() = 0;
  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
  [[nodiscard]] const std::string& line() const noexcept { return line_; }

 protected:
  std::uint64_t number_ = 0;
  std::string line_;
};

/// results.jsonl, which is in order.
class SortedRuns final : public RunSource {
 public:
  SortedRuns(std::string path, const ResultsHead& head, std::size_t block)
      : reader_(std::move(path), block), head_(head) {}

  std::expected<bool, std::string> next() override {
    while (true) {
      const auto more = reader_.next();
      if (!more || !*more) return more;
      const auto number = run_number(head_, reader_.line());
      if (!number) continue;
      if (has_one_ && *number < number_)
        return std::unexpected(
            fmt::format("{}:{}: the run is out of order; expected runs by seed and variant", reader_.path(),
                        reader_.number()));
      has_one_ = true;
      number_ = *number;
      line_ = reader_.line();
      return true;
    }
  }

 private:
  LineReader reader_;
  const ResultsHead& head_;
  bool has_one_ = false;
};

/// results.part.jsonl, in the order in which the runs ended. Of each run its place in the file is kept.
class UnsortedRuns final : public RunSource {
 public:
  static std::expected<std::unique_ptr<RunSource>, std::string> open(const std::string& path,
                                                                     const ResultsHead& head) {
    auto runs = std::make_unique<UnsortedRuns>();
    runs->path_ = path;
    LineReader reader(path);
    const auto read = each_line(reader, [&](const ResultsHead&, const LineReader& at) {
      if (const auto number = run_number(head, at.line()))
        runs->places_.push_back({*number, at.begin(), static_cast<std::uint32_t>(at.line().size())});
    });
    if (!read) return std::unexpected(read.error());
    std::ranges::stable_sort(runs->places_, {}, &RunPlace::number);
    return runs;
  }
  std::expected<bool, std::string> next() override {
    if (next_ == places_.size()) return false;
    const RunPlace& place = places_[next_++];
    const FilePointer file(std::fopen(path_.c_str(), "rb"));
    line_.resize(place.length);
    if (file == nullptr || ::fseeko(file.get(), static_cast<off_t>(place.begin), SEEK_SET) != 0 ||
        std::fread(line_.data(), 1, line_.size(), file.get()) != line_.size()) {
      return std::unexpected(fmt::format("cannot read {}: {}", path_, reason()));
    }
    number_ = place.number;
    return true;
  }

 private:
  struct RunPlace {
    std::uint64_t number;
    std::uint64_t begin;
    std::uint32_t length;
  };
  std::string path_;
  std::vector<RunPlace> places_;
  std::size_t next_ = 0;
};

std::expected<std::vector<std::string>, std::string> names_of(const text::Json& object,
                                                              std::string_view key) {
  std::vector<std::string> names;
  const auto list = object.find(key);
  if (list == object.end() || !list->is_array()) return std::unexpected(fmt::format("{} is missing", key));
  for (const text::Json& name : *list) {
    if (!name.is_string()) return std::unexpected(fmt::format("{}: expected names", key));
    names.push_back(name.string());
  }
  return names;
}

std::uint64_t read_number(const text::Json& object, std::string_view key) {
  const auto member = object.find(key);
  return member != object.end() && member->is_number_unsigned() ? member->get<std::uint64_t>() : 0;
}

}  // namespace

std::expected<Shard, std::string> parse_shard(std::string_view text) {
  Shard shard;
  const auto number = [&](std::string_view digits, std::uint64_t& value) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc{} && end == digits.data() + digits.size();
  };
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos && number(text.substr(0, slash), shard.number) &&
      number(text.substr(slash + 1), shard.count) && shard.number >= 1 && shard.number <= shard.count &&
      shard.count <= most_shards) {
    return shard;
  }
  return std::unexpected(
      fmt::format("\"{}\": expected a shard as 3/16: its number, from 1, and how many there are", text));
}

ResultsHead head_of(const Campaign& campaign, Shard shard) {
  ResultsHead head{.campaign = campaign.file.name,
                   .checksum = campaign.checksum,
                   .first_seed = campaign.file.first_seed,
                   .seeds = campaign.file.seeds,
                   .shard = shard};
  for (const Variant& variant : campaign.file.variants) head.variants.push_back(variant.name);
  for (const Rule& rule : campaign.file.rules) {
    if (rule.is_canary) head.canaries.push_back(rule.name);
  }
  for (const Invariant& invariant : campaign.file.invariants) {
    head.invariants.push_back(invariant.name);
    if (invariant.expectation == Expectation::sometimes) head.sometimes.push_back(invariant.name);
  }
  return head;
}

text::Json to_json(const ResultsHead& head) {
  return {{"campaign", head.campaign},
          {"checksum", head.checksum},
          {"first_seed", head.first_seed},
          {"seeds", head.seeds},
          {"shard", head.shard.number},
          {"shards", head.shard.count},
          {"variants", text::Json(head.variants)},
          {"invariants", text::Json(head.invariants)},
          {"canaries", text::Json(head.canaries)},
          {"sometimes", text::Json(head.sometimes)}};
}

std::expected<ResultsHead, std::string> read_head(std::string_view line) {
  const auto object = text::parse_json(line, line_limits);
  if (!object || !object->is_object()) return std::unexpected("expected the head of a file of results");
  ResultsHead head{.campaign = object->value("campaign", ""),
                   .checksum = object->value("checksum", ""),
                   .first_seed = read_number(*object, "first_seed"),
                   .seeds = read_number(*object, "seeds"),
                   .shard = {read_number(*object, "shard"), read_number(*object, "shards")}};
  for (const auto& [key, names] :
       {std::pair{"variants", &head.variants}, std::pair{"invariants", &head.invariants},
        std::pair{"canaries", &head.canaries}, std::pair{"sometimes", &head.sometimes}}) {
    auto read = names_of(*object, key);
    if (!read) return std::unexpected(read.error());
    *names = std::move(*read);
  }
  const bool is_good = head.seeds >= 1 && head.seeds <= most_seeds && !head.variants.empty() &&
                       head.variants.size() <= most_variants && head.shard.number >= 1 &&
                       head.shard.number <= head.shard.count && head.shard.count <= most_shards;
  if (!is_good) return std::unexpected("expected the head of a file of results");
  return head;
}

std::optional<std::uint64_t> run_number(const ResultsHead& head, std::string_view line) {
  constexpr std::string_view before_seed = "{\"seed\":";
  constexpr std::string_view before_variant = ",\"variant\":";
  if (!line.starts_with(before_seed) || !line.ends_with('}')) return std::nullopt;
  line.remove_prefix(before_seed.size());
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), seed);
  if (error != std::errc{} || seed < head.first_seed || seed - head.first_seed >= most_seeds)
    return std::nullopt;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  if (!line.starts_with(before_variant)) return std::nullopt;
  line.remove_prefix(before_variant.size());
  for (std::size_t i = 0; i < head.variants.size(); ++i) {
    if (line.starts_with(text::Json(head.variants[i]).dump() + ','))
      return (seed - head.first_seed) * head.variants.size() + i;
  }
  return std::nullopt;
}

std::optional<text::Json> parse_run(std::string_view line) {
  auto run = text::parse_json(line, line_limits);
  if (!run || !run->is_object() || !run->contains("checksum")) return std::nullopt;
  return std::move(*run);
}

std::expected<FileDraft, std::string> FileDraft::create(const std::string& path) {
  FileDraft file;
  file.path_ = path;
  file.draft_ = fmt::format("{}.{}.part", path, ::getpid());
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  file.file_.reset(std::fopen(file.draft_.c_str(), "wb"));
  if (file.file_ == nullptr) return std::unexpected(fmt::format("cannot write {}: {}", path, reason()));
  return file;
}

FileDraft::~FileDraft() {
  if (file_ != nullptr) (void)std::remove(draft_.c_str());
}

void FileDraft::add(std::string_view text) {
  is_written_ = is_written_ && std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size();
}

Result FileDraft::commit() {
  const bool is_closed = std::fclose(file_.release()) == 0;
  if (is_written_ && is_closed && std::rename(draft_.c_str(), path_.c_str()) == 0) return {};
  const std::string why = reason();
  (void)std::remove(draft_.c_str());
  return std::unexpected(fmt::format("cannot write {}: {}", path_, why));
}

Result write_whole(const std::string& path, std::string_view text) {
  auto file = FileDraft::create(path);
  if (!file) return std::unexpected(file.error());
  file->add(text);
  return file->commit();
}

std::expected<Results, std::string> Results::open(const std::string& folder, const ResultsHead& head) {
  Results results;
  results.folder_ = folder;
  results.head_ = head;
  results.is_done_.assign(head.runs() / head.shard.count + 1, false);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return std::unexpected(fmt::format("cannot create {}: {}", folder, error.message()));
  const std::string growing = in(folder, growing_name);
  std::uint64_t whole = 0;  // bytes of the growing file up to a torn line
  for (const std::string& path : {results_path(folder), growing}) {
    if (!fs::exists(path)) continue;
    LineReader reader(path);
    const auto found = each_line(reader, [&](const ResultsHead& of, const LineReader& at) {
      const auto number = of.checksum == head.checksum ? run_number(head, at.line()) : std::nullopt;
      if (number) (void)results.note(*number, at.line());
    });
    if (!found) return std::unexpected(found.error());
    if (path == growing) whole = reader.end();
    if (!*found) continue;  // a torn head
    if ((*found)->checksum != head.checksum || (*found)->shard != head.shard) {
      return std::unexpected(fmt::format(
          "{} has results of {}; expected an empty folder, or results of this campaign (--results names "
          "another one)",
          folder,
          (*found)->shard == head.shard ? "another campaign, or of this one before its files changed"
                                        : "another shard"));
    }
  }
  // A torn last line must not get another one behind it.
  if (whole != 0) fs::resize_file(growing, whole, error);
  if (error) return std::unexpected(fmt::format("cannot write {}: {}", growing, error.message()));
  results.appended_.reset(std::fopen(growing.c_str(), whole == 0 ? "wb" : "ab"));
  const std::string first = to_json(head).dump() + '\n';
  const bool is_written =
      results.appended_ != nullptr &&
      (whole != 0 || std::fwrite(first.data(), 1, first.size(), results.appended_.get()) == first.size()) &&
      std::fflush(results.appended_.get()) == 0;
  if (!is_written) return std::unexpected(fmt::format("cannot write {}: {}", growing, reason()));
  return results;
}

bool Results::note(std::uint64_t number, std::string_view line) {
  if (number >= head_.runs() || number % head_.shard.count != head_.shard.number - 1 || has(number))
    return false;
  is_done_[number / head_.shard.count] = true;
  ++done_;
  if (line.contains(failed_mark)) ++failed_;
  return true;
}

Result Results::add(std::uint64_t number, std::string_view line) {
  const std::string text = std::string(line) + '\n';
  const bool is_written = std::fwrite(text.data(), 1, text.size(), appended_.get()) == text.size() &&
                          std::fflush(appended_.get()) == 0;
  if (!is_written)
    return std::unexpected(fmt::format("cannot write {}: {}", in(folder_, growing_name), reason()));
  (void)note(number, line);
  return {};
}

Result Results::finish() {
  auto file = FileDraft::create(results_path(folder_));
  if (!file) return std::unexpected(file.error());
  file->add(to_json(head_).dump() + '\n');
  const Result read = each_run({{folder_, head_}}, head_, [&](std::uint64_t, const std::string& line) {
    file->add(line);
    file->add("\n");
  });
  if (!read) return read;
  if (Result written = file->commit(); !written) return written;
  appended_.reset();
  std::error_code unimportant;
  fs::remove(in(folder_, growing_name), unimportant);
  return {};
}

std::string results_path(const std::string& folder) { return in(folder, sorted_name); }

std::expected<StoredResults, std::string> read_results(const std::string& folder) {
  std::optional<ResultsHead> head;
  for (const std::string_view name : {sorted_name, growing_name}) {
    const std::string path = in(folder, name);
    if (!fs::exists(path)) continue;
    LineReader reader(path, longest_line);
    const auto more = reader.next();
    if (!more) return std::unexpected(more.error());
    if (!*more) continue;
    auto found = read_head(reader.line());
    if (!found) return std::unexpected(fmt::format("{}:1: {}", path, found.error()));
    if (!head || (found->checksum == head->checksum && found->seeds > head->seeds)) head = std::move(*found);
  }
  if (!head) return std::unexpected(fmt::format("{} has no {} of a campaign", folder, sorted_name));
  return StoredResults{folder, std::move(*head)};
}

Result each_run(const std::vector<StoredResults>& folders, const ResultsHead& head, const EachRun& each) {
  constexpr std::size_t all_blocks = std::size_t{64} << 20U;
  const std::size_t block = std::clamp(all_blocks / std::max<std::size_t>(folders.size(), 1),
                                       std::size_t{4096}, std::size_t{256} << 10U);
  std::vector<std::unique_ptr<RunSource>> sources;
  for (const StoredResults& folder : folders) {
    if (fs::exists(results_path(folder.folder)))
      sources.push_back(std::make_unique<SortedRuns>(results_path(folder.folder), head, block));
    const std::string growing = in(folder.folder, growing_name);
    if (!fs::exists(growing)) continue;
    auto runs = UnsortedRuns::open(growing, head);
    if (!runs) return std::unexpected(runs.error());
    sources.push_back(std::move(*runs));
  }
  using Next = std::pair<std::uint64_t, std::size_t>;  // number of a run, and its source
  std::priority_queue<Next, std::vector<Next>, std::greater<>> waiting;
  const auto advance = [&](std::size_t source) -> Result {
    const auto more = sources[source]->next();
    if (!more) return std::unexpected(more.error());
    if (*more) waiting.emplace(sources[source]->number(), source);
    return {};
  };
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (Result good = advance(i); !good) return good;
  }
  std::optional<std::uint64_t> last;
  while (!waiting.empty()) {
    const auto [number, source] = waiting.top();
    waiting.pop();
    if (number != last && number < head.runs()) each(number, sources[source]->line());
    last = number;
    if (Result good = advance(source); !good) return good;
  }
  return {};
}

}  // namespace canopus::campaign
