#include "canopus/plant/bus_bridge.hpp"

#include <fmt/format.h>

#include "canopus/plant/event.hpp"
#include "canopus/plant/file/plant_file.hpp"

namespace canopus::plant {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t queued_frames = 1024;

}  // namespace

BusBridge::Side::Side(BusBridge& bridge, can::Bus& bus, can::Timeline& timeline)
    : bridge_(bridge), bus_(bus.name()), port_(bus.add_port("bridge")) {
  port_.set_transmit_queue(can::TransmitOrder::identifier, queued_frames);
  timeline.add(*this, fmt::format("bridge on {}", bus.name()));
  port_.connect(*this);
}

BusBridge::BusBridge(can::Bus& from, can::Bus& to, const BridgeSection& section, can::Timeline& timeline,
                     PlantObserver& observer)
    : section_(section), observer_(observer), from_(*this, from, timeline), to_(*this, to, timeline) {
  from_.send_to(to_);
  if (section.both_ways) to_.send_to(from_);
}

void BusBridge::Side::receive(const can::Frame& frame, can::Time now) {
  if (other_ == nullptr || !bridge_.section_.passes(frame) || other_->port_.send(frame)) return;
  if (now < report_again_) return;
  report_again_ = can::later(now, 1s);
  bridge_.observer_.on(
      {now, Failure{fmt::format("bridge {} to {}", bus_, other_->bus_),
                    "frames are lost: the other bus does not take them as fast as they come"}});
}

}  // namespace canopus::plant
