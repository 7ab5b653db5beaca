#pragma once
// The CiA 417 devices of a building: which there are, with which objects, and their device files.
//
// Objects of lift n are 0800H x (n - 1) above those of lift 1, CAN-IDs 10H x (n - 1). A PDO has the number
// that its other end has in a lift controller (1903H of a drive goes to 1503H of a controller), so that no
// device of one kind stands in another's way.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "canopus/eds/device_file.hpp"

namespace canopus::sim::lift {

enum class UnitKind : std::uint8_t {
  hall_panel,  ///< one on each floor: buttons, lamps, displays
  car_panel,   ///< one in each car
  car_drive_unit,
  car_position_unit,
  load_unit,
  car_door_unit,  ///< with its light barrier
};

inline constexpr unsigned most_lifts = 8;
inline constexpr unsigned most_doors = 3;      ///< of a car: door 4 has no PDO [FX3U-CAN 5.6]
inline constexpr unsigned highest_panel = 64;  ///< node-ID; a controller ignores higher ones [FX3U-CAN 5.6]

/// One device.
struct Unit {
  UnitKind kind = UnitKind::hall_panel;
  std::uint8_t lifts = 1;  ///< bits: lift 1 is bit 0
  std::uint8_t lift = 0;   ///< 0 to 7: of what belongs to one car
  std::uint8_t car = 0;    ///< 0, 1, ... in its building
  std::uint8_t floor = 0;  ///< 1 to 254: of a hall panel
  std::uint8_t door = 0;   ///< 0 to 2: of a car door unit, and the side of a hall panel
};

/// Hall panels by floor, car panels by lift, then each lift's drive, position, load and doors. `floor_doors`: the door (0 to
/// 2) of each floor.
[[nodiscard]] std::vector<Unit> units_of(const std::vector<std::uint8_t>& lifts,
                                         const std::vector<std::uint8_t>& floor_doors);

/// "lift 1 drive", "lift 1+2 floor 3": for people.
[[nodiscard]] std::string name(const Unit& unit);

/// The device's description. It depends on kind, lift and door, not on the floor.
[[nodiscard]] std::shared_ptr<const eds::DeviceFile> device_file(const Unit& unit);
/// The same as an EDS file [CiA 306].
[[nodiscard]] std::string eds_text(const Unit& unit);

/// The PDO number (from 0) by which a panel sends its virtual inputs.
inline constexpr std::uint16_t input_pdo = 0x81;

}  // namespace canopus::sim::lift
