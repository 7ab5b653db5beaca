#pragma once
// The loop of the readers of text formats: line by line, an error in one line does not end the trace.

#include <string>
#include <string_view>
#include <utility>

#include "canopus/trace/file/reader_base.hpp"

namespace canopus::trace {

class TextReader : public ReaderBase {
 public:
  [[nodiscard]] NextRecord next() final {
    while (const auto line = input_.line()) {
      if (input_.is_cut())
        return fail(": expected a line of at most " + std::to_string(trace_max_line) + " bytes");
      TraceRecord record;
      switch (read_line(*line, record)) {
        case Found::record: return record;
        case Found::nothing: break;
        case Found::left_out: ++left_out_; break;
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
    nothing,   ///< an empty line, a head
    left_out,  ///< something else that was recorded
    mistake,   ///< mistake_ names what was expected
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
  /// Puts the number of the channel into the record; false when the file has too many.
  bool set_channel(std::string_view name, TraceRecord& record) {
    const auto number = channels_.number_of(name);
    if (number) record.channel = *number;
    if (!number) mistake_ = ": expected at most " + std::to_string(ChannelNames::max_channels) + " channels";
    return number.has_value();
  }

 private:
  [[nodiscard]] std::unexpected<std::string> fail(const std::string& expected) const {
    return std::unexpected(input_.name() + ':' + std::to_string(input_.line_number()) + expected);
  }
  std::string mistake_{};
  bool failed_ = false;
};

}  // namespace canopus::trace
