#pragma once
// Errors of a bus as SocketCAN error frames: what a CAN interface of Linux reports of its controller
// [Linux include/uapi/linux/can/error.h].
//
//   identifier  class: CAN_ERR_PROT, CAN_ERR_BUSERROR, CAN_ERR_ACK; CAN_ERR_CRTL, CAN_ERR_BUSOFF, CAN_ERR_RESTARTED;
//               always CAN_ERR_CNT. CAN_ERR_FLAG is left to the writer of the frame.
//   data[1]     state of the controller
//   data[2]     kind of the error, with CAN_ERR_PROT_TX for the sender
//   data[3]     place in the frame
//   data[6..7]  TEC and REC, at most 255

#include <cstdint>
#include <span>

#include "canopus/can/bus_error.hpp"
#include "canopus/can/frame.hpp"

namespace canopus::can {

/// The error frame for what one controller saw.
[[nodiscard]] Frame error_frame(const BusErrorReport& report) noexcept;
/// The error frame for another state of a controller.
[[nodiscard]] Frame error_frame(const ControllerReport& report) noexcept;
/// Whose view a recording takes of errors that several found at one moment: the transmitter's, or the first one's.
[[nodiscard]] const BusErrorReport& recorded_of(std::span<const BusErrorReport> reports) noexcept;

}  // namespace canopus::can
