#include "canopus/lss/lss_master.hpp"

#include <algorithm>

namespace canopus::lss {

namespace {

constexpr unsigned parts = 4;
constexpr unsigned bits_of_part = 32;

}  // namespace

bool LssMaster::begin(Service service, std::uint8_t expected) {
  if (busy()) return false;
  service_ = service;
  expected_ = expected;
  answered_ = false;
  error_ = specific_error_ = 0;
  halving_ = false;
  return true;
}

bool LssMaster::single(const can::Frame& request, can::Time now) {
  if (!begin(Service::single, request.data[0])) return false;
  sink_->send(request);
  alarm_ = can::later(now, options_.time_out);
  return true;
}

bool LssMaster::switch_global(bool configuration, can::Time now) {
  if (!begin(Service::unanswered, 0)) return false;
  sink_->send(lss::frame(lss::from_master, lss::command::switch_global, configuration ? 1 : 0));
  alarm_ = can::later(now, options_.pause);
  return true;
}

bool LssMaster::activate_bit_timing(std::chrono::milliseconds delay, can::Time now) {
  if (!begin(Service::unanswered, 0)) return false;
  sink_->send(lss::frame(lss::from_master, lss::command::activate_bit_timing,
                         static_cast<std::uint32_t>(delay.count()) & 0xFFFF));
  alarm_ = can::later(now, options_.pause);
  return true;
}

bool LssMaster::configure_node_id(std::uint8_t node_id, can::Time now) {
  return single(lss::frame(lss::from_master, lss::command::configure_node_id, node_id), now);
}

bool LssMaster::configure_bit_timing(std::uint8_t index, can::Time now, std::uint8_t table) {
  return single(
      lss::frame(lss::from_master, lss::command::configure_bit_timing, table | std::uint32_t{index} << 8),
      now);
}

bool LssMaster::store(can::Time now) {
  return single(lss::frame(lss::from_master, lss::command::store), now);
}

bool LssMaster::inquire(unsigned part, can::Time now) {
  return single(
      lss::frame(lss::from_master, static_cast<std::uint8_t>(lss::command::inquire_vendor + part % parts)),
      now);
}

bool LssMaster::inquire_node_id(can::Time now) {
  return single(lss::frame(lss::from_master, lss::command::inquire_node_id), now);
}

bool LssMaster::identify_unconfigured(can::Time now) {
  if (!begin(Service::single, lss::command::unconfigured_identified)) return false;
  sink_->send(lss::frame(lss::from_master, lss::command::identify_unconfigured));
  alarm_ = can::later(now, options_.time_out);
  return true;
}

void LssMaster::begin_sequence(std::uint8_t first_command, std::initializer_list<std::uint32_t> numbers,
                               can::Time now) {
  first_command_ = first_command;
  steps_ = static_cast<unsigned>(numbers.size());
  step_ = 0;
  std::copy(numbers.begin(), numbers.end(), numbers_);
  answered_ = false;
  send_step(now);
}

bool LssMaster::select(const LssAddress& address, can::Time now) {
  if (!begin(Service::sequence, lss::command::selected)) return false;
  begin_sequence(lss::command::select_vendor,
                 {address.vendor, address.product, address.revision, address.serial}, now);
  return true;
}

void LssMaster::request_range(const LssAddress& low, const LssAddress& high, can::Time now) {
  begin_sequence(lss::command::identify_vendor,
                 {low.vendor, low.product, low.revision, high.revision, low.serial, high.serial}, now);
}

bool LssMaster::identify(const LssAddress& low, const LssAddress& high, can::Time now) {
  if (!begin(Service::sequence, lss::command::identified)) return false;
  request_range(low, high, now);
  return true;
}

bool LssMaster::slow_scan(const LssAddress& low, const LssAddress& high, can::Time now) {
  if (!begin(Service::slow_scan, lss::command::identified)) return false;
  address_ = low;
  highest_ = high;
  halving_ = false;
  request_range(low, high, now);
  return true;
}

// Revision first: among slaves of one revision the serial numbers are halved.
void LssMaster::request_lower_half(can::Time now) {
  halving_ = true;
  LssAddress middle = highest_;
  if (address_.revision != highest_.revision) {
    middle.revision = address_.revision + (highest_.revision - address_.revision) / 2;
  } else if (address_.serial != highest_.serial) {
    middle.serial = address_.serial + (highest_.serial - address_.serial) / 2;
  } else {
    service_ = Service::sequence;
    expected_ = lss::command::selected;
    return begin_sequence(lss::command::select_vendor,
                          {address_.vendor, address_.product, address_.revision, address_.serial}, now);
  }
  request_range(address_, middle, now);
}

void LssMaster::slow_scan_answered(bool answered, can::Time now) {
  if (!halving_) {
    if (!answered) return finish(LssResult::silence, now);
  } else if (const bool of_revision = address_.revision != highest_.revision; answered) {
    auto& bound = of_revision ? highest_.revision : highest_.serial;
    const std::uint32_t lowest = of_revision ? address_.revision : address_.serial;
    bound = lowest + (bound - lowest) / 2;
  } else {
    auto& bound = of_revision ? address_.revision : address_.serial;
    const std::uint32_t highest = of_revision ? highest_.revision : highest_.serial;
    bound += (highest - bound) / 2 + 1;
  }
  request_lower_half(now);
}

void LssMaster::send_step(can::Time now) {
  sink_->send(
      lss::frame(lss::from_master, static_cast<std::uint8_t>(first_command_ + step_), numbers_[step_]));
  ++step_;
  alarm_ = can::later(now, step_ == steps_ ? options_.time_out : options_.pause);
}

bool LssMaster::fastscan(const LssAddress& known, const LssAddress& mask, can::Time now) {
  if (!begin(Service::fastscan, lss::command::identified)) return false;
  for (unsigned part = 0; part < parts; ++part) address_.set_part(part, known.part(part) & mask.part(part));
  mask_ = mask;
  scan_ = Scan::reset;
  part_ = 0;
  send_scan(now);
  return true;
}

void LssMaster::send_scan(can::Time now) {
  can::Frame frame =
      lss::frame(lss::from_master, lss::command::fastscan, scan_ == Scan::reset ? 0 : address_.part(part_));
  switch (scan_) {
    case Scan::reset: frame.data[5] = reset_scan; break;
    case Scan::bit:
      frame.data[5] = static_cast<std::uint8_t>(bit_);
      frame.data[6] = frame.data[7] = static_cast<std::uint8_t>(part_);
      break;
    case Scan::confirm:
      frame.data[6] = static_cast<std::uint8_t>(part_);
      frame.data[7] = static_cast<std::uint8_t>((part_ + 1) % parts);
      break;
  }
  answered_ = false;
  sink_->send(frame);
  alarm_ = can::later(now, options_.time_out);
}

/// Checks the next unknown bit of this part below `bit`; the confirmation when there is none.
void LssMaster::scan_below(unsigned bit) {
  while (bit > 0 && (mask_.part(part_) >> (bit - 1) & 1U) != 0) --bit;
  scan_ = bit == 0 ? Scan::confirm : Scan::bit;
  bit_ = bit == 0 ? 0 : bit - 1;
}

// Silence means that every slave still in the race has a 1 at this bit: those with a 0 would have answered.
void LssMaster::scan_answered(bool answered, can::Time now) {
  switch (scan_) {
    case Scan::reset:
      if (!answered) return finish(LssResult::silence, now);
      scan_below(bits_of_part);
      break;
    case Scan::bit:
      if (!answered) address_.set_part(part_, address_.part(part_) | 1U << bit_);
      scan_below(bit_);
      break;
    case Scan::confirm:
      if (!answered) return finish(LssResult::lost, now);
      if (++part_ == parts) return finish(LssResult::done, now);
      scan_below(bits_of_part);
      break;
  }
  send_scan(now);
}

void LssMaster::receive(const can::Frame& frame, can::Time now) {
  if (frame.identifier != lss::from_slave || frame.extended || frame.remote || frame.length() != 8) return;
  if (!busy() || frame.data[0] != expected_) return;
  switch (service_) {
    case Service::none:
    case Service::unanswered: return;
    case Service::fastscan:
    case Service::slow_scan:
      // Several slaves answer; the next question must wait for all of them, and so for the whole time.
      answered_ = service_ == Service::fastscan || step_ == steps_;
      return;
    case Service::sequence:
      if (step_ != steps_) return;
      return finish(LssResult::done, now);
    case Service::single:
      value_ = lss::number(frame);
      if (expected_ >= lss::command::inquire_vendor || expected_ == lss::command::unconfigured_identified) {
        return finish(LssResult::done, now);
      }
      error_ = frame.data[1];
      specific_error_ = frame.data[2];
      return finish(error_ == 0 ? LssResult::done : LssResult::refused, now);
  }
}

void LssMaster::tick(can::Time now) {
  if (alarm_ > now) return;
  alarm_ = can::never;
  switch (service_) {
    case Service::none: return;
    case Service::unanswered: return finish(LssResult::done, now);
    case Service::single: return finish(LssResult::silence, now);
    case Service::sequence:
      if (step_ != steps_) return send_step(now);
      return finish(halving_ ? LssResult::lost : LssResult::silence, now);
    case Service::slow_scan:
      if (step_ != steps_) return send_step(now);
      return slow_scan_answered(answered_, now);
    case Service::fastscan: return scan_answered(answered_, now);
  }
}

void LssMaster::cancel() noexcept {
  service_ = Service::none;
  alarm_ = can::never;
}

void LssMaster::finish(LssResult result, can::Time now) {
  cancel();
  listener_->lss_finished(*this, result, now);
}

}  // namespace canopus::lss
