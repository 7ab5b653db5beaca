#include "canopus/lss/lss_search.hpp"

namespace canopus::lss {

namespace {

constexpr std::uint8_t former_index_of_100_kbit = 5;

std::optional<std::uint8_t> index_of(std::uint32_t bit_rate) {
  return bit_rate == 100'000 ? former_index_of_100_kbit : lss::bit_rate_index(bit_rate);
}

can::Duration longest_frame(std::uint32_t bit_rate) {
  constexpr unsigned bits = 135;  // eight bytes, all stuff bits
  return std::chrono::nanoseconds(std::uint64_t{bits} * 1'000'000'000 / bit_rate);
}

}  // namespace

bool LssSearch::start(std::uint8_t node_id, const LssAddress& address, std::uint32_t own_bit_rate,
                      can::Time now) {
  if (running() || !index_of(own_bit_rate)) return false;
  node_id_ = node_id;
  address_ = address;
  own_bit_rate_ = bit_rate_ = own_bit_rate;
  next_index_ = 0;
  found_ = false;
  select(now);
  return true;
}

void LssSearch::select(can::Time now) {
  if (options_.to_waiting_first && state_ != State::preparing) {
    state_ = State::preparing;
    master_.switch_global(false, now);
    return;
  }
  state_ = State::selecting;
  master_.select(address_, now);
}

void LssSearch::cancel() noexcept {
  master_.cancel();
  state_ = State::idle;
  deadline_ = can::never;
}

void LssSearch::wait(State state, can::Duration duration, can::Time now) {
  state_ = state;
  deadline_ = can::later(now, duration);
}

void LssSearch::try_rate(std::uint32_t bit_rate, can::Time now) {
  bit_rate_ = bit_rate;
  listener_->change_bit_rate(bit_rate, now);
  wait(State::settling, options_.settle_time, now);
}

void LssSearch::try_next_rate(can::Time now) {
  while (next_index_ < lss::bit_rates.size()) {
    const std::uint32_t candidate = lss::bit_rates[next_index_++];
    if (candidate != 0 && candidate != own_bit_rate_) return try_rate(candidate, now);
  }
  end(false, now);
}

void LssSearch::lss_finished(LssMaster&, LssResult result, can::Time now) {
  const bool done = result == LssResult::done;
  const bool other_rate = bit_rate_ != own_bit_rate_;
  switch (state_) {
    case State::preparing: return select(now);
    case State::selecting:
      if (!done) return try_next_rate(now);
      state_ = State::setting_node_id;
      master_.configure_node_id(node_id_, now);
      return;
    case State::setting_node_id:
      if (!done) return leave(false, now);
      state_ = State::setting_bit_rate;
      master_.configure_bit_timing(*index_of(own_bit_rate_), now);
      return;
    case State::setting_bit_rate:
      // A device whose rate cannot be set will do, if it has the right one already.
      if (!done && other_rate) return leave(false, now);
      state_ = State::storing;
      master_.store(now);
      return;
    case State::storing:
      // One that cannot store has its node-ID all the same, until it is switched off.
      if (!other_rate) return leave(true, now);
      state_ = State::activating;
      master_.activate_bit_timing(options_.activation_delay, now);
      return;
    case State::activating:
      // The device counts from the end of the frame, which has only been queued.
      return wait(State::before_change,
                  options_.activation_delay + options_.settle_time + longest_frame(bit_rate_), now);
    case State::leaving:
      if (other_rate) return wait(State::left, options_.settle_time + longest_frame(bit_rate_), now);
      return end(found_, now);
    case State::idle:
    case State::settling:
    case State::before_change:
    case State::after_change:
    case State::left: return;
  }
}

void LssSearch::tick(can::Time now) {
  if (master_.deadline() <= now) master_.tick(now);
  if (deadline_ > now) return;
  deadline_ = can::never;
  switch (state_) {
    case State::settling: return select(now);
    case State::before_change:
      bit_rate_ = own_bit_rate_;
      listener_->change_bit_rate(bit_rate_, now);
      return wait(State::after_change, options_.activation_delay, now);
    case State::after_change: return leave(true, now);
    case State::left: return end(found_, now);
    default: return;
  }
}

void LssSearch::leave(bool found, can::Time now) {
  found_ = found;
  state_ = State::leaving;
  master_.switch_global(false, now);
}

void LssSearch::end(bool found, can::Time now) {
  cancel();
  if (bit_rate_ != own_bit_rate_) {
    bit_rate_ = own_bit_rate_;
    listener_->change_bit_rate(bit_rate_, now);
  }
  listener_->lss_search_finished(node_id_, found, now);
}

}  // namespace canopus::lss
