#include "canopus/sim/device/device.hpp"

#include <algorithm>
#include <utility>

namespace canopus::sim {

using canopen::Entry;
using canopen::NmtState;

void Device::power_on(can::Time now) {
  if (!std::exchange(is_on_, true) && application_) alarm().add_part(application_->alarm());
  script_.restart();
  if (lss_) lss_->power_on(now);
  node_.power_on(now);
  play(now);
  move_values(now);
  if (application_) application_->start(*this, now);
  settle(now, false);
}

void Device::power_off() {
  if (std::exchange(is_on_, false) && application_) alarm().remove_part(application_->alarm());
  next_sample_ = can::never;
  is_sampling_ = false;
  next_row_ = can::never;
  node_.power_off();
  if (lss_) lss_->power_off();
  set_alarm();
}

void Device::force(const Entry& entry, std::uint64_t value, can::Time until, can::Time now) {
  settle(now, force_value(entry, value, until, now));
}

bool Device::release(const Entry& entry, can::Time now) {
  if (!forcing_.is_forced(entry)) return false;
  settle(now, release_value(entry, now));
  return true;
}

bool Device::force_value(const Entry& entry, std::uint64_t value, can::Time until, can::Time now) {
  if (forcing_.all().empty()) alarm().add_part(forcing_.alarm());
  const bool changed = forcing_.force(entry, value, until);
  update_fast_path();
  written_ = true;
  if (force_listener_ == nullptr) return changed;
  for (const Forcing::Force& force : forcing_.all()) {
    if (same(force.entry, entry)) force_listener_->value_forced(force, now);
  }
  return changed;
}

bool Device::release_value(const Entry& entry, can::Time now) {
  if (!forcing_.is_forced(entry)) return false;
  const bool changed = forcing_.release(entry);
  if (forcing_.all().empty()) alarm().remove_part(forcing_.alarm());
  update_fast_path();
  written_ = true;
  if (force_listener_ != nullptr) force_listener_->value_released(entry, now);
  // Outside Operational the values are not sampled: the one beneath may be old.
  return (is_on_ && move_values(now)) || changed;
}

bool Device::release_due(can::Time now) {
  bool changed = false;
  while (forcing_.alarm() <= now) {
    const auto due =
        std::ranges::find_if(forcing_.all(), [&](const auto& force) { return force.until <= now; });
    const Entry entry = due->entry;  // which goes with the force
    changed = release_value(entry, now) || changed;
  }
  return changed;
}

bool Device::carry_out(const ScriptStep& step, can::Time now) {
  switch (step.action) {
    case ScriptStep::Action::force:
      return force_value(step.entry, step.value, step.hold ? can::later(now, *step.hold) : can::never, now);
    case ScriptStep::Action::release: return release_value(step.entry, now);
    case ScriptStep::Action::release_all: break;
  }
  bool changed = false;
  while (!forcing_.all().empty()) {
    const Entry first = forcing_.all().front().entry;
    changed = release_value(first, now) || changed;
  }
  return changed;
}

bool Device::evaluate_conditions(can::Time now) {
  if (script_.empty()) return false;
  bool changed = false;
  script_.begin_evaluation();
  while (const ScriptStep* step = script_.next_true(node_.dictionary())) {
    changed = carry_out(*step, now) || changed;
    changed = echo_values() || changed;
  }
  return changed;
}

bool Device::play(can::Time now) {
  next_row_ = can::never;
  bool moved = false;
  for (const Playback& playback : playbacks_) {
    const auto row = playback.at(now);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (row[i]) moved = forcing_.put(playback.entries()[i], *row[i]) || moved;
    }
    next_row_ = std::min(next_row_, playback.next_after(now));
  }
  return moved;
}

void Device::reset_requested(canopen::NmtCommand which, can::Time now) {
  if (lss_) {
    lss_->listener().reset_requested(which, now);
  } else if (listener_ != nullptr) {
    listener_->reset_requested(which, now);
  }
}

void Device::reset_done(canopen::NmtCommand which, can::Time now) {
  if (lss_) lss_->listener().reset_done(which, now);
  if (which != canopen::NmtCommand::reset_node) return;
  forcing_.values_loaded();
  if (!playbacks_.empty()) play(now);
  if (application_ && is_on_) application_->start(*this, now);
  set_alarm();
}

void Device::rpdo_received(std::uint16_t number, can::Time) {
  written_ = was_written_ = true;
  forcing_.rpdo_received(number);
}

// Written from outside of the bus, it may be a moving value: a tick determines its next change.
void Device::object_written(const Entry&, can::Time now) {
  written_ = was_written_ = true;
  if (is_sampling_) alarm().bring_forward(now);
}

bool Device::emergency(std::uint16_t code, std::uint8_t error_register,
                       const std::array<std::uint8_t, 5>& manufacturer, can::Time now) {
  return node_.emergency(code, error_register, manufacturer, now);
}

bool Device::emergency_reset(can::Time now) { return node_.emergency_reset(now); }

/// The value of the target.
std::uint64_t Device::value_of(const Motion& motion) const noexcept {
  return can::load_masked(node_.dictionary().block().data() + motion.target.offset, motion.mask);
}

/// It holds what it has to hold now.
bool Device::is_moved(const Motion& motion, can::Time now) const noexcept {
  return now < motion.next_change && value_of(motion) == motion.moved_to;
}

