// The reader of the logs of can-utils.

#include <memory>
#include <string_view>

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

class CandumpReader final : public TextReader {
 public:
  explicit CandumpReader(TraceInput input) : TextReader(std::move(input), FileFormat::candump) {
    if (input_.buffered().empty()) (void)input_.peek_more();
    differences_ = are_differences(input_.buffered());
  }

 private:
  Found read_line(std::string_view line, TraceRecord& record) override {
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos) return Found::nothing;
    if (line[start] == '#' || line.substr(start).starts_with("//")) return Found::left_out;
    auto entry = read_candump_line(line, input_.line_number());
    if (!entry && entry.error().can_fd) return Found::left_out;
    if (!entry) {
      return mistake(entry.error().column,
                     "expected " + entry.error().expected + ", found " + entry.error().found);
    }
    if (!set_channel(entry->channel, record)) return Found::mistake;
    if (differences_) {
      time_ = can::later(time_, entry->time.time_since_epoch());
      record.time = time_;
    } else {
      record.time = entry->time;
    }
    record.transmitted = entry->transmitted;
    record.frame = entry->frame;
    if (entry->error_frame) set_error_frame(record, entry->frame.identifier);
    return Found::record;
  }

  bool differences_ = false;
  can::Time time_{};
};

}  // namespace

OpenedReader open_candump(TraceInput input) { return std::make_unique<CandumpReader>(std::move(input)); }

}  // namespace canopus::trace
