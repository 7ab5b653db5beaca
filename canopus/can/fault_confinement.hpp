#pragma once
// The error counters of one controller and the state they put it in [ISO 11898-1 fault confinement]. The
// letters are those of the standard's rules a to h.

#include <algorithm>
#include <cstdint>

#include "canopus/can/controller.hpp"

namespace canopus::can {

inline constexpr std::uint16_t error_warning_limit = 96;
inline constexpr std::uint16_t error_passive_limit = 128;
inline constexpr std::uint16_t bus_off_limit = 256;

class FaultConfinement {
 public:
  [[nodiscard]] std::uint16_t transmit_errors() const noexcept { return transmit_; }  ///< TEC 0..256
  [[nodiscard]] std::uint16_t receive_errors() const noexcept { return receive_; }    ///< REC 0..255
  [[nodiscard]] ErrorState state() const noexcept {
    if (transmit_ >= bus_off_limit) return ErrorState::bus_off;
    return transmit_ >= error_passive_limit || receive_ >= error_passive_limit ? ErrorState::error_passive
                                                                               : ErrorState::error_active;
  }
  [[nodiscard]] bool warning() const noexcept {
    return transmit_ >= error_warning_limit || receive_ >= error_warning_limit;
  }
  /// Both counters are 0: success changes nothing.
  [[nodiscard]] bool clean() const noexcept { return transmit_ == 0 && receive_ == 0; }

  void receiver_error() noexcept { add_receive(1); }         ///< rule a
  void receiver_severe_error() noexcept { add_receive(8); }  ///< rules b, e, f
  void transmitter_error() noexcept {                        ///< rules c, d, f
    transmit_ = std::min<std::uint16_t>(static_cast<std::uint16_t>(transmit_ + 8), bus_off_limit);
  }
  void transmitted() noexcept {  ///< rule g
    if (transmit_ > 0) --transmit_;
  }
  /// Rule h. Above 127 the standard allows 119 to 127: this is 127, the smallest step.
  void received() noexcept {
    if (receive_ > 0)
      receive_ = receive_ >= error_passive_limit ? 127 : static_cast<std::uint16_t>(receive_ - 1);
  }
  void reset() noexcept { transmit_ = receive_ = 0; }

  friend bool operator==(const FaultConfinement&, const FaultConfinement&) = default;

 private:
  void add_receive(std::uint16_t count) noexcept {
    receive_ = std::min<std::uint16_t>(static_cast<std::uint16_t>(receive_ + count), 255);
  }

  std::uint16_t transmit_ = 0;
  std::uint16_t receive_ = 0;
};

}  // namespace canopus::can
