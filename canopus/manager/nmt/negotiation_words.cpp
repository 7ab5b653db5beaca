#include "canopus/manager/nmt/negotiation_words.hpp"

namespace canopus::manager {

namespace {

std::string in_milliseconds(can::Duration time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(time).count()) + " ms";
}

/// "2.05 s", "950 ms"
std::string in_seconds(can::Duration time) {
  const auto count = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
  if (count < 1000) return in_milliseconds(time);
  std::string text = std::to_string(count / 1000);
  if (count % 1000 != 0) {
    const std::string thousandths = std::to_string(1000 + count % 1000);
    text += "." + thousandths.substr(1, thousandths.find_last_not_of('0'));
  }
  return text + " s";
}

}  // namespace

FlyingMasterTiming flying_timing(const canopen::ObjectDictionary& objects, std::uint8_t node_id) {
  const auto time = [&](std::uint8_t sub, unsigned otherwise) {
    return std::chrono::milliseconds(
        objects.get<std::uint16_t>(0x1F90, sub, static_cast<std::uint16_t>(otherwise)));
  };
  FlyingMasterTiming timing;
  timing.time_out = time(1, 100);
  timing.negotiation_delay = time(2, 500);
  timing.level = static_cast<std::uint8_t>(objects.get<std::uint16_t>(0x1F90, 3, 1));
  timing.priority_slot = time(4, 1500);
  timing.device_slot = time(5, 10);
  timing.detect_cycle = time(6, 4000 + 10U * node_id);
  return timing;
}

std::string negotiation_words(const FlyingMasterTiming& timing, std::uint8_t node_id) {
  const can::Duration wait = negotiation_wait(timing, node_id);
  return "negotiation: " + in_milliseconds(timing.negotiation_delay) + " + " + std::to_string(timing.level) +
         " x " + in_milliseconds(timing.priority_slot) + " + " + std::to_string(node_id) + " x " +
         in_milliseconds(timing.device_slot) + " = " + in_seconds(timing.negotiation_delay + wait) +
         " after a reset, and " + in_milliseconds(timing.time_out) +
         " more while it looks for an active master; asked for by another one: " + in_seconds(wait);
}

std::string overlapping_slots(const FlyingMasterTiming& timing) {
  if (slots_fit(timing)) return {};
  return "a priority time slot of " + in_milliseconds(timing.priority_slot) + " is not more than 127 x " +
         in_milliseconds(timing.device_slot) + " = " + in_milliseconds(highest_node_id * timing.device_slot) +
         ": the slots of the priorities overlap, and the negotiation may have no end";
}

}  // namespace canopus::manager
