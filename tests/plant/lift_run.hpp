#pragma once
// Lifts of a plant, and an FX3U-CAN in 417 mode as their controller.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/plant/lift_on_bus.hpp"

#include "plant/lift_control.hpp"
#include "support/plant_folder.hpp"

namespace canopus::plant {

inline constexpr std::string_view lift_controller = R"(
[[bus]]
name = "hoist"
bit_rate = 250_000

[[plc]]
name = "plc"
family = "FX3"
listen = "off"

[[plc.module]]
model = "FX3U-CAN"
position = 0
node = 1
buffer = { G21 = 417, G26 = 0 }
[plc.module.objects]
"1F80:00" = 0x03
"6001:00" = 0x03
"1902:01" = 0x40000182
"1904:01" = 0x40000180
"1908:01" = 0x40000200
"1912:01" = 0x40000192
"1914:01" = 0x40000190
"1918:01" = 0x40000210
)";

class LiftRun : public support::PlantFolder, public PlantObserver {
 protected:
  void start(std::string_view lift) {
    plant_ = support::PlantFolder::load(std::string(lift_controller) + std::string(lift), *this);
    ASSERT_NE(plant_, nullptr);
    plant_->power_on();
  }
  [[nodiscard]] const sim::lift::Building& building() { return plant_->lift(0).building(); }
  [[nodiscard]] sim::lift::LiftReport report() { return building().report(); }

  std::unique_ptr<Plant> plant_;
};

}  // namespace canopus::plant
