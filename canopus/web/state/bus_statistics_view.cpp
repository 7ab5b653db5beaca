#include "canopus/web/state/bus_statistics_view.hpp"

#include <algorithm>

namespace canopus::web {
namespace {

namespace cob_id = canopen::cob_id;

constexpr std::uint32_t node_bits = 0x7F;
constexpr std::uint8_t state_bits = 0x7F;  // the other one is the toggle bit of node guarding

/// The state in an error control message; none: one that CiA 301 does not know.
std::optional<canopen::NmtState> state_of_byte(std::uint8_t byte) noexcept {
  switch (const auto state = static_cast<canopen::NmtState>(byte & state_bits)) {
    case canopen::NmtState::initialising: return canopen::NmtState::pre_operational;  // the boot-up message
    case canopen::NmtState::stopped:
    case canopen::NmtState::operational:
    case canopen::NmtState::pre_operational: return state;
  }
  return {};
}

std::optional<canopen::NmtState> state_after(std::uint8_t command) noexcept {
  switch (static_cast<canopen::NmtCommand>(command)) {
    case canopen::NmtCommand::start: return canopen::NmtState::operational;
    case canopen::NmtCommand::stop: return canopen::NmtState::stopped;
    case canopen::NmtCommand::enter_pre_operational: return canopen::NmtState::pre_operational;
    case canopen::NmtCommand::reset_node:
    case canopen::NmtCommand::reset_communication: return canopen::NmtState::initialising;
  }
  return {};
}

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

/// Node-ID 0: all. Of a node that has sent nothing it is not known whether it obeys.
void BusStatisticsView::commanded(std::uint8_t command, std::uint8_t node_id) noexcept {
  const auto state = state_after(command);
  if (!state || node_id >= nodes_.size()) return;
  for (std::size_t number = 1; number < nodes_.size(); ++number) {
    Node& node = nodes_[number];
    if (node.state && (node_id == 0 || node_id == number)) node.state = state;
  }
}

void BusStatisticsView::frame_completed(const can::Frame& frame, can::Time end) noexcept {
  if (frame.extended || frame.remote) return;
  if (frame.identifier == cob_id::nmt) {
    if (frame.dlc == 2) commanded(frame.data[0], frame.data[1]);
    return;
  }
  if (frame.identifier == cob_id::sync) {
    if (last_sync_) sync_.add(end - *last_sync_);
    last_sync_ = end;
    return;
  }
  Node& node = nodes_[frame.identifier & node_bits];
  switch (frame.identifier & ~node_bits) {
    case cob_id::sdo_request: node.asked = end; break;
    case cob_id::sdo_response:
      if (node.asked) node.answers.add(end - *node.asked);
      node.asked.reset();
      break;
    case cob_id::error_control:
      if (frame.dlc != 1) break;
      if (const auto state = state_of_byte(frame.data[0])) node.state = state;
      if (frame.data[0] == 0) break;
      node.period = node.heartbeat ? end - *node.heartbeat : can::Duration{};
      node.heartbeat = end;
      break;
    default: break;
  }
}

}  // namespace canopus::web
