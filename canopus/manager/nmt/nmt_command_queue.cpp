#include "canopus/manager/nmt/nmt_command_queue.hpp"

#include <algorithm>

namespace canopus::manager {

void NmtCommandQueue::push(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) {
  if (count_ == capacity) return;
  commands_[(first_ + count_) % capacity] = {command, node_id};
  ++count_;
  flush(now);
}

void NmtCommandQueue::push_of_start_up(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) {
  if (!master_.options.delay_before_each_command) return push(command, node_id, now);
  if (of_start_up_.size() == capacity) return;
  of_start_up_.push_back({command, node_id});
  flush(now);
}

void NmtCommandQueue::withdraw_starts(std::uint8_t node_id) {
  std::erase_if(of_start_up_, [node_id](const Command& waiting) {
    return waiting.command == canopen::NmtCommand::start &&
           (node_id == all_nodes || waiting.node_id == node_id);
  });
  set_alarm();
}

can::Time NmtCommandQueue::start_up_due() const {
  if (!master_.options.delay_before_each_command) return {};
  if (!last_sent_) return next_;
  return std::max(next_, later(*last_sent_, master_.options.start_all_delay));
}

void NmtCommandQueue::clear() noexcept {
  first_ = count_ = 0;
  of_start_up_.clear();
  last_sent_.reset();
  alarm_.cancel();
}

void NmtCommandQueue::set_alarm() noexcept {
  const can::Time of_start_up = start_up_waits() ? start_up_due() : can::never;
  alarm_ = count_ > 0 ? std::min(next_, of_start_up) : of_start_up;
}

void NmtCommandQueue::flush(can::Time now) {
  if (is_flushing_) return;  // asked for from inside send(): it comes after the one that goes out
  is_flushing_ = true;
  while (count_ > 0 && next_ <= now) {
    const Command next = commands_[first_];
    first_ = (first_ + 1) % capacity;  // before, for clear() may come from inside
    --count_;
    if (send(next, now)) continue;
    first_ = (first_ + capacity - 1) % capacity;
    ++count_;
  }
  while (count_ == 0 && start_up_waits() && start_up_due() <= now) {
    const Command next = of_start_up_.front();
    of_start_up_.erase(of_start_up_.begin());  // likewise
    if (!send(next, now)) of_start_up_.insert(of_start_up_.begin(), next);
  }
  is_flushing_ = false;
  set_alarm();
}

bool NmtCommandQueue::send(const Command& command, can::Time now) {
  const bool sent = master_.send(
      can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(command.command), command.node_id}));
  if (!sent) {
    next_ = later(now, retry);
    return false;
  }
  const auto inhibit_time = master_.dictionary().get<std::uint16_t>(0x102A, 0);
  next_ = later(now, std::chrono::microseconds(100) * inhibit_time);
  last_sent_ = now;
  master_.command_sent(command.command, command.node_id, now);
  return true;
}

}  // namespace canopus::manager
