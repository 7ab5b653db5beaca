#include "canopus/canopen/cob_id.hpp"

namespace canopus::canopen {

bool is_restricted_identifier(std::uint32_t id) noexcept {
  return id <= 0x07F ||                   // NMT, and reserved
         (id >= 0x101 && id <= 0x180) ||  // reserved
         (id >= 0x581 && id <= 0x5FF) ||  // default SDO, server to client
         (id >= 0x601 && id <= 0x67F) ||  // default SDO, client to server
         (id >= 0x6E0 && id <= 0x6FF) ||  // reserved
         (id >= 0x701 && id <= 0x7FF);    // error control, reserved
}

AbortCode check_identifier(CobId value, bool in_use, bool extended_allowed) noexcept {
  if (value.is_extended()) return extended_allowed ? AbortCode::none : AbortCode::invalid_value;
  if ((value.raw & 0x1FFF'F800) != 0) return AbortCode::invalid_value;
  if (in_use && is_restricted_identifier(value.identifier())) return AbortCode::invalid_value;
  return AbortCode::none;
}

AbortCode check_change(CobId old_value, CobId new_value, bool extended_allowed) noexcept {
  constexpr std::uint32_t identity = 0x3FFF'FFFF;
  if (old_value.is_valid() && new_value.is_valid() && ((old_value.raw ^ new_value.raw) & identity) != 0) {
    return AbortCode::invalid_value;
  }
  return check_identifier(new_value, new_value.is_valid(), extended_allowed);
}

}  // namespace canopus::canopen
