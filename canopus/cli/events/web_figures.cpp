#include "canopus/cli/events/web_figures.hpp"

#include <algorithm>

namespace canopus::cli {
namespace {

// [CiA 301 7.3.5]
constexpr std::uint32_t sync_id = 0x080;
constexpr std::uint32_t sdo_answer_id = 0x580;
constexpr std::uint32_t sdo_request_id = 0x600;
constexpr std::uint32_t error_control_id = 0x700;
constexpr std::uint32_t node_bits = 0x7F;

}  // namespace

void TimeFigures::add(can::Duration time) noexcept {
  least_ = count_ == 0 ? time : std::min(least_, time);
  most_ = std::max(most_, time);
  sum_ += time;
  ++count_;
}

can::Duration TimeFigures::mean() const noexcept {
  return count_ == 0 ? can::Duration{} : sum_ / static_cast<std::int64_t>(count_);
}

text::Json time_fields(const TimeFigures& times) {
  const auto seconds = [](can::Duration time) { return can::seconds(can::Time{time}); };
  return {{"count", times.count()},
          {"least", seconds(times.least())},
          {"mean", seconds(times.mean())},
          {"most", seconds(times.most())}};
}

void WebFigures::frame_completed(const can::Frame& frame, can::Time end) noexcept {
  if (frame.extended || frame.remote) return;
  if (frame.identifier == sync_id) {
    if (last_sync_) sync_.add(end - *last_sync_);
    last_sync_ = end;
    return;
  }
  Node& node = nodes_[frame.identifier & node_bits];
  switch (frame.identifier & ~node_bits) {
    case sdo_request_id: node.asked = end; break;
    case sdo_answer_id:
      if (node.asked) node.answers.add(end - *node.asked);
      node.asked.reset();
      break;
    case error_control_id:
      if (frame.dlc != 1 || frame.data[0] == 0) break;
      node.period = node.heartbeat ? end - *node.heartbeat : can::Duration{};
      node.heartbeat = end;
      break;
    default: break;
  }
}

}  // namespace canopus::cli
