#include "canopus/sim/lift/panel.hpp"

#include <algorithm>

namespace canopus::sim::lift {

namespace {

constexpr can::Duration held = std::chrono::milliseconds(300);
constexpr std::uint8_t every_floor = 0xFF, every_target = 0xFF;
constexpr std::uint8_t all_hall_calls = 0x01;

}  // namespace

void Panel::queue(const Message& message) {
  if (waiting_ < messages_.size()) messages_[waiting_++] = message;
}

void Panel::press(std::uint8_t basic, std::uint8_t sub, can::Time now) {
  queue({basic, sub, 1, now});
  queue({basic, sub, 0, now + held});
}

std::optional<Mapping> Panel::next_input(can::Time now) {
  Message* const end = messages_.data() + waiting_;
  Message* const first =
      std::find_if(messages_.data(), end, [now](const Message& message) { return message.due <= now; });
  if (first == end) return std::nullopt;
  const Mapping input{first->basic, first->sub, lifts_, floor_, door_bit_, first->state};
  std::move(first + 1, end, first);
  --waiting_;
  return input;
}

can::Time Panel::deadline(can::Time now) const {
  can::Time due = can::never;
  for (std::size_t i = 0; i < waiting_; ++i) due = std::min(due, std::max(now, messages_[i].due));
  return due;
}

bool Panel::output(const Mapping& output, can::Time now) {
  const auto& [basic, sub, lifts, floor, doors, data] = output;
  if ((lifts & lifts_) == 0 || (floor != floor_ && (floor != every_floor || floor_ == 0))) return false;
  const bool on = (data & 1U) != 0;
  switch (basic) {
    case controller_command:
      if (sub != all_hall_calls || floor_ == 0) break;
      for (const std::uint8_t call : {up, down}) {
        if (lamps_[call]) queue({hall_call, call, 1, now});
      }
      break;
    case hall_call:
      if (floor_ != 0 && (sub == up || sub == down) && (doors & door_bit_) != 0) lamps_[sub] = on;
      break;
    case car_call:
      if (floor_ != 0) break;
      if (sub == every_target) {
        on ? lamps_.set() : lamps_.reset();
      } else {
        lamps_[sub] = on;
      }
      break;
    case position_indication: shown_floor_ = sub; break;
    case hall_lantern:
      for (unsigned lift = 0; lift < lanterns_.size(); ++lift) {
        if ((lifts >> lift & 1U) != 0) lanterns_[lift] = on ? sub & (up | down) : std::uint8_t{0};
      }
      break;
    case direction_indication: arrows_ = on ? sub : std::uint8_t{0}; break;
    case special_indication: indication_ = on ? sub : std::uint8_t{0}; break;
    default: break;
  }
  return true;
}

void Panel::forget() {
  waiting_ = 0;
  lamps_.reset();
  shown_floor_ = arrows_ = indication_ = 0;
  lanterns_.fill(0);
}

}  // namespace canopus::sim::lift
