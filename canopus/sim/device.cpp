#include "canopus/sim/device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "canopus/eds/problems.hpp"
#include "canopus/eds/value.hpp"

namespace canopus::sim {

using canopen::Entry;
using canopen::NmtState;

Device::Device(std::shared_ptr<const eds::DeviceFile> file, std::uint8_t node_id, can::Sink& sink,
               DeviceOptions options)
    : file_(std::move(file)),
      gate_(sink),
      node_(file_->dictionary, node_id, gate_, options.node),
      options_(options) {
  options_.sample_interval = std::max<can::Duration>(options_.sample_interval, std::chrono::microseconds(1));
}

std::optional<std::string> Device::add_behaviour(const Behaviour& behaviour) {
  const canopen::DictionaryDescription& description = *file_->dictionary;
  const auto find = [&](std::uint16_t index, std::uint8_t sub, Entry& entry) -> std::optional<std::string> {
    const std::string shown = eds::object_name(index, sub);
    entry = description.find(index, sub);
    if (!entry) return "the device has no object " + shown;
    if (!eds::is_number(entry.description->type)) {
      return shown + " is of type " + std::string(eds::name(entry.description->type)) + ", not a number";
    }
    return std::nullopt;
  };
  Motion motion{behaviour, {}, {}};
  if (auto problem = find(behaviour.index, behaviour.sub, motion.target)) return problem;
  const std::string shown = eds::object_name(behaviour.index, behaviour.sub);
  switch (behaviour.kind) {
    case Behaviour::Kind::echo:
      if (auto problem = find(behaviour.source_index, behaviour.source_sub, motion.source)) return problem;
      if (motion.source.description->type != motion.target.description->type) {
        return shown + " is of type " + std::string(eds::name(motion.target.description->type)) +
               ", its source " + eds::object_name(behaviour.source_index, behaviour.source_sub) +
               " of type " + std::string(eds::name(motion.source.description->type)) +
               ": an echo needs equal types";
      }
      break;
    case Behaviour::Kind::counter:
      if (!(behaviour.step > 0) || !std::isfinite(behaviour.step)) return "step must be greater than 0";
      [[fallthrough]];
    case Behaviour::Kind::sine:
    case Behaviour::Kind::ramp:
    case Behaviour::Kind::noise:
      if (behaviour.period <= can::Duration::zero()) return "period must be greater than 0";
      if (!(behaviour.low <= behaviour.high)) return "low must not be greater than high";
      [[fallthrough]];
    case Behaviour::Kind::constant:
      if (!std::isfinite(behaviour.low) || !std::isfinite(behaviour.high))
        return "low and high must be finite";
      break;
  }
  samples_ =
      samples_ || (behaviour.kind != Behaviour::Kind::echo && behaviour.kind != Behaviour::Kind::constant);
  motions_.push_back(motion);
  return std::nullopt;
}

void Device::enable_lss(can::Controller& controller, canopen::ParameterStore* store) {
  lss_ = std::make_unique<DeviceLss>(node_, gate_, controller,
                                     DeviceLss::Settings{node_.node_id(), controller.bit_rate()},
                                     file_->device.bit_rates, store);
}

void Device::power_on(can::Time now) {
  is_on_ = true;
  if (lss_) lss_->power_on(now);
  node_.power_on(now);
  move_values(now);
  after_event(now, false);
}

void Device::power_off() {
  is_on_ = false;
  next_sample_ = can::never;
  node_.power_off();
  if (lss_) lss_->power_off();
}

bool Device::emergency(std::uint16_t code, std::uint8_t error_register,
                       const std::array<std::uint8_t, 5>& manufacturer, can::Time now) {
  return node_.emergency(code, error_register, manufacturer, now);
}

bool Device::emergency_reset(can::Time now) { return node_.emergency_reset(now); }

bool Device::move_values(can::Time now) {
  canopen::ObjectDictionary& dictionary = node_.dictionary();
  bool moved = false;
  for (const Motion& motion : motions_) {
    if (motion.behaviour.kind == Behaviour::Kind::echo) continue;
    const std::uint64_t value = fitted(value_at(motion.behaviour, now), motion.target.description->type,
                                       dictionary.description().limits(motion.target));
    const unsigned unused = 64U - 8U * motion.target.description->length;
    if (dictionary.get<std::uint64_t>(motion.target) == (value << unused) >> unused) continue;
    dictionary.set(motion.target, value);
    moved = true;
  }
  return echo_values() || moved;
}

bool Device::echo_values() {
  canopen::ObjectDictionary& dictionary = node_.dictionary();
  bool moved = false;
  for (const Motion& motion : motions_) {
    if (motion.behaviour.kind != Behaviour::Kind::echo) continue;
    const auto value = dictionary.get<std::uint64_t>(motion.source);
    if (dictionary.get<std::uint64_t>(motion.target) == value) continue;
    dictionary.set(motion.target, value);
    moved = true;
  }
  return moved;
}

void Device::after_event(can::Time now, bool moved) {
  const bool is_operational = is_on_ && node_.state() == NmtState::operational;
  if (moved && is_operational) node_.values_changed(now);
  if (!is_operational || !samples_) {
    next_sample_ = can::never;
  } else if (next_sample_ <= now || next_sample_ == can::never) {
    next_sample_ = can::later(now, options_.sample_interval);
  }
}

void Device::receive(const can::Frame& frame, can::Time now) {
  if (lss_ && frame.identifier == manager::lss::from_master && !frame.extended)
    return lss_->receive(frame, now);
  if (motions_.empty()) return node_.receive(frame, now);
  // Nobody samples outside Operational: an SDO read, or the first TPDOs after start, see the values of now.
  if (is_on_ && next_sample_ == can::never) move_values(now);
  node_.receive(frame, now);
  after_event(now, is_on_ && echo_values());
}

void Device::transmitted(const can::Frame& frame, can::Time now) { node_.transmitted(frame, now); }

void Device::controller_changed(can::Time now) { node_.controller_changed(now); }

void Device::tick(can::Time now) {
  if (lss_ && lss_->deadline() <= now) lss_->tick(now);
  const bool moved = next_sample_ <= now && move_values(now);
  if (node_.deadline() <= now) node_.tick(now);
  if (!motions_.empty()) after_event(now, moved);
}

can::Time Device::deadline() const noexcept {
  const can::Time next = std::min(node_.deadline(), next_sample_);
  return lss_ ? std::min(next, lss_->deadline()) : next;
}

}  // namespace canopus::sim
