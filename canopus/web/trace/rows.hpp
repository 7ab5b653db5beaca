#pragma once
// The lines of a trace that a filter lets through, decoded once and kept, so that any part of them can be shown at once.

#include <cstdint>
#include <deque>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/text/json.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/filter/filter_expression.hpp"
#include "canopus/web/trace/store.hpp"

namespace canopus::web {

class TraceRows {
 public:
  /// `buses`: their names, by channel. `folded`: an SDO transfer is one line, that of its end.
  TraceRows(const trace::Names& names, const std::vector<std::string>& buses, trace::FilterExpression filter,
            bool folded);

  /// Decodes up to `count` frames more. What the store has forgotten is forgotten here, too.
  void work(const TraceStore& store, std::size_t count);
  /// The oldest lines go, some thousand; none of those that came last.
  void forget_oldest();
  /// That the lines take, about.
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_ + bytes_of_last_; }
  /// The frame that is decoded next.
  [[nodiscard]] std::uint64_t next_record() const noexcept { return next_; }

  /// Numbers of lines: the oldest that is kept, and the one that comes next.
  [[nodiscard]] std::uint64_t begin() const noexcept { return begin_; }
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }
  /// The first line at or after this moment; end(): there is none.
  [[nodiscard]] std::uint64_t first_at(can::Time time) const noexcept;
  /// One from begin() up to end(), as docs/events.md has it.
  [[nodiscard]] text::Json row(std::uint64_t number, const TraceStore& store) const;

 private:
  /// What many lines have in common.
  struct Head {
    std::uint16_t bus = 0;
    trace::Service service = trace::Service::layer2;
    std::string what{};
    std::uint8_t node = 0;
    std::string node_name{};
    std::string object{};
    auto operator<=>(const Head&) const = default;
  };
  struct Row {
    std::uint64_t record = 0;
    const Head* head = nullptr;
    can::Time time{};
    std::uint32_t text = 0;  // of the block's
    std::uint32_t identifier : 29 = 0;
    std::uint32_t is_extended : 1 = 0;
    std::uint32_t is_trouble : 1 = 0;
    std::uint32_t is_transfer : 1 = 0;
  };
  static_assert(sizeof(Row) == 32);
  struct Transfer {
    std::uint32_t place = 0;  // of its row
    std::uint32_t frames = 0;
    can::Duration duration{};
  };
  struct Block {
    std::vector<Row> rows{};
    std::vector<Transfer> transfers{};
    std::string texts{};
    std::set<Head> heads{};
    std::size_t head_bytes = 0;

    [[nodiscard]] std::size_t bytes() const noexcept;
  };
  static constexpr std::size_t block = 4096;

  [[nodiscard]] Block& block_for_next();
  void add(const trace::Message& message, std::uint64_t record);
  void forget(std::uint64_t first_record);

  std::vector<std::string> buses_;
  trace::FilterExpression filter_;
  trace::Decoder decoder_;
  std::deque<Block> blocks_;       // all but the last are full
  std::size_t bytes_ = 0;          // of all blocks but the last ...
  std::size_t bytes_of_last_ = 0;  // ... and of that
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t next_ = 0;
};

}  // namespace canopus::web
