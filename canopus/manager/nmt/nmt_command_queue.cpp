#include "canopus/manager/nmt/nmt_command_queue.hpp"

namespace canopus::manager {

void NmtCommandQueue::push(canopen::NmtCommand command, std::uint8_t node_id, can::Time now) {
  if (count_ == capacity) return;
  commands_[(first_ + count_) % capacity] = {command, node_id};
  ++count_;
  flush(now);
}

void NmtCommandQueue::flush(can::Time now) {
  if (is_flushing_) return;  // asked for from inside send(): it comes after the one that goes out
  is_flushing_ = true;
  while (count_ > 0 && next_ <= now) {
    const Command next = commands_[first_];
    first_ = (first_ + 1) % capacity;  // before, for clear() may come from inside
    --count_;
    const bool sent = master_.send(
        can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(next.command), next.node_id}));
    if (!sent) {
      first_ = (first_ + capacity - 1) % capacity;
      ++count_;
      next_ = later(now, retry);
      break;
    }
    const auto inhibit_time = master_.dictionary().get<std::uint16_t>(0x102A, 0);
    next_ = later(now, std::chrono::microseconds(100) * inhibit_time);
    master_.command_sent(next.command, next.node_id, now);
  }
  is_flushing_ = false;
  alarm_ = count_ > 0 ? next_ : can::never;
}

}  // namespace canopus::manager
