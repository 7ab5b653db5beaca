#pragma once
// A hall or car panel: buttons that send virtual inputs (6010H), lamps and displays that virtual outputs (6011H) set
// [CiA 417; FX3U-CAN 5.10.2, 5.10.3].

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "canopus/can/time.hpp"

namespace canopus::sim::lift {

/// The six bytes of a virtual input or output: basic function, sub-function, lifts, floor, doors, data.
using Mapping = std::array<std::uint8_t, 6>;

/// Basic functions [FX3U-CAN 5.10.2, 5.10.3].
inline constexpr std::uint8_t controller_command = 0x00, hall_call = 0x02, car_call = 0x05,
                              special_function = 0x0E, position_indication = 0x40, hall_lantern = 0x41,
                              direction_indication = 0x42, special_indication = 0x43,
                              arrival_indication = 0x44;
/// Sub-functions of a hall call, and bits of arrows.
inline constexpr std::uint8_t up = 0x01, down = 0x02;
/// Sub-functions of a special function.
inline constexpr std::uint8_t door_open = 0x09, door_close = 0x0A;

class Panel {
 public:
  /// `floor` 0: of a car. `lifts`: bits of those it belongs to. `door`: 0, 1, ... of its side.
  Panel(std::uint8_t floor, std::uint8_t lifts, unsigned door)
      : floor_(floor), lifts_(lifts), door_bit_(static_cast<std::uint8_t>(1U << door)) {}

  /// A person presses a button now, and releases it after 0.3 s. A panel without supply, or with all messages
  /// waiting, loses it.
  void press(std::uint8_t basic, std::uint8_t sub, can::Time now);
  /// The next message to send, if there is one now.
  [[nodiscard]] std::optional<Mapping> next_input(can::Time now);
  /// When there is one; now at the earliest, can::never without.
  [[nodiscard]] can::Time deadline(can::Time now) const;
  /// A virtual output came. True when it was for this panel.
  bool output(const Mapping& output, can::Time now);
  /// Without supply: lamps and displays are off, buttons dead.
  void forget();

  [[nodiscard]] std::uint8_t floor() const { return floor_; }
  [[nodiscard]] std::uint8_t lifts() const { return lifts_; }
  /// Lamp of a hall button (`up`, `down`), or of a floor in the car.
  [[nodiscard]] bool is_lit(std::uint8_t sub) const { return lamps_[sub]; }
  [[nodiscard]] std::uint8_t shown_floor() const { return shown_floor_; }  ///< 0: nothing
  [[nodiscard]] std::uint8_t arrows() const { return arrows_; }  ///< bits `up`, `down`; 4, 5: it moves
  [[nodiscard]] std::uint8_t indication() const { return indication_; }  ///< special indication; 0: none
  /// Bits `up`, `down` of the hall lantern of a lift (0 to 7).
  [[nodiscard]] std::uint8_t lantern(unsigned lift) const { return lanterns_[lift]; }

 private:
  struct Message {
    std::uint8_t basic = 0, sub = 0, state = 0;
    can::Time due{};
  };
  void queue(const Message& message);
  std::uint8_t floor_;
  std::uint8_t lifts_;
  std::uint8_t door_bit_;
  std::array<Message, 64> messages_{};
  std::size_t waiting_ = 0;
  std::bitset<256> lamps_{};
  std::uint8_t shown_floor_ = 0;
  std::uint8_t arrows_ = 0;
  std::uint8_t indication_ = 0;
  std::array<std::uint8_t, 8> lanterns_{};
};

}  // namespace canopus::sim::lift
