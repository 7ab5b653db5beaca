#include "canopus/manager/nmt/flying_master.hpp"

#include <utility>

#include "canopus/canopen/node/node.hpp"

namespace canopus::manager {
namespace {

constexpr std::uint32_t nmt = 0x000;
constexpr std::uint32_t active_master_answer = 0x071;
constexpr std::uint32_t negotiation_request = 0x072;
constexpr std::uint32_t detect_active_master = 0x073;
constexpr std::uint32_t master_capable_answer = 0x074;
constexpr std::uint32_t detect_master_capable = 0x075;
constexpr std::uint32_t force_negotiation = 0x076;

}  // namespace

void FlyingMaster::start(std::uint8_t node_id, const FlyingMasterTiming& timing, can::Time now) {
  node_id_ = node_id;
  timing_ = timing;
  active_master_ = 0;
  enter(State::delay, can::later(now, timing_.negotiation_delay));
}

void FlyingMaster::stop() noexcept {
  active_master_ = 0;
  enter(State::off, can::never);
}

void FlyingMaster::enter(State state, can::Time until) {
  state_ = state;
  alarm_ = until;
}

can::Duration FlyingMaster::whole_negotiation() const noexcept {
  return timing_.negotiation_delay + timing_.time_out + 2 * timing_.priority_slot + 127 * timing_.device_slot;
}

void FlyingMaster::receive(const can::Frame& frame, can::Time now) {
  if (frame.extended || frame.remote) return;
  if (frame.identifier == nmt && frame.length() == 2 && frame.data[1] == 0 &&
      (frame.data[0] == 0x81 || frame.data[0] == 0x82)) {
    reset_seen_ = true;
    last_reset_ = now;
  }
  if (state_ == State::off) return;
  switch (frame.identifier) {
    case active_master_answer:
      if (frame.length() >= 2) claimed(frame.data[0], frame.data[1], now);
      return;
    case negotiation_request: return negotiate(false, now);
    case detect_active_master:
      if (state_ == State::active) send_claim();
      return;
    case detect_master_capable: sink_->send(can::data_frame(master_capable_answer)); return;
    case force_negotiation:
      if (state_ == State::active) negotiate(true, now);
      return;
    default: break;
  }
  // Standby: the active master's sign of life.
  if (state_ == State::standby && frame.identifier == canopen::cob_id::error_control + active_master_ &&
      frame.length() == 1 && frame.data[0] != 0) {
    alarm_ = can::later(now, heartbeat_time_);
  }
}

void FlyingMaster::tick(can::Time now) {
  if (alarm_ > now) return;
  switch (state_) {
    case State::off: alarm_.cancel(); return;
    case State::delay:
      sink_->send(can::data_frame(detect_active_master));
      return enter(State::detecting, can::later(now, timing_.time_out));
    case State::detecting:
      // The first master finds a network in an unknown state. It is reset once and not by each master that
      // comes back from that very reset, or the resets would never end.
      if (!reset_seen_ || can::later(last_reset_, whole_negotiation()) < now) {
        reset_seen_ = true;
        last_reset_ = now;
        listener_->reset_all_nodes(now);
      }
      return negotiate(true, now);
    case State::negotiating: return become_active(now);
    case State::standby:
      reset_seen_ = true;
      last_reset_ = now;
      active_master_ = 0;
      listener_->reset_all_nodes(now);
      return enter(State::delay, can::later(now, timing_.negotiation_delay));
    case State::active:
      sink_->send(can::data_frame(force_negotiation));
      alarm_ = can::later(now, timing_.detect_cycle);
      return;
  }
}

void FlyingMaster::negotiate(bool request, can::Time now) {
  resign(now);
  if (request) sink_->send(can::data_frame(negotiation_request));
  active_master_ = 0;
  enter(State::negotiating, can::later(now, waiting_time()));
}

void FlyingMaster::claimed(std::uint8_t level, std::uint8_t node_id, can::Time now) {
  if (node_id == 0 || node_id > 127 || node_id == node_id_) return;
  if (std::pair(level, node_id) < std::pair(timing_.level, node_id_)) {
    resign(now);
    return become_standby(node_id, now);
  }
  switch (state_) {
    case State::off:
    case State::delay: return;  // this node asks in a moment
    case State::standby:
      // Another master claims the network, although the active one is better: they negotiate.
      if (node_id == active_master_) return;
      sink_->send(can::data_frame(force_negotiation));
      return;
    case State::detecting:
    case State::negotiating:
    case State::active: sink_->send(can::data_frame(force_negotiation)); return negotiate(true, now);
  }
}

void FlyingMaster::become_standby(std::uint8_t master, can::Time now) {
  active_master_ = master;
  heartbeat_time_ = listener_->standby_for(master, now);
  enter(State::standby, can::later(now, heartbeat_time_));
}

void FlyingMaster::become_active(can::Time now) {
  active_master_ = node_id_;
  enter(State::active, can::later(now, timing_.detect_cycle));
  send_claim();
  listener_->mastership_won(now);
}

void FlyingMaster::resign(can::Time now) {
  if (state_ != State::active) return;
  enter(State::negotiating, can::never);
  listener_->mastership_lost(now);
}

void FlyingMaster::send_claim() {
  sink_->send(can::data_frame(active_master_answer, {timing_.level, node_id_}));
}

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
