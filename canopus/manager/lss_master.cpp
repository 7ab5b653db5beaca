#include "canopus/manager/lss_master.hpp"

namespace canopus::manager {

namespace {

constexpr unsigned parts = 4;
constexpr unsigned highest_bit = 31;
constexpr std::uint8_t reset_scan = 0x80;

}  // namespace

bool LssMaster::begin(Service service, std::uint8_t expected) {
  if (busy()) return false;
  service_ = service;
  expected_ = expected;
  answered_ = false;
  error_ = specific_error_ = 0;
  return true;
}

bool LssMaster::single(const can::Frame& request, can::Time now) {
  if (!begin(Service::single, request.data[0])) return false;
  sink_->send(request);
  deadline_ = can::later(now, options_.time_out);
  return true;
}

bool LssMaster::switch_global(bool configuration, can::Time now) {
  if (!begin(Service::unanswered, 0)) return false;
  sink_->send(lss::frame(lss::from_master, lss::command::switch_global, configuration ? 1 : 0));
  deadline_ = can::later(now, options_.pause);
  return true;
}

bool LssMaster::activate_bit_timing(std::chrono::milliseconds delay, can::Time now) {
  if (!begin(Service::unanswered, 0)) return false;
  sink_->send(lss::frame(lss::from_master, lss::command::activate_bit_timing,
                         static_cast<std::uint32_t>(delay.count()) & 0xFFFF));
  deadline_ = can::later(now, options_.pause);
  return true;
}

bool LssMaster::configure_node_id(std::uint8_t node_id, can::Time now) {
  return single(lss::frame(lss::from_master, lss::command::configure_node_id, node_id), now);
}

bool LssMaster::configure_bit_timing(std::uint8_t index, can::Time now) {
  return single(lss::frame(lss::from_master, lss::command::configure_bit_timing, std::uint32_t{index} << 8),
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
  deadline_ = can::later(now, options_.time_out);
  return true;
}

bool LssMaster::select(const LssAddress& address, can::Time now) {
  if (!begin(Service::sequence, lss::command::selected)) return false;
  first_command_ = lss::command::select_vendor;
  steps_ = parts;
  step_ = 0;
  for (unsigned part = 0; part < parts; ++part) numbers_[part] = address.part(part);
  send_step(now);
  return true;
}

bool LssMaster::identify(const LssAddress& low, const LssAddress& high, can::Time now) {
  if (!begin(Service::sequence, lss::command::identified)) return false;
  first_command_ = lss::command::identify_vendor;
  steps_ = 6;
  step_ = 0;
  const std::uint32_t numbers[] = {low.vendor,    low.product, low.revision,
                                   high.revision, low.serial,  high.serial};
  for (unsigned i = 0; i < steps_; ++i) numbers_[i] = numbers[i];
  send_step(now);
  return true;
}

void LssMaster::send_step(can::Time now) {
  sink_->send(
      lss::frame(lss::from_master, static_cast<std::uint8_t>(first_command_ + step_), numbers_[step_]));
  ++step_;
  deadline_ = can::later(now, step_ == steps_ ? options_.time_out : options_.pause);
}

bool LssMaster::fastscan(can::Time now) {
  if (!begin(Service::fastscan, lss::command::identified)) return false;
  address_ = {};
  scan_ = Scan::reset;
  part_ = 0;
  send_scan(now);
  return true;
}

void LssMaster::send_scan(can::Time now) {
  can::Frame frame = lss::frame(lss::from_master, lss::command::fastscan, address_.part(part_));
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
  deadline_ = can::later(now, options_.time_out);
}

// Silence says that every slave still in the race has a 1 at this bit: those with a 0 would have answered.
void LssMaster::scan_answered(bool answered, can::Time now) {
  switch (scan_) {
    case Scan::reset:
      if (!answered) return finish(LssResult::silence, now);
      scan_ = Scan::bit;
      bit_ = highest_bit;
      break;
    case Scan::bit:
      if (!answered) address_.set_part(part_, address_.part(part_) | 1U << bit_);
      if (bit_ == 0) {
        scan_ = Scan::confirm;
      } else {
        --bit_;
      }
      break;
    case Scan::confirm:
      if (!answered) return finish(LssResult::lost, now);
      if (++part_ == parts) return finish(LssResult::done, now);
      scan_ = Scan::bit;
      bit_ = highest_bit;
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
      // Several slaves answer; the next question must wait for all of them, and so for the whole time.
      answered_ = true;
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
  if (deadline_ > now) return;
  deadline_ = can::never;
  switch (service_) {
    case Service::none: return;
    case Service::unanswered: return finish(LssResult::done, now);
    case Service::single: return finish(LssResult::silence, now);
    case Service::sequence:
      if (step_ != steps_) return send_step(now);
      return finish(LssResult::silence, now);
    case Service::fastscan: return scan_answered(answered_, now);
  }
}

void LssMaster::cancel() noexcept {
  service_ = Service::none;
  deadline_ = can::never;
}

void LssMaster::finish(LssResult result, can::Time now) {
  cancel();
  user_->lss_finished(*this, result, now);
}

}  // namespace canopus::manager
