#pragma once
// Faults of a lift, with their start and duration.

#include <cstdint>

#include "canopus/can/time.hpp"

namespace canopus::sim::lift {

struct LiftFault {
  enum class Kind : std::uint8_t {
    light_barrier_blocked,  ///< something stands in the doorway
    light_barrier_defect,  ///< the light barrier reports an error: EMCY FF01H; the door does not close by itself
    drive_fault,           ///< EMCY 2310H, brake, state fault; fault reset has no effect before its end
    panel_unplugged,       ///< a hall panel, or with floor 0 the car panel, is off the bus
    position_lost,         ///< the position unit shows FFFFFFFFH: EMCY 7305H
    overload,              ///< one and a half times the rated load more in the car
  };
  Kind kind = Kind::light_barrier_blocked;
  can::Time at{};
  can::Time until = can::never;
  std::uint8_t car = 0;    ///< 0, 1, ... of the building
  std::uint8_t floor = 0;  ///< of a panel
};

}  // namespace canopus::sim::lift
