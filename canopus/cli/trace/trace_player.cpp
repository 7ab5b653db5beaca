#include "canopus/cli/trace/trace_player.hpp"

#include <algorithm>
#include <chrono>

namespace canopus::cli {
namespace {

/// The pause for a bus that accepts no frames, and the number of frames sent without checking it.
constexpr can::Duration pause = std::chrono::milliseconds(1);
constexpr int at_once = 64;

}  // namespace

void TracePlayer::start(can::Time now, can::Duration first) {
  started_ = now;
  first_ = first;
  done_ = false;
  alarm() = now;
  load_next();
  alarm() = std::max(deadline(), now);
}

void TracePlayer::load_next() {
  next_ = source_();
  if (!next_) {
    done_ = true;
    alarm() = can::never;
    return;
  }
  if (speed_ == 0) return;
  const double since = static_cast<double>((next_->time - first_).count()) / speed_;
  // 9e18 ns are more than a trace can have
  const can::Duration wait(since <= 0      ? 0
                           : since >= 9e18 ? can::Duration::max().count()
                                           : static_cast<std::int64_t>(since));
  alarm() = std::max(deadline(), can::later(started_, wait));
}

void TracePlayer::tick(can::Time now) {
  for (int i = 0; i < at_once && next_ && deadline() <= now; ++i) {
    held_ = !bus_.send(next_->frame);
    if (held_) {
      alarm() = now + pause;
      return;
    }
    ++sent_;
    position_ = next_->time;
    load_next();
  }
  // what is late stays due, but others on the loop come first
  if (next_ && deadline() <= now) alarm() = now + can::Duration(1);
}

}  // namespace canopus::cli
