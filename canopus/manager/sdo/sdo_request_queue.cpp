#include "canopus/manager/sdo/sdo_request_queue.hpp"

namespace canopus::manager {

namespace {
bool is_abort(const can::Frame& request) noexcept { return request.data[0] == 0x80; }
}  // namespace

bool SdoRequestQueue::send(const can::Frame& request, can::Sink& sink, can::Time now) {
  if (!has_reports_) return sink.send(request);
  if (count_ == 0 && with_controller_ == none) return submit(request, sink, now);
  std::uint16_t& of_this_node = waiting_of_[node(request.identifier)];
  if (count_ == capacity || (of_this_node >= share && count_ > of_this_node && !is_abort(request)))
    return false;
  waiting_[(first_ + count_++) % capacity] = request;
  ++of_this_node;
  if (now - last_ > stall) {
    with_controller_ = none;
    release(sink, now);
  }
  return true;
}

void SdoRequestQueue::transmitted(std::uint32_t identifier, can::Sink& sink, can::Time now) {
  has_reports_ = true;
  last_ = now;
  if (identifier == with_controller_) with_controller_ = none;
  release(sink, now);
}

bool SdoRequestQueue::waits(std::uint32_t identifier, can::Time now) const noexcept {
  return now - last_ <= stall && (waiting_of_[node(identifier)] != 0 || with_controller_ == identifier);
}

bool SdoRequestQueue::submit(const can::Frame& request, can::Sink& sink, can::Time now) {
  // Noted first: on a bus that is a function call, the transmission is reported before it returns.
  with_controller_ = request.identifier;
  last_ = now;
  if (sink.send(request)) return true;
  with_controller_ = none;
  return false;
}

void SdoRequestQueue::release(can::Sink& sink, can::Time now) {
  while (count_ > 0 && with_controller_ == none) {
    const can::Frame request = waiting_[first_];
    first_ = (first_ + 1) % capacity;
    --count_;
    --waiting_of_[node(request.identifier)];
    if (submit(request, sink, now)) continue;
    first_ = (first_ + capacity - 1) % capacity;  // no room: it stays the first one
    ++count_;
    ++waiting_of_[node(request.identifier)];
    return;
  }
}

}  // namespace canopus::manager
