#include "canopus/can/error_frame.hpp"

#include <algorithm>
#include <array>

#include "canopus/can/fault_confinement.hpp"

namespace canopus::can {
namespace {

// linux/can/error.h; written out because this room uses the standard library alone. tests/link compares them.
constexpr std::uint32_t class_controller = 0x04;
constexpr std::uint32_t class_protocol = 0x08;
constexpr std::uint32_t class_acknowledgement = 0x20;
constexpr std::uint32_t class_bus_off = 0x40;
constexpr std::uint32_t class_bus_error = 0x80;
constexpr std::uint32_t class_restarted = 0x100;
constexpr std::uint32_t class_counters = 0x200;

constexpr std::uint8_t receive_warning = 0x04;
constexpr std::uint8_t transmit_warning = 0x08;
constexpr std::uint8_t receive_passive = 0x10;
constexpr std::uint8_t transmit_passive = 0x20;
constexpr std::uint8_t active_again = 0x40;

constexpr std::uint8_t single_bit = 0x01;
constexpr std::uint8_t form_error = 0x02;
constexpr std::uint8_t stuff_error = 0x04;
constexpr std::uint8_t cannot_send_dominant = 0x08;
constexpr std::uint8_t cannot_send_recessive = 0x10;
constexpr std::uint8_t while_sending = 0x80;

constexpr std::uint8_t location_crc = 0x08;

/// CAN_ERR_PROT_LOC_*, and the codes of the SJA1000 for places of which Linux names none, as its driver passes them
/// on.
constexpr std::array<std::uint8_t, frame_fields> locations{
    0x00,  // idle
    0x03,  // SOF
    0x02,  // ID.28 to ID.21
    0x06,  // ID.20 to ID.18
    0x04,  // RTR or SRR
    0x05,  // IDE
    0x07,  // ID.17 to ID.13
    0x0F,  // ID.12 to ID.5
    0x0E,  // ID.4 to ID.0
    0x0C,  // RTR of an extended frame
    0x0D,  // r1
    0x09,  // r0
    0x0B,  // DLC
    0x0A,  // data
    0x08,  // CRC
    0x18,  // CRC delimiter
    0x19,  // ACK slot
    0x1B,  // ACK delimiter
    0x1A,  // EOF
    0x12,  // intermission
    0x00,  // suspend
    0x11,  // active error flag
    0x16,  // passive error flag
    0x1C,  // overload flag
    0x13,  // superposition: "tolerate dominant bits"
    0x17,  // error delimiter
    0x17,  // overload delimiter
};

void put_counters(Frame& frame, std::uint16_t transmit, std::uint16_t receive) noexcept {
  frame.identifier |= class_counters;
  frame.dlc = 8;
  frame.data[6] = static_cast<std::uint8_t>(std::min<std::uint16_t>(transmit, 255));
  frame.data[7] = static_cast<std::uint8_t>(std::min<std::uint16_t>(receive, 255));
}

}  // namespace

Frame error_frame(const BusErrorReport& report) noexcept {
  Frame frame{.identifier = class_protocol | class_bus_error};
  put_counters(frame, report.transmit_errors, report.receive_errors);
  frame.data[3] = locations[static_cast<std::size_t>(report.field)];
  switch (report.error) {
    case BusError::none: break;
    case BusError::bit:
      frame.data[2] = single_bit | (report.dominant ? cannot_send_recessive : cannot_send_dominant);
      break;
    case BusError::stuff: frame.data[2] = stuff_error; break;
    case BusError::form: frame.data[2] = form_error; break;
    case BusError::crc: frame.data[3] = location_crc; break;  // as Linux's drivers report it
    case BusError::acknowledgement: frame.identifier |= class_acknowledgement; break;
  }
  if (report.transmitter) frame.data[2] |= while_sending;
  return frame;
}

Frame error_frame(const ControllerReport& report) noexcept {
  Frame frame;
  put_counters(frame, report.transmit_errors, report.receive_errors);
  if (report.state == ErrorState::bus_off) {
    frame.identifier |= class_bus_off;
    return frame;
  }
  frame.identifier |= class_controller;
  if (report.before == ErrorState::bus_off) frame.identifier |= class_restarted;
  const auto flags = [&](std::uint16_t limit, std::uint8_t transmit, std::uint8_t receive) {
    return static_cast<std::uint8_t>((report.transmit_errors >= limit ? transmit : 0) |
                                     (report.receive_errors >= limit ? receive : 0));
  };
  if (report.state == ErrorState::error_passive) {
    frame.data[1] = flags(error_passive_limit, transmit_passive, receive_passive);
  } else if (report.warning) {
    frame.data[1] = flags(error_warning_limit, transmit_warning, receive_warning);
  } else {
    frame.data[1] = active_again;
  }
  return frame;
}

const BusErrorReport& recorded_of(std::span<const BusErrorReport> reports) noexcept {
  const auto sending = std::ranges::find(reports, true, &BusErrorReport::transmitter);
  return sending != reports.end() ? *sending : reports.front();
}

}  // namespace canopus::can
