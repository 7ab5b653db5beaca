#include "scripted_device.hpp"

#include <algorithm>
#include <utility>

namespace canopus::python {

std::size_t ScriptedDevice::watch(const canopen::Entry& entry) {
  watches_.push_back({.token = ++last_token_, .entry = entry});
  return last_token_;
}

std::size_t ScriptedDevice::every(can::Duration period) {
  timers_.push_back({.token = ++last_token_, .period = period});
  return last_token_;
}

void ScriptedDevice::start(sim::Device& device, can::Time now) {
  for (Watch& watch : watches_) watch.last = device.node().dictionary().get<std::uint64_t>(watch.entry);
  for (Timer& timer : timers_) timer.next = can::later(now, timer.period);
  set_alarm();
  hook_(0, 0, now);
}

bool ScriptedDevice::act(sim::Device& device, can::Time now) {
  if (now >= dirty_since_) {
    dirty_since_ = can::never;
    has_changed_ = true;
  }
  for (Timer& timer : timers_) {
    if (now < timer.next) continue;
    timer.next = can::later(timer.next, timer.period);
    hook_(timer.token, 0, now);
  }
  for (Watch& watch : watches_) {
    const auto value = device.node().dictionary().get<std::uint64_t>(watch.entry);
    if (value == watch.last) continue;
    watch.last = value;
    hook_(watch.token, value, now);
  }
  set_alarm();
  return std::exchange(has_changed_, false);
}

void ScriptedDevice::set_alarm() noexcept {
  can::Time next = dirty_since_;
  for (const Timer& timer : timers_) next = std::min(next, timer.next);
  alarm_ = next;
}

}  // namespace canopus::python
