#pragma once
// A car door unit with its light barrier [CiA 417; FX3U-CAN 5.10.4 to 5.10.6]: it takes time, and reopens
// when a person stands in the doorway.

#include <cstdint>

#include "canopus/can/time.hpp"

namespace canopus::sim::lift {

struct DoorSettings {
  double width = 900;                                  ///< mm, clear opening
  can::Duration open_time = std::chrono::seconds(2);   ///< from closed to open; above 0
  can::Duration close_time = std::chrono::seconds(3);  ///< above 0
};

class DoorUnit {
 public:
  explicit DoorUnit(const DoorSettings& settings) : settings_(settings) {}

  /// 6300H. A command counts when it comes, that is when it differs from the one before: 0, 1 close, 2 nudging (half the
  /// speed, and no reopening), 3, 4 open, 7, 8 stop, EH reset (ends the memory of an obstacle; as FH otherwise). To close
  /// waits while the light barrier is interrupted; after a reopening the door stays open until the next command.
  void command(std::uint16_t control_word);
  /// `blocked`: the light barrier is interrupted.
  void step(can::Duration elapsed, bool blocked);

  [[nodiscard]] std::uint16_t status_word() const;             ///< 6301H
  [[nodiscard]] double position() const { return position_; }  ///< mm, 0 closed
  [[nodiscard]] bool is_closed() const { return position_ <= 0; }
  [[nodiscard]] bool is_open() const { return position_ >= settings_.width; }
  /// People can pass.
  [[nodiscard]] bool is_passable() const { return position_ >= 0.8 * settings_.width; }
  [[nodiscard]] bool moves() const { return drive_ != Drive::none; }
  [[nodiscard]] std::uint32_t openings() const { return openings_; }    ///< times it left its closed position
  [[nodiscard]] std::uint32_t reversals() const { return reversals_; }  ///< reopenings

 private:
  enum class Drive : std::uint8_t { none, opening, closing, reopening };
  DoorSettings settings_;
  std::uint16_t control_word_ = 0xFFFF;
  Drive drive_ = Drive::none;
  double position_ = 0;
  bool wants_to_close_ = false;  // waits for the light barrier
  bool forces_ = false;          // nudging
  bool has_torque_ = false;
  std::uint32_t openings_ = 0;
  std::uint32_t reversals_ = 0;
};

}  // namespace canopus::sim::lift
