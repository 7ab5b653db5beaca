#include "canopus/link/controller_status.hpp"

#include <linux/can/error.h>

namespace canopus::link {

static_assert(error_class_acknowledgement == CAN_ERR_ACK);

/// CAN_ERR_CNT: bytes 6 and 7 are TEC and REC. Older headers do not have it.
constexpr std::uint32_t error_class_counters = 0x200;

std::string_view describe_error_frame(std::uint32_t error_class,
                                      std::span<const std::uint8_t> data) noexcept {
  const auto byte = [data](std::size_t number) { return number < data.size() ? data[number] : 0U; };
  const bool in_acknowledgement_slot =
      (error_class & CAN_ERR_PROT) != 0 && byte(3) == static_cast<unsigned>(CAN_ERR_PROT_LOC_ACK);
  if ((error_class & CAN_ERR_ACK) != 0 || in_acknowledgement_slot)
    return "no acknowledgement: no other node on this bus";
  if ((error_class & CAN_ERR_BUSOFF) != 0) return "the controller of this machine is bus-off";
  // The state of a controller alone on its bus, if its driver does not report single errors.
  if ((error_class & CAN_ERR_CRTL) != 0 && (byte(1) & CAN_ERR_CRTL_TX_PASSIVE) != 0)
    return "the controller of this machine is error passive: its frames are not acknowledged (no other node "
           "on "
           "this bus), or others destroy them";
  return {};
}

void update_status(ControllerStatus& status, std::uint32_t error_class,
                   std::span<const std::uint8_t> data) noexcept {
  const auto byte = [data](std::size_t number) {
    return number < data.size() ? data[number] : std::uint8_t{0};
  };
  if ((error_class & CAN_ERR_RESTARTED) != 0)
    status = {.bit_rate = status.bit_rate, .sample_point = status.sample_point};
  if ((error_class & CAN_ERR_CRTL) != 0) {
    constexpr unsigned passive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
    constexpr unsigned active = CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_ACTIVE;
    if ((byte(1) & passive) != 0) {
      status.state = can::ErrorState::error_passive;
    } else if ((byte(1) & active) != 0) {
      status.state = can::ErrorState::error_active;
    }
  }
  if ((error_class & error_class_counters) != 0 && data.size() >= 8) {
    status.transmit_errors = byte(6);
    status.receive_errors = byte(7);
    status.counters_known = true;
  }
  if ((error_class & CAN_ERR_BUSOFF) != 0) {
    status.state = can::ErrorState::bus_off;
    if (status.counters_known) status.transmit_errors = 256;
  }
}

}  // namespace canopus::link
