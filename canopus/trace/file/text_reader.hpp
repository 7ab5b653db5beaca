#pragma once
// The loop of the readers of text formats: line by line, an error in one line does not end the trace.

#include <string>
#include <string_view>
#include <utility>

#include "canopus/ascii/number.hpp"
#include "canopus/can/time.hpp"
#include "canopus/trace/file/reader_base.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {

/// Times of formats that write seconds from 0 to 59.999 and no minute.
class MinuteClock {
 public:
  /// `start`: time of day at which the trace begins.
  explicit MinuteClock(can::Duration start = {})
      : minute_(std::chrono::floor<std::chrono::minutes>(start)), last_(start - minute_.time_since_epoch()) {}

  /// A time that goes back by more than half a minute is in the next one; channels may be a little out of order.
  [[nodiscard]] can::Time at(can::Duration of_minute) noexcept {
    constexpr can::Duration half = std::chrono::seconds(30);
    if (last_ - of_minute > half) minute_ = can::later(minute_, std::chrono::minutes(1));
    last_ = of_minute;
    return can::later(minute_, of_minute);
  }

 private:
  can::Time minute_;
  can::Duration last_;
};

class TextReader : public ReaderBase {
 public:
  [[nodiscard]] NextRecord next() final {
    while (const auto line = input_.line(line_end_)) {
      if (input_.is_cut())
        return fail(": expected a line of at most " + std::to_string(trace_max_line) + " bytes");
      TraceRecord record;
      switch (read_line(*line, record)) {
        case Found::record: return record;
        case Found::nothing: break;
        case Found::mistake: return fail(mistake_);
      }
    }
    if (auto failure = input_.failure(); failure && !failed_) {
      failed_ = true;
      return std::unexpected(std::move(*failure));
    }
    return std::nullopt;
  }

 protected:
  enum class Found : std::uint8_t {
    record,
    nothing,  ///< an empty line, a head, or what is left out
    mistake,  ///< mistake_ names what was expected
  };
  using ReaderBase::ReaderBase;
  [[nodiscard]] virtual Found read_line(std::string_view line, TraceRecord& record) = 0;
  Found mistake(std::string expected) {
    mistake_ = ": " + std::move(expected);
    return Found::mistake;
  }
  /// The same with a column, from 1.
  Found mistake(std::size_t column, const std::string& expected) {
    mistake_ = ':' + std::to_string(column) + ": " + expected;
    return Found::mistake;
  }
  Found leave_out(LeftOutKind kind) {
    left_out_.add(kind);
    return Found::nothing;
  }
  /// The channel of a format that numbers its channels; the end of every read_line() with a record.
  Found on_channel(std::string_view name, TraceRecord& record) {
    const auto number = channels_.number_of(name);
    if (!number)
      return mistake("expected at most " + std::to_string(ChannelNames::max_channels) + " channels");
    record.channel = *number;
    return Found::record;
  }
  /// The frame's data, as many words as it has bytes; base 10 or 16, `0x` before a byte is skipped. A longer number is
  /// what stands behind the data.
  Found read_data(Words& words, can::Frame& frame, int base) {
    for (std::size_t i = 0; i < frame.length(); ++i) {
      const std::string_view word = words.next();
      const auto byte = parse_digits(word, base);
      if (!byte || *byte > 255 || word.size() > 4)
        return mistake(words.column(), "expected a byte of data, found " + shown(word));
      frame.data[i] = static_cast<std::uint8_t>(*byte);
    }
    return Found::record;
  }
  /// A number to the base, with or without `0x` where that is 16.
  [[nodiscard]] static std::optional<std::uint32_t> parse_digits(std::string_view word, int base) noexcept {
    if (base == 16 && ascii::has_hex_prefix(word)) word.remove_prefix(2);
    return ascii::parse_number<std::uint32_t>(word, base);
  }

  char line_end_ = '\n';

 private:
  [[nodiscard]] std::unexpected<std::string> fail(const std::string& expected) const {
    return std::unexpected(input_.name() + ':' + std::to_string(input_.line_number()) + expected);
  }
  std::string mistake_{};
  bool failed_ = false;
};

}  // namespace canopus::trace
