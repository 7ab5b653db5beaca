#include "canopus/link/can_error.hpp"

#include <linux/can/error.h>

namespace canopus::link {

static_assert(error_class_acknowledgement == CAN_ERR_ACK);

std::string_view describe_error_frame(std::uint32_t error_class,
                                      std::span<const std::uint8_t> data) noexcept {
  const auto byte = [data](std::size_t number) { return number < data.size() ? data[number] : 0U; };
  const bool in_acknowledgement_slot =
      (error_class & CAN_ERR_PROT) != 0 && byte(3) == static_cast<unsigned>(CAN_ERR_PROT_LOC_ACK);
  if ((error_class & CAN_ERR_ACK) != 0 || in_acknowledgement_slot)
    return "nobody acknowledges: no other node on this bus";
  if ((error_class & CAN_ERR_BUSOFF) != 0) return "the controller of this machine is bus-off";
  // What a lone controller comes to, where its driver does not report single errors.
  if ((error_class & CAN_ERR_CRTL) != 0 && (byte(1) & CAN_ERR_CRTL_TX_PASSIVE) != 0)
    return "the controller of this machine is error passive: nobody acknowledges its frames (no other node "
           "on "
           "this bus), or others destroy them";
  return {};
}

}  // namespace canopus::link
