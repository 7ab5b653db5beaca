// The reader of the logs of Microchip's CAN BUS Analyzer: `166064;RX;0x21A;2;0xFE;0x36;`, times in ms. Its head stands
// between two lines that begin with `//`.

#include <memory>

#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/text_reader.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;
using ascii::parse_number;

class MicrochipReader final : public TextReader {
 public:
  explicit MicrochipReader(TraceInput input) : TextReader(std::move(input), FileFormat::microchip) {}

 private:
  Found read_line(std::string_view line, TraceRecord& record) override {
    constexpr std::int64_t millisecond = 1'000'000;
    if (line.starts_with("//")) {
      in_head_ = !in_head_;
      return Found::nothing;
    }
    Words words(line, "; \t");
    const std::string_view first = words.next();
    if (in_head_ || first.empty()) return Found::nothing;
    const auto time = parse_time(first, millisecond);
    if (!time) return mistake(words.column(), "expected a time in ms, found " + shown(first));
    record.time = can::Time(*time);
    const std::string_view direction = words.next();
    record.transmitted = equal_ignoring_case(direction, "TX");
    if (!record.transmitted && !equal_ignoring_case(direction, "RX"))
      return mistake(words.column(), "expected RX or TX, found " + shown(direction));
    can::Frame& frame = record.frame;
    std::string_view identifier = words.next();
    const bool is_marked = identifier.ends_with('x') || identifier.ends_with('X');
    const auto value = parse_digits(identifier.substr(0, identifier.size() - (is_marked ? 1 : 0)), 16);
    if (!value || *value > can::max_extended_identifier)
      return mistake(words.column(), "expected a hexadecimal identifier, found " + shown(identifier));
    frame.identifier = *value;
    frame.extended = is_marked || *value > can::max_base_identifier;
    const std::string_view digits = words.next();
    const auto dlc = parse_number<std::uint32_t>(digits);
    if (!dlc || *dlc > 64) return mistake(words.column(), "expected a DLC of 0 to 8, found " + shown(digits));
    if (*dlc > 8) return leave_out(LeftOutKind::too_long);
    frame.dlc = static_cast<std::uint8_t>(*dlc);
    frame.remote = equal_ignoring_case(words.peek(), "RTR");
    if (const Found found = read_data(words, frame, 16); found != Found::record) return found;
    return on_channel("can0", record);
  }

  bool in_head_ = false;
};

}  // namespace

OpenedReader open_microchip(TraceInput input) { return std::make_unique<MicrochipReader>(std::move(input)); }

}  // namespace canopus::trace
