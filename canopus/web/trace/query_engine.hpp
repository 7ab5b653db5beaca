#pragma once
// The trace of a run's page: what is looked at of it, its statistics and its export. All of it runs in one thread, which need not
// be the plant's: it is given frames and questions, and knows nothing else of the plant.

#include <chrono>
#include <cstdint>
#include <deque>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/text/json.hpp"
#include "canopus/trace/file/trace_encoder.hpp"
#include "canopus/trace/report/statistics.hpp"
#include "canopus/web/trace/rows.hpp"
#include "canopus/web/trace/store.hpp"

namespace canopus::web {

class TraceQueryEngine {
 public:
  static constexpr std::size_t most_rows = 256;    ///< of an answer
  static constexpr std::size_t most_frames = 256;  ///< of a transfer that is opened
  static constexpr std::size_t most_queries =
      4;  ///< filters that are kept decoded; another one ends the oldest
  static constexpr std::size_t most_unasked = 256;    ///< answers of other filters, until one is kept no more
  static constexpr std::size_t part_frames = 16'384;  ///< that a part of an export covers
  static constexpr std::size_t slice = 2000;  ///< frames that are decoded before the clock is looked at
  using Json = text::Json;

  struct Use {
    trace::Names names{};
    std::vector<std::string> buses{};        ///< names, by channel
    std::vector<std::uint32_t> bit_rates{};  ///< of the same, bit/s
    std::size_t most = 1'000'000;            ///< frames that are kept
    /// Of the lines of all filters: then the filter goes that was looked at least lately, and of the last one the oldest lines. A
    /// million lines of a common trace have room.
    std::size_t most_bytes = 64U << 20;
    /// Called now and then in long work: false once it has taken long enough.
    std::function<bool()> has_time = [] { return true; };
  };
  explicit TraceQueryEngine(Use use);

  void add(std::span<const trace::TraceRecord> records);

  /// Of Use::most_bytes, those in use.
  [[nodiscard]] std::size_t bytes() const noexcept;

  using Answer = std::expected<Json, std::string>;  ///< the error is a sentence
  /// One of
  ///   {"filter": "...", "fold": true, "from": 1000, "count": 100}  lines from this number on; without "from" the newest; with
  ///                          "at": SECONDS in its place those about the first one at or after this moment, whose number is `at`
  ///   {"frames": RECORD}     frames of the SDO transfer to which this one belongs, up to it
  ///   {"statistics": true}
  /// as docs/web.md has the answers.
  [[nodiscard]] Answer answer(const text::Json& wish);

  /// {"filter": "...", "format": "candump", "part": 0}: the next part of the file: {"data": "base64", "frames": 12, "done": false, "at": 0.5};
  /// part 0 begins.
  [[nodiscard]] Answer export_part(const text::Json& wish);

 private:
  struct Query {
    std::string filter{};
    bool folded = true;
    std::unique_ptr<TraceRows> rows{};
    std::uint64_t asked = 0;  // number of the answer
  };
  struct Export {
    trace::FilterExpression filter{};
    trace::TraceEncoder encoder;
    std::unique_ptr<trace::Decoder> decoder{};
    std::uint64_t part = 0;
    std::uint64_t first = 0;
    std::uint64_t next = 0;
    std::uint64_t end = 0;
  };
  [[nodiscard]] std::expected<Query*, std::string> query(const std::string& filter, bool folded);
  void forget_unasked();
  void keep_within_bytes();
  [[nodiscard]] Answer rows_answer(const text::Json& wish);
  [[nodiscard]] Json frames_answer(std::uint64_t last);
  [[nodiscard]] Json statistics_answer();

  Use use_;
  TraceStore store_;
  std::deque<Query> queries_;      // the one that was looked at last in front
  std::uint64_t asked_count_ = 0;  // of rows
  std::optional<trace::Statistics> statistics_;
  std::unique_ptr<trace::Decoder> statistics_decoder_;
  std::uint64_t counted_ = 0;
  std::optional<Export> export_;
};

}  // namespace canopus::web
