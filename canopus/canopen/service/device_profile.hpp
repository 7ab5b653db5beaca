#pragma once
// What a device profile, the low word of 1000H, changes in the services of CiA 301.

#include <cstdint>

#include "canopus/canopen/service/cob_id.hpp"

namespace canopus::canopen {

/// The restricted identifier that PDOs of this profile may have all the same: CiA 417, lifts, has its targets of travels
/// on 180H [FX3U-CAN Tab. 5.5, 5.8].
[[nodiscard]] constexpr std::uint32_t permitted_pdo_identifier(std::uint32_t device_type) noexcept {
  constexpr std::uint32_t profile = 0xFFFF, lift = 417, lift_target = 0x180;
  return (device_type & profile) == lift ? lift_target : no_identifier;
}

}  // namespace canopus::canopen
