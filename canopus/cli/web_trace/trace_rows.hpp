#pragma once
// The lines of a trace that a filter lets through, decoded once and kept, so that any part of them can be shown at once.

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/analysis/filter_expression.hpp"
#include "canopus/cli/web_trace/trace_store.hpp"
#include "canopus/text/json.hpp"
#include "canopus/trace/decode/decoder.hpp"

namespace canopus::cli {

class TraceRows {
 public:
  /// `buses`: their names, by channel. `folded`: an SDO transfer is one line, that of its end.
  TraceRows(const trace::Names& names, const std::vector<std::string>& buses, FilterExpression filter,
            bool folded);

  /// Decodes up to `count` frames more. What the store has forgotten is forgotten here, too.
  void work(const TraceStore& store, std::size_t count);
  /// The frame that is decoded next.
  [[nodiscard]] std::uint64_t next_record() const noexcept { return next_; }

  /// Numbers of lines: the oldest that is kept, and the one that comes next.
  [[nodiscard]] std::uint64_t begin() const noexcept { return begin_; }
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }
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
    std::uint32_t text = 0;    // of the block's
    std::uint32_t frames = 0;  // of a transfer
    can::Duration duration{};
    can::Time time{};
    std::uint32_t identifier = 0;
    bool is_extended = false;
    bool is_trouble = false;
  };
  struct Block {
    std::vector<Row> rows{};
    std::string texts{};
  };
  static constexpr std::size_t block = 4096;

  void take(const trace::Message& message, std::uint64_t record);
  void forget(std::uint64_t first_record);

  std::vector<std::string> buses_;
  FilterExpression filter_;
  trace::Decoder decoder_;
  std::map<Head, char> heads_;  // a node of it stays where it is
  std::deque<Block> blocks_;    // all but the last are full
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t next_ = 0;
};

/// Bytes of a frame as hexadecimal digits.
[[nodiscard]] std::string hex_digits(std::span<const std::uint8_t> bytes);

}  // namespace canopus::cli
