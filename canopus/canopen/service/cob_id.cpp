#include "canopus/canopen/service/cob_id.hpp"

namespace canopus::canopen {

bool is_restricted_identifier(std::uint32_t id) noexcept {
  return id <= 0x07F ||                   // NMT, and reserved
         (id >= 0x101 && id <= 0x180) ||  // reserved
         (id >= 0x581 && id <= 0x5FF) ||  // default SDO, server to client
         (id >= 0x601 && id <= 0x67F) ||  // default SDO, client to server
         (id >= 0x6E0 && id <= 0x6FF) ||  // reserved
         (id >= 0x701 && id <= 0x7FF);    // error control, reserved
}

namespace {

bool is_default_sdo_identifier(CobId id) noexcept {
  const std::uint32_t base = id.identifier() & 0x780;
  return !id.is_extended() && (id.identifier() & 0x7F) != 0 && (base == 0x580 || base == 0x600);
}

}  // namespace

bool is_restricted(CobId value) noexcept {
  return !value.is_extended() && is_restricted_identifier(value.identifier());
}

CobId usable(CobId value, std::uint32_t permitted) noexcept {
  return is_restricted(value) && value.identifier() != permitted ? CobId{value.raw | CobId::invalid_bit}
                                                                 : value;
}

CobIdUse cob_id_use(std::uint16_t index, std::uint8_t sub) noexcept {
  using enum CobIdUse;
  if (index == 0x1005) return sub == 0 ? sync : none;
  if (index == 0x1012) return sub == 0 ? time : none;
  if (index == 0x1014) return sub == 0 ? emcy : none;
  if (index == 0x1028) return sub != 0 && sub <= 127 ? emcy_consumer : none;
  if (index > 0x1200 && index <= 0x12FF)
    return sub != 1 && sub != 2 ? none : index < 0x1280 ? sdo_server : sdo_client;
  if (index >= 0x1400 && index <= 0x15FF) return sub == 1 ? rpdo : none;
  if (index >= 0x1800 && index <= 0x19FF) return sub == 1 ? tpdo : none;
  return none;
}

bool is_refused(CobIdUse use, CobId value) noexcept {
  if (use == CobIdUse::none || !is_restricted(value)) return false;
  if (use == CobIdUse::sync) return true;  // it is always listened to
  if (use == CobIdUse::time) return (value.raw & (CobId::invalid_bit | CobId::bit_30)) != 0;
  if (!value.is_valid()) return false;
  return use != CobIdUse::sdo_client || !is_default_sdo_identifier(value);
}

AbortCode check_identifier(CobId value, bool in_use, bool extended_allowed,
                           std::uint32_t permitted) noexcept {
  if (value.is_extended()) return extended_allowed ? AbortCode::none : AbortCode::invalid_value;
  if ((value.raw & 0x1FFF'F800) != 0) return AbortCode::invalid_value;
  if (in_use && is_restricted(value) && value.identifier() != permitted) return AbortCode::invalid_value;
  return AbortCode::none;
}

AbortCode check_change(CobId old_value, CobId new_value, bool extended_allowed,
                       std::uint32_t permitted) noexcept {
  constexpr std::uint32_t identity = 0x3FFF'FFFF;
  if (usable(old_value, permitted).is_valid() && new_value.is_valid() &&
      ((old_value.raw ^ new_value.raw) & identity) != 0) {
    return AbortCode::invalid_value;
  }
  return check_identifier(new_value, new_value.is_valid(), extended_allowed, permitted);
}

}  // namespace canopus::canopen
