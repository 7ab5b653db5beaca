#include "canopus/sim/bus/bitwise/frame_completion.hpp"

#include <algorithm>

namespace canopus::sim {
namespace {

bool completes(const BusPort& port) noexcept { return port.phase.received || port.phase.transmitted; }

}  // namespace

void FrameCompletion::move_in(BusPort& port, const WireState& from) noexcept {
  if (!completes(port)) return;
  is_due_ = true;
  port.phase.counted = std::ranges::any_of(
      from.members, [&from](const BusPort* other) { return from.has(*other) && completes(*other); });
}

void FrameCompletion::complete(can::Time now) {
  report(now);
  for (BusPort* port : wire_.members) {
    if (!port->phase.transmitted || port->phase.next > now) continue;
    port->phase.transmitted = port->phase.counted = false;
    port->confirm = port->complete();
    wire_.arbiter.set(port->index, port->offer());
  }
  deliver(now);
  is_due_ = std::ranges::any_of(wire_.members, [](const BusPort* port) { return completes(*port); });
}

void FrameCompletion::report(can::Time now) {
  BusCore& core = wire_.core;
  const BusPort* reporter = nullptr;
  for (BusPort* port : wire_.members) {
    const BusPort::BitPhase& phase = port->phase;
    if (!completes(*port) || phase.next > now || phase.counted) continue;
    if (reporter == nullptr || (phase.transmitted && !reporter->phase.transmitted)) reporter = port;
  }
  if (reporter == nullptr) return;
  // All have the same frame, but a late driver makes the others end it at different moments.
  const can::Frame frame = reporter->phase.transmitted ? reporter->current : reporter->bits.frame();
  if (reporter->phase.frame_start < reported_at_ && frame == reported_) return;
  reported_ = frame;
  reported_at_ = now;
  wire_.count_frame(frame);
  if (!core.wire_observers.empty()) report_arbitration(frame, reporter->phase.frame_start);
  for (can::BusObserver* observer : core.observers) {
    observer->frame_completed(frame, reporter->phase.frame_start, now);
  }
}

/// By number: a participant that is notified may plug, unplug and add ports.
void FrameCompletion::deliver(can::Time now) {
  BusCore& core = wire_.core;
  for (std::size_t number = 0; number < core.ports.size(); ++number) {
    BusPort& port = *core.ports[number];
    if (!wire_.has(port) || !port.phase.received || port.phase.next > now) continue;
    port.phase.received = port.phase.counted = false;
    port.phase.lost_at = WireFrame::Sender::won;
    const can::Frame received = port.bits.frame();
    const std::uint64_t accepting = core.acceptance.ports_for(received)[port.index / 64];
    if ((accepting >> (port.index % 64) & 1U) != 0 && !wire_.drops_at(port)) port.receive(received, now);
  }
  for (std::size_t number = 0; number < core.ports.size(); ++number) {
    BusPort& port = *core.ports[number];
    if (!port.confirm) continue;
    port.confirm = false;
    const can::Frame sent = port.current;
    port.notify_transmitted(sent, now);
  }
}

/// The frame ends now for the port that sent it or has received it first; others may be a little behind.
void FrameCompletion::report_arbitration(const can::Frame& frame, can::Time start) {
  senders_.clear();
  for (const BusPort* port : wire_.members) {
    if (!port->phase.transmitted && port->phase.lost_at == WireFrame::Sender::won) continue;
    senders_.push_back({.port = port->index,
                        .lost_at = port->phase.lost_at,
                        .arbitration = can::arbitration(port->bits.sent())});
  }
  const WireArbitration arbitration{.frame = frame, .start = start, .senders = senders_};
  for (WireObserver* observer : wire_.core.wire_observers) observer->arbitration_passed(arbitration);
}

}  // namespace canopus::sim
