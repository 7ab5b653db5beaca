// The reader of the traces of CARBUS Analyzer, versions 2 and 3 [CARBUS Analyzer: trace format]. Lines end with a carriage
// return; columns are apart by tabulators: time, channel, flags, identifier, length, data, checksum, characters.

#include <memory>

#include "canopus/trace/file/text_reader.hpp"

namespace canopus::trace {
namespace {

using ascii::parse_number;

class CarbusReader final : public TextReader {
 public:
  explicit CarbusReader(TraceInput input) : TextReader(std::move(input), FileFormat::carbus) {
    // a file that went through another program has lines as that writes them
    std::string_view begin = input_.buffered();
    std::size_t end = begin.find_first_of("\r\n");
    while (begin.size() < trace_max_line && (end == std::string_view::npos || end + 1 == begin.size())) {
      const std::size_t before = begin.size();
      begin = input_.peek_more();
      if (begin.size() == before) break;
      end = begin.find_first_of("\r\n");
    }
    if (end != std::string_view::npos && begin[end] == '\r' && !begin.substr(end).starts_with("\r\n"))
      line_end_ = '\r';
  }

 private:
  Found read_line(std::string_view line, TraceRecord& record) override {
    if (line.starts_with('\n')) line.remove_prefix(1);
    Words words(line);
    const std::string_view first = words.next();
    if (first.empty()) return Found::nothing;
    if (first == "@") return Found::nothing;
    if (first == "#") return read_meta(words.rest());
    const auto time = parse_seconds(first);
    if (!time) return mistake(words.column(), "expected a time such as 46,016, found " + shown(first));
    record.time = clock_.at(*time);
    const std::string_view channel = words.next();
    const auto number = parse_number<std::uint32_t>(channel);
    if (!number || *number > 255)
      return mistake(words.column(), "expected the number of a channel, found " + shown(channel));
    const std::string_view word = words.next();
    const auto flags = parse_number<std::uint32_t>(word, 16);
    if (!flags) return mistake(words.column(), "expected flags in hexadecimal, found " + shown(word));
    can::Frame& frame = record.frame;
    const std::string_view identifier = words.next();
    const auto value = parse_number<std::uint32_t>(identifier, 16);
    frame.extended = (*flags & extended_identifier) != 0 || value.value_or(0) > can::max_base_identifier;
    if (!value || *value > can::max_extended_identifier)
      return mistake(words.column(), "expected a hexadecimal identifier, found " + shown(identifier));
    frame.identifier = *value;
    const std::string_view digits = words.next();
    const auto length = parse_number<std::uint32_t>(digits);
    if (!length || *length > 64)
      return mistake(words.column(), "expected a length of 0 to 64, found " + shown(digits));
    if ((*flags & fd_frame) != 0) return leave_out(LeftOutKind::can_fd);
    if (*length > 8) return leave_out(LeftOutKind::too_long);
    frame.dlc = static_cast<std::uint8_t>(*length);
    // a remote frame has no data, but the checksum follows: eight digits
    frame.remote = (*flags & remote_request) != 0 && words.peek().size() != 2;
    if (const Found found = read_data(words, frame, 16); found != Found::record) return found;
    return on_channel(name_of_numbered_channel(*number), record);
  }

  /// `46,016` and `27,337000`: seconds within a minute.
  static std::optional<can::Duration> parse_seconds(std::string_view word) {
    std::string text(word.substr(0, 24));
    for (char& c : text) c = c == ',' ? '.' : c;
    const auto time = parse_time(text, nanoseconds_per_second);
    if (!time || *time < can::Duration{} || *time >= std::chrono::minutes(1)) return std::nullopt;
    return time;
  }

  Found read_meta(std::string_view text) {
    constexpr std::string_view key = "$LocalTime=";
    if (!text.starts_with(key)) return leave_out(LeftOutKind::comment);
    if (const auto start = parse_clock(text.substr(key.size()))) clock_ = MinuteClock(*start);
    return Found::nothing;
  }

  static constexpr std::uint32_t extended_identifier = 0x01, remote_request = 0x02, fd_frame = 0x30;  // flags
  MinuteClock clock_{};
};

}  // namespace

OpenedReader open_carbus(TraceInput input) { return std::make_unique<CarbusReader>(std::move(input)); }

}  // namespace canopus::trace
