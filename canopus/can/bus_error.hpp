#pragma once
// Errors on a bus, and where in a frame they were found [ISO 11898-1].

#include <cstdint>
#include <string_view>

#include "canopus/can/controller.hpp"

namespace canopus::can {

class Port;

/// What a controller found wrong [ISO 11898-1 error detection].
enum class BusError : std::uint8_t { none, bit, stuff, crc, form, acknowledgement };

/// Which part of a frame, or of what follows it, a bit belongs to. A stuff bit belongs to the part of the bit before
/// it.
enum class FrameField : std::uint8_t {
  idle,  ///< nothing: bus idle, integrating, bus-off
  start_of_frame,
  identifier_28_21,  ///< the first eight bits of the base identifier
  identifier_20_18,  ///< its other three
  rtr,               ///< RTR of a base frame, SRR of an extended one: IDE tells which
  ide,
  identifier_17_13,
  identifier_12_5,
  identifier_4_0,
  extended_rtr,
  r1,
  r0,
  dlc,
  data,
  crc,
  crc_delimiter,
  ack_slot,
  ack_delimiter,
  end_of_frame,
  intermission,
  suspend,
  active_error_flag,
  passive_error_flag,
  overload_flag,
  superposition,  ///< dominant bits after a flag: the flags of others
  error_delimiter,
  overload_delimiter,
};
inline constexpr unsigned frame_fields = static_cast<unsigned>(FrameField::overload_delimiter) + 1;

/// "stuff", "acknowledgement"
[[nodiscard]] std::string_view name(BusError error) noexcept;
/// "data", "CRC delimiter", "ID.28-21"
[[nodiscard]] std::string_view name(FrameField field) noexcept;
/// "error active", "error passive", "bus-off"
[[nodiscard]] std::string_view name(ErrorState state) noexcept;
/// The field of that name; idle and everything unknown: none.
[[nodiscard]] bool field_of(std::string_view name, FrameField& field) noexcept;

/// An error as one controller found it at the sample point of a bit.
struct BusErrorReport {
  const Port* port = nullptr;
  BusError error = BusError::none;
  FrameField field = FrameField::idle;
  unsigned bit = 0;          ///< from SOF = 0, stuff bits counted; after the frame: within the field
  bool transmitter = false;  ///< it was sending the frame
  bool dominant = false;     ///< the level it saw
  bool first = false;        ///< of this moment; an error frame of the bus begins here
  ErrorState state = ErrorState::error_active;  ///< with this error counted
  std::uint16_t transmit_errors = 0;            ///< TEC, likewise
  std::uint16_t receive_errors = 0;             ///< REC, likewise

  friend bool operator==(const BusErrorReport&, const BusErrorReport&) = default;
};

/// A controller came to another error state, or over or below the warning limit (96).
struct ControllerReport {
  const Port* port = nullptr;
  ErrorState before = ErrorState::error_active;
  ErrorState state = ErrorState::error_active;
  bool warning = false;  ///< TEC or REC is 96 or more
  std::uint16_t transmit_errors = 0;
  std::uint16_t receive_errors = 0;
};

}  // namespace canopus::can