/// Where values have changed. `is_simple`: nothing is forced, and nothing follows another value.
template <bool is_simple>
inline canopen::ValueMask Device::sample(can::Time now) {
  std::uint8_t* const block = node_.dictionary().block().data();
  canopen::ValueMask moved = 0;
  can::Time next_change = can::never;
  for (Motion& motion : motions_) {
    if (!is_simple && motion.is_echo()) continue;
    const std::uint64_t before = value_of(motion);
    if (now < motion.next_change && before == motion.moved_to) {
      next_change = std::min(next_change, motion.next_change);
      continue;
    }
    const Sample sample = motion.generator.at(now);
    if constexpr (is_simple) {
      can::store_masked(block + motion.target.offset, sample.value, motion.mask);
    } else {
      forcing_.put(motion.target, sample.value);
    }
    motion.moved_to = value_of(motion);
    // The dictionary has only the forced value, not the one beneath, so that is written at each sample.
    motion.next_change = is_simple || !forcing_.is_forced(motion.target) ? sample.next_change : now;
    next_change = std::min(next_change, motion.next_change);
    if (motion.moved_to != before) moved |= motion.places;
  }
  next_change_ = next_change;
  return moved;
}

bool Device::move_values(can::Time now) {
  const bool moved = sample<false>(now) != 0;
  return echo_values() || moved;
}

/// When a value may change next after writes from outside. Writes by other services of the node (below 2000H)
/// or by an application are not detected here: then it is now.
can::Time Device::next_change_seen(can::Time now) const noexcept {
  can::Time change = can::never;
  for (const Motion& motion : motions_) {
    if (motion.is_echo()) continue;
    const bool is_watched = motion.target.index >= 0x2000 && !application_;
    change = std::min(change, is_watched && is_moved(motion, now) ? motion.next_change : now);
  }
  return change;
}

/// The next sample at which a value may change.
inline void Device::plan_sample(can::Time now) noexcept {
  const can::Time change = is_watched_ && !written_ ? next_change_ : next_change_seen(now);
  written_ = false;
  const can::Duration interval = sample_interval_;
  // Most often it is one of the next four samples: no division.
  if (next_sample_ <= now && now - next_sample_ < interval) {
    for (can::Time next = next_sample_ + interval; next - now <= 4 * interval; next += interval) {
      if (change > next) continue;
      next_sample_ = next;
      return;
    }
  }
  if (can::never - change < 2 * interval) {
    next_sample_ = can::never;
    return;
  }
  const can::Duration to_change = std::max(change, now + can::Duration{1}) - sampled_from_;
  next_sample_ = can::later(sampled_from_, (to_change + interval - can::Duration{1}) / interval * interval);
}

bool Device::move_echoes() {
  const canopen::ObjectDictionary& dictionary = node_.dictionary();
  bool moved = false;
  for (const Motion& motion : motions_) {
    if (!motion.is_echo()) continue;
    const auto value = dictionary.get<std::uint64_t>(motion.source);
    moved = forcing_.put(motion.target, value) || moved;
  }
  return moved;
}

/// After everything that happens to it.
void Device::settle(can::Time now, bool moved) {
  if (is_on_ && (application_ || echoes_ || !script_.empty())) {
    moved = act(now) || moved;
    moved = echo_values() || moved;
    moved = evaluate_conditions(now) || moved;
    // The application reads the values that a condition forces, too.
    if (!script_.empty()) moved = act(now) || moved;
  }
  after_event(now, moved ? canopen::all_values : canopen::ValueMask{0});
}

[[gnu::always_inline]] inline void Device::after_event(can::Time now, canopen::ValueMask moved) {
  const bool is_operational = is_on_ && node_.state() == NmtState::operational;
  if (moved != 0 && is_operational)
    node_.values_changed(std::exchange(was_written_, false) ? canopen::all_values : moved, now);
  if (!is_operational || !samples_) {
    next_sample_ = can::never;
    is_sampling_ = false;
    return set_alarm();
  }
  if (!is_sampling_) {
    is_sampling_ = true;
    sampled_from_ = now;
  } else if (next_sample_ > now && !written_) {
    return set_alarm();
  }
  plan_sample(now);
  set_alarm();
}

void Device::receive(const can::Frame& frame, can::Time now) {
  if (lss_ && frame.identifier == lss::from_master && !frame.extended) return lss_->receive(frame, now);
  if (is_passive()) return node_.receive(frame, now);
  // Outside Operational the values are not sampled: update them for an SDO read, and for the first TPDOs
  // after start.
  if (is_on_ && !is_sampling_) move_values(now);
  const bool moved = is_on_ && act(now);
  node_.receive(frame, now);
  settle(now, moved);
}

void Device::controller_changed(can::Time now) { node_.controller_changed(now); }

void Device::tick(can::Time now) {
  const can::Alarm::Hold hold(alarm());
  if (has_fast_path_) [[likely]] {
    const canopen::ValueMask moved = next_sample_ <= now ? sample<true>(now) : canopen::ValueMask{0};
    if (node_.deadline() <= now) node_.tick(now);
    return after_event(now, moved);
  }
  if (lss_ && lss_->deadline() <= now) lss_->tick(now);
  bool moved = release_due(now);
  if (next_row_ <= now) moved = play(now) || moved;
  if (next_sample_ <= now) moved = move_values(now) || moved;
  while (const ScriptStep* step = script_.next_due(now)) moved = carry_out(*step, now) || moved;
  if (is_on_) moved = act(now) || moved;
  if (node_.deadline() <= now) node_.tick(now);
  if (moved || !is_passive()) settle(now, moved);
}

}  // namespace canopus::sim
