#pragma once
// Forwards frames between two buses of a plant, like a CAN bridge.

#include <cstdint>

#include "canopus/can/bus.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::plant {

struct BridgeSection;

/// Stores each frame that passes its filter, whole, and sends it on the other bus as soon as that is free. A
/// bridge acknowledges on both sides, as a node does.
class BusBridge {
 public:
  /// Adds itself to both buses and to the timeline; all outlive it.
  BusBridge(can::Bus& from, can::Bus& to, const BridgeSection& section, can::Timeline& timeline,
            PlantObserver& observer);

 private:
  /// One side. It forwards received frames to the other one, if frames pass in that direction.
  class Side final : public can::Participant {
   public:
    Side(BusBridge& bridge, can::Bus& bus, can::Timeline& timeline);
    void send_to(Side& other) { other_ = &other; }
    void receive(const can::Frame& frame, can::Time now) override;
    void tick(can::Time) override {}

   private:
    BusBridge& bridge_;
    std::string_view bus_;
    can::Port& port_;
    Side* other_ = nullptr;
    can::Time report_again_{};
  };

  const BridgeSection& section_;
  PlantObserver& observer_;
  Side from_;
  Side to_;
};

}  // namespace canopus::plant
