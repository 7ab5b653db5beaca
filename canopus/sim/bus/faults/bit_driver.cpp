#include "canopus/sim/bus/faults/bit_driver.hpp"

#include <algorithm>

#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus/controller/bit_controller.hpp"

namespace canopus::sim {

std::expected<std::vector<DrivenLevel>, std::string> parse_levels(std::string_view text) {
  std::vector<DrivenLevel> levels;
  const auto wrong = [](std::size_t index, const std::string& what) {
    return std::unexpected("character " + std::to_string(index + 1) + ": " + what);
  };
  for (std::size_t index = 0; index < text.size(); ++index) {
    std::size_t count = 1;
    switch (text[index]) {
      case '0':
      case 'd': levels.push_back(DrivenLevel::dominant); break;
      case '1':
      case 'r': levels.push_back(DrivenLevel::released); break;
      case 'R': levels.push_back(DrivenLevel::recessive); break;
      case ' ':
      case '_':
      case '\t':
      case '\r':
      case '\n': continue;
      case '*': {
        if (levels.empty() || index == 0 ||
            std::string_view("01drR").find(text[index - 1]) == std::string_view::npos)
          return wrong(index, "a count follows a level, as in 1*11");
        count = 0;
        std::size_t digits = 0;
        while (index + 1 < text.size() && text[index + 1] >= '0' && text[index + 1] <= '9' && digits < 6) {
          count = 10 * count + static_cast<std::size_t>(text[++index] - '0');
          ++digits;
        }
        if (count == 0) return wrong(index, "expected a count from 1 after *");
        break;
      }
      default: return wrong(index, "expected 0 (dominant), 1 (released), R (forced recessive), * or blanks");
    }
    if (levels.size() + count - 1 > max_driven_levels)
      return wrong(index, "more than " + std::to_string(max_driven_levels) + " levels");
    levels.insert(levels.end(), count - 1, levels.back());
  }
  if (levels.empty()) return std::unexpected("no level in it");
  return levels;
}

std::optional<unsigned> field_begin(const can::Frame& frame, can::FrameField field) {
  // A controller that sends it and is acknowledged knows its fields best.
  can::FaultConfinement faults;
  BitController sender(faults);
  sender.transmit(frame);
  for (unsigned bit = 0; bit < BitStream::max_bits + can::intermission_bits; ++bit) {
    const can::FrameField present = sender.field();
    if (present == field) return bit;
    if (sender.idle()) break;
    sender.sample(sender.drives_dominant() || present == can::FrameField::ack_slot);
  }
  return {};
}

void BitDriver::add(can::Time start, can::Duration bit, const std::vector<DrivenLevel>& levels) {
  if (levels.empty()) return;
  sequences_.push_back({start, bit, levels});
  next_ = std::min(next_, start);
}

bool BitDriver::run(can::Time now) {
  const DrivenLevel level_before = level_;
  const bool was_busy = is_busy_;
  std::erase_if(sequences_, [now](const Sequence& sequence) { return sequence.end() <= now; });
  level_ = DrivenLevel::released;
  is_busy_ = false;
  next_ = can::never;
  for (const Sequence& sequence : sequences_) {
    if (now < sequence.start) {
      next_ = std::min(next_, sequence.start);
      continue;
    }
    is_busy_ = true;
    auto index = static_cast<std::size_t>((now - sequence.start) / sequence.bit);
    const DrivenLevel level = sequence.levels[index];
    if (level == DrivenLevel::dominant || level_ == DrivenLevel::released) level_ = level;
    while (index < sequence.levels.size() && sequence.levels[index] == level) ++index;
    next_ = std::min(next_, sequence.start + sequence.bit * static_cast<std::int64_t>(index));
  }
  return level_ != level_before || is_busy_ != was_busy;
}

}  // namespace canopus::sim
