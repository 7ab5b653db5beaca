#include "canopus/sim/bus_core.hpp"

namespace canopus::sim {
namespace {

constexpr std::size_t default_queue_capacity = 128;
constexpr std::size_t max_queue_capacity = 65'535;

}  // namespace

BusPort::BusPort(BusCore& bus_core, Segment& port_segment, std::size_t port_index, std::string port_name)
    : core(bus_core),
      segment(&port_segment),
      index(port_index),
      rate(bus_core.bit_rate),
      port_name_(std::move(port_name)) {
  queue.configure(true, default_queue_capacity);
  accept(Acceptance{});
}

bool BusPort::send(const can::Frame& frame) {
  if (!queue.push(frame, sending ? 1 : 0)) {
    ++refused;
    return false;
  }
  segment->port_changed(*this);
  return true;
}

void BusPort::restart(std::uint32_t bit_rate) {
  rate = bit_rate;
  faults.reset();
  queue.clear();
  refused = 0;
  overrun = 0;
  segment->port_changed(*this);
}

void BusPort::connect(can::Participant& new_participant, can::Timeline::Handle new_handle) {
  participant = &new_participant;
  handle = new_handle;
}

void BusPort::plug(bool plugged) {
  if (on_wire == plugged) return;
  on_wire = plugged;
  segment->port_changed(*this);
}

void BusPort::accept(const Acceptance& acceptance) {
  for (std::size_t identifier = 0; identifier < acceptance.base.size(); ++identifier) {
    core.acceptance.set(index, identifier, acceptance.base[identifier]);
  }
  core.acceptance.set(index, AcceptanceTable::extended_row, acceptance.extended);
}

void BusPort::set_transmit_queue(TransmitOrder order, std::size_t capacity) {
  queue.configure(order == TransmitOrder::identifier, std::min(capacity, max_queue_capacity));
  segment->port_changed(*this);
}

}  // namespace canopus::sim
