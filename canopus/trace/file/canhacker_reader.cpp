// The reader of CANHacker's traces: a head `Time   ID     DLC Data   Comment`, then `11,391 601      8 40 00 10 ...`, seconds
// within a minute, identifiers of three or eight digits.

#include <memory>

#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/text_reader.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;
using ascii::parse_number;

class CanhackerReader final : public TextReader {
 public:
  explicit CanhackerReader(TraceInput input) : TextReader(std::move(input), FileFormat::canhacker) {}

 private:
  Found read_line(std::string_view line, TraceRecord& record) override {
    Words words(line);
    const std::string_view first = words.next();
    if (first.empty() || equal_ignoring_case(first, "Time") ||
        ascii::contains_ignoring_case(line, "canhacker"))
      return Found::nothing;
    std::string digits(first.substr(0, 24));
    for (char& c : digits) c = c == ',' ? '.' : c;
    const auto time = parse_time(digits, nanoseconds_per_second);
    if (!time || *time < can::Duration{})
      return mistake(words.column(), "expected a time such as 11,391, found " + shown(first));
    record.time = clock_.at(*time);
    can::Frame& frame = record.frame;
    const std::string_view identifier = words.next();
    const auto value = parse_number<std::uint32_t>(identifier, 16);
    frame.extended = identifier.size() > 3;
    if (!value || *value > (frame.extended ? can::max_extended_identifier : can::max_base_identifier)) {
      return mistake(words.column(),
                     "expected an identifier of 3 or 8 hexadecimal digits, found " + shown(identifier));
    }
    frame.identifier = *value;
    const std::string_view length = words.next();
    const auto dlc = parse_number<std::uint32_t>(length);
    if (!dlc || *dlc > 64) return mistake(words.column(), "expected a DLC of 0 to 8, found " + shown(length));
    if (*dlc > 8) return leave_out(LeftOutKind::too_long);
    frame.dlc = static_cast<std::uint8_t>(*dlc);
    frame.remote = equal_ignoring_case(words.peek(), "RTR");
    if (const Found found = read_data(words, frame, 16); found != Found::record) return found;
    return on_channel("can0", record);
  }

  MinuteClock clock_{};
};

}  // namespace

OpenedReader open_canhacker(TraceInput input) { return std::make_unique<CanhackerReader>(std::move(input)); }

}  // namespace canopus::trace
