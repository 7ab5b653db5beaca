#include "canopus/lss/lss_slave.hpp"

#include <chrono>

#include "canopus/can/little_endian.hpp"

namespace canopus::lss {

namespace {

// Error byte of the answers.
constexpr std::uint32_t ok = 0;
constexpr std::uint32_t out_of_range = 1;

constexpr bool is_node_id(std::uint8_t id) noexcept { return id >= 1 && id <= 127; }

}  // namespace

void LssSlave::start(std::uint8_t node_id, std::uint32_t bit_rate) noexcept {
  node_id_ = pending_node_id_ = node_id;
  bit_rate_ = pending_bit_rate_ = bit_rate;
  state_ = State::waiting;
  switching_ = Switching::no;
  selected_parts_ = identified_parts_ = fastscan_part_ = 0;
  alarm_ = can::never;
}

void LssSlave::answer(std::uint8_t command, std::uint32_t value) {
  sink_->send(lss::frame(lss::from_slave, command, value));
}

void LssSlave::receive(const can::Frame& frame, can::Time now) {
  if (frame.identifier != lss::from_master || frame.extended || frame.remote || frame.length() != 8 ||
      silent()) {
    return;
  }
  const std::uint8_t command = frame.data[0];
  if (command == lss::command::switch_global) return switch_global(frame.data[1], now);
  if (command >= lss::command::select_vendor && command <= lss::command::select_serial) return select(frame);
  if (command >= lss::command::identify_vendor && command <= lss::command::identify_serial_high) {
    return identify(frame);
  }
  if (command == lss::command::identify_unconfigured) {
    if (node_id_ == lss::unconfigured && pending_node_id_ == lss::unconfigured) {
      answer(lss::command::unconfigured_identified);
    }
    return;
  }
  if (command == lss::command::fastscan) return fastscan(frame);
  if (state_ == State::configuration) configure(frame, now);
}

void LssSlave::switch_global(std::uint8_t mode, can::Time now) {
  if (mode > 1) return;
  state_ = mode == 1 ? State::configuration : State::waiting;
  selected_parts_ = 0;
  if (state_ == State::waiting && node_id_ == lss::unconfigured && is_node_id(pending_node_id_)) {
    node_id_ = pending_node_id_;
    listener_->node_id_assigned(node_id_, now);
  }
}

// The four parts must come in their order; one that does not match restarts the sequence.
void LssSlave::select(const can::Frame& frame) {
  if (state_ != State::waiting) return;
  const auto part = static_cast<std::uint8_t>(frame.data[0] - lss::command::select_vendor);
  const bool fits = part == selected_parts_ && lss::number(frame) == address_.part(part);
  selected_parts_ = fits ? static_cast<std::uint8_t>(part + 1) : std::uint8_t{0};
  if (selected_parts_ != 4) return;
  selected_parts_ = 0;
  state_ = State::configuration;
  answer(lss::command::selected);
}

// Vendor, product, lowest and highest revision, lowest and highest serial number.
void LssSlave::identify(const can::Frame& frame) {
  const auto step = static_cast<std::uint8_t>(frame.data[0] - lss::command::identify_vendor);
  const std::uint32_t value = lss::number(frame);
  bool fits = false;
  switch (step) {
    case 0: fits = value == address_.vendor; break;
    case 1: fits = value == address_.product; break;
    case 2: fits = value <= address_.revision; break;
    case 3: fits = value >= address_.revision; break;
    case 4: fits = value <= address_.serial; break;
    default: fits = value >= address_.serial; break;
  }
  fits = fits && (step == 0 || step == identified_parts_);
  identified_parts_ = fits ? static_cast<std::uint8_t>(step + 1) : std::uint8_t{0};
  if (identified_parts_ != 6) return;
  identified_parts_ = 0;
  answer(lss::command::identified);
}

// Bytes 1..4 the number, 5 the lowest bit to compare (80H: restart), 6 the part of the address, 7 the next
// one.
void LssSlave::fastscan(const can::Frame& frame) {
  if (node_id_ != lss::unconfigured || pending_node_id_ != lss::unconfigured || state_ != State::waiting)
    return;
  const std::uint8_t bit = frame.data[5];
  const std::uint8_t part = frame.data[6];
  const std::uint8_t next = frame.data[7];
  if (bit == reset_scan) {
    fastscan_part_ = 0;
    return answer(lss::command::identified);
  }
  if (bit > 31 || part > 3 || next > 3 || part != fastscan_part_) return;
  const std::uint32_t differences = lss::number(frame) ^ address_.part(part);
  if (differences >> bit != 0) return;
  fastscan_part_ = next;
  if (bit == 0 && next < part) state_ = State::configuration;
  answer(lss::command::identified);
}

void LssSlave::configure(const can::Frame& frame, can::Time now) {
  const std::uint8_t command = frame.data[0];
  switch (command) {
    case lss::command::configure_node_id: {
      const std::uint8_t wanted = frame.data[1];
      const bool valid = is_node_id(wanted) || wanted == lss::unconfigured;
      if (valid) pending_node_id_ = wanted;
      return answer(command, valid ? ok : out_of_range);
    }
    case lss::command::configure_bit_timing: {
      const std::uint8_t index = frame.data[2];
      const bool known = frame.data[1] == 0 && index < lss::bit_rates.size() && lss::bit_rates[index] != 0 &&
                         listener_->supports_bit_rate(lss::bit_rates[index]);
      if (known) pending_bit_rate_ = lss::bit_rates[index];
      return answer(command, known ? ok : out_of_range);
    }
    case lss::command::activate_bit_timing:
      switch_delay_ = std::chrono::milliseconds(can::load_as<std::uint16_t>(&frame.data[1]));
      switching_ = Switching::before;
      alarm_ = can::later(now, switch_delay_);
      return;
    case lss::command::store:
      return answer(command,
                    static_cast<std::uint32_t>(listener_->store(pending_node_id_, pending_bit_rate_)));
    case lss::command::inquire_node_id: return answer(command, node_id_);
    default:
      if (command >= lss::command::inquire_vendor && command <= lss::command::inquire_serial) {
        answer(command, address_.part(command - lss::command::inquire_vendor));
      }
      return;
  }
}

void LssSlave::tick(can::Time now) {
  if (alarm_ > now) return;
  alarm_ = can::never;
  switch (switching_) {
    case Switching::no: return;
    case Switching::before:
      switching_ = Switching::after;
      alarm_ = can::later(now, switch_delay_);
      bit_rate_ = pending_bit_rate_;
      listener_->change_bit_rate(bit_rate_, now);
      return;
    case Switching::after: switching_ = Switching::no; return;
  }
}

}  // namespace canopus::lss
