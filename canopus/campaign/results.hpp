#pragma once
// The results of a campaign, or of a shard of it, in a folder: a line for each run as it ends, and when all are done one file,
// sorted. A process that is killed loses the runs that it was in, and nothing else.

#include <cstdint>
#include <cstdio>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/campaign/campaign.hpp"
#include "canopus/text/json.hpp"

namespace canopus::campaign {

struct FileCloser {
  void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
};
using FilePointer = std::unique_ptr<std::FILE, FileCloser>;

/// Run n of a campaign belongs to shard n % count + 1.
struct Shard {
  std::uint64_t number = 1;
  std::uint64_t count = 1;
  friend bool operator==(const Shard&, const Shard&) = default;
};
inline constexpr std::uint64_t most_shards = 100'000;
/// "3/16".
[[nodiscard]] std::expected<Shard, std::string> parse_shard(std::string_view text);

/// What the runs of a folder are runs of: its first line.
struct ResultsHead {
  std::string campaign{};
  std::string checksum{};
  std::uint64_t first_seed = 1;
  std::uint64_t seeds = 1;
  Shard shard{};
  std::vector<std::string> variants{};
  std::vector<std::string> invariants{};
  std::vector<std::string> canaries{};   ///< rules that must be found
  std::vector<std::string> sometimes{};  ///< invariants that must be reached

  [[nodiscard]] std::uint64_t runs() const noexcept { return seeds * variants.size(); }
};
[[nodiscard]] ResultsHead head_of(const Campaign& campaign, Shard shard);
[[nodiscard]] text::Json to_json(const ResultsHead& head);
[[nodiscard]] std::expected<ResultsHead, std::string> read_head(std::string_view line);

/// The number of the run that a line is of: seed by seed, and of each the variants in order. Nothing: it is no line of a run of this
/// campaign.
[[nodiscard]] std::optional<std::uint64_t> run_number(const ResultsHead& head, std::string_view line);
/// The line's fields; nothing: it is damaged.
[[nodiscard]] std::optional<text::Json> parse_run(std::string_view line);

/// A file that is written piece by piece. Before commit() there is what was there.
class FileDraft {
 public:
  /// Makes its folder, too. Errors are sentences.
  [[nodiscard]] static std::expected<FileDraft, std::string> create(const std::string& path);
  FileDraft(FileDraft&& other) noexcept = default;
  FileDraft& operator=(FileDraft&& other) = delete;
  ~FileDraft();

  void add(std::string_view text);
  [[nodiscard]] std::expected<void, std::string> commit();

 private:
  FileDraft() = default;
  std::string path_;
  std::string draft_;
  FilePointer file_;
  bool is_written_ = true;
};
/// Writes a file whole, or leaves what was there. The error is a sentence.
[[nodiscard]] std::expected<void, std::string> write_whole(const std::string& path, std::string_view text);

class Results {
 public:
  /// Opens or creates the folder; runs that it has are not run again. The error is a sentence.
  [[nodiscard]] static std::expected<Results, std::string> open(const std::string& folder,
                                                                const ResultsHead& head);

  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }
  [[nodiscard]] bool has(std::uint64_t number) const { return is_done_[number / head_.shard.count]; }
  [[nodiscard]] std::uint64_t done() const noexcept { return done_; }
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_; }
  /// The line of a run that it does not have. One thread at a time. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> add(std::uint64_t number, std::string_view line);
  /// Puts all lines in order into one file.
  [[nodiscard]] std::expected<void, std::string> finish();

 private:
  /// False: it is of another shard or beyond the last seed, or was noted before.
  bool note(std::uint64_t number, std::string_view line);
  std::string folder_;
  ResultsHead head_;
  std::vector<bool> is_done_;  // by their order in the shard
  std::uint64_t done_ = 0;
  std::uint64_t failed_ = 0;
  FilePointer appended_;
};

/// A folder of results whose runs are read when they are needed.
struct StoredResults {
  std::string folder{};
  ResultsHead head{};
};
[[nodiscard]] std::expected<StoredResults, std::string> read_results(const std::string& folder);
/// "night.results/results.jsonl"
[[nodiscard]] std::string results_path(const std::string& folder);

/// All runs in these folders up to the last seed of `head`, in order, each once. Memory: a buffer of each folder, whatever their
/// number of runs. The error is a sentence.
using EachRun = std::function<void(std::uint64_t number, const std::string& line)>;
[[nodiscard]] std::expected<void, std::string> each_run(const std::vector<StoredResults>& folders,
                                                        const ResultsHead& head, const EachRun& each);

}  // namespace canopus::campaign
