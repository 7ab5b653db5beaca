// The reader of the logs of can-utils.

#include <memory>
#include <string>
#include <string_view>

#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/candump_log.hpp"
#include "canopus/trace/file/text_reader.hpp"

namespace canopus::trace {
namespace {

/// Whether `candump -td` wrote these lines: the first time is 0, or short, and then they go back, which times since
/// the begin (-tz) do not. A log form has no such times.
bool are_differences(std::string_view lines) {
  can::Time last{};
  bool first = true;
  while (true) {
    const std::size_t end = lines.find('\n');
    if (end == std::string_view::npos) return false;
    const auto entry = read_candump_line(lines.substr(0, end));
    lines.remove_prefix(end + 1);
    if (!entry) continue;
    // on the screen, `candump -ta` and a log have ten digits of seconds
    if (entry->log_form || entry->time >= can::Time(std::chrono::seconds(1'000'000))) return false;
    if (!first && entry->time < last) return true;
    first = false;
    last = entry->time;
  }
}

constexpr std::string_view drop_count = "DROPCOUNT:";

class CandumpReader final : public TextReader {
 public:
  explicit CandumpReader(TraceInput input) : TextReader(std::move(input), FileFormat::candump) {
    if (input_.buffered().empty()) (void)input_.peek_more();
    differences_ = are_differences(input_.buffered());
  }

 private:
  Found read_line(std::string_view line, TraceRecord& record) override {
    if (line.find(escape) != std::string_view::npos) line = plain_ = without_colours(line);
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos) return Found::nothing;
    if (line[start] == '#' || line.substr(start).starts_with("//")) return leave_out(LeftOutKind::comment);
    if (line.substr(start).starts_with(drop_count)) return read_drop_count(line.substr(start));
    // candump -e says below an error frame in words what it is
    if (is_below_error_frame_ && start > 0 && ascii::is_letter(line[start]) &&
        line.find('[') == std::string_view::npos) {
      return leave_out(LeftOutKind::comment);
    }
    auto entry = read_candump_line(line, input_.line_number());
    is_below_error_frame_ = entry && entry->error_frame;
    if (!entry && entry.error().left_out) return leave_out(*entry.error().left_out);
    if (!entry) {
      return mistake(entry.error().column,
                     "expected " + entry.error().expected + ", found " + entry.error().found);
    }
    if (differences_) {
      time_ = can::later(time_, entry->time.time_since_epoch());
      record.time = time_;
    } else {
      record.time = entry->time;
    }
    record.transmitted = entry->transmitted;
    record.frame = entry->frame;
    if (entry->error_frame) set_error_frame(record, entry->frame.identifier);
    return on_channel(entry->channel, record);
  }

  /// `DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)`, of candump -d.
  Found read_drop_count(std::string_view line) {
    Words words(line);
    (void)words.next();
    (void)words.next();
    const std::string_view number = words.next();
    const auto frames = ascii::parse_number<std::uint32_t>(number);
    if (!frames)
      return mistake(words.column(), "expected the number of dropped frames, found " + shown(number));
    left_out_.add_lost(*frames);
    return Found::nothing;
  }

  /// Without the escape sequences of candump -c.
  static std::string without_colours(std::string_view line) {
    std::string plain;
    bool in_escape = false;
    for (const char c : line) {
      if (c == escape) {
        in_escape = true;
      } else if (!in_escape) {
        plain += c;
      } else if (ascii::is_letter(c)) {
        in_escape = false;
      }
    }
    return plain;
  }

  std::string plain_{};
  bool is_below_error_frame_ = false;
  bool differences_ = false;
  can::Time time_{};
};

}  // namespace

OpenedReader open_candump(TraceInput input) { return std::make_unique<CandumpReader>(std::move(input)); }

}  // namespace canopus::trace
