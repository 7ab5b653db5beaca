#pragma once
// COB-ID entries (1005H, 1012H, 1014H, 1028H, 12xxH, 14xxH, 18xxH): an identifier and flags in 32 bits, and
// the rules for changing one that they all share [CiA 301].

#include <cstddef>
#include <cstdint>
#include <span>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"

namespace canopus::canopen {

struct CobId {
  static constexpr std::uint32_t invalid_bit = 1U << 31;   ///< PDO, SDO, EMCY: does not exist; TIME: consumes
  static constexpr std::uint32_t bit_30 = 1U << 30;        ///< TPDO: no RTR; SYNC, TIME: produces
  static constexpr std::uint32_t extended_bit = 1U << 29;  ///< 29-bit identifier

  std::uint32_t raw = invalid_bit;

  /// From a value as an SDO carries it, whatever its length.
  [[nodiscard]] static CobId from(std::span<const std::uint8_t> value) noexcept {
    return {can::load_u32(value)};
  }
  [[nodiscard]] constexpr bool is_valid() const noexcept { return (raw & invalid_bit) == 0; }
  [[nodiscard]] constexpr bool has_bit_30() const noexcept { return (raw & bit_30) != 0; }
  [[nodiscard]] constexpr bool is_extended() const noexcept { return (raw & extended_bit) != 0; }
  [[nodiscard]] constexpr std::uint32_t identifier() const noexcept {
    return raw & (is_extended() ? 0x1FFF'FFFFU : 0x7FFU);
  }
  /// Identifier, bit 29 = extended: what frame_of() and IdentifierTable take.
  [[nodiscard]] constexpr std::uint32_t key() const noexcept { return identifier() | (raw & extended_bit); }
};

/// Identifiers that no configurable COB-ID may have: NMT, error control, default SDO and the reserved ranges
/// [CiA 301 7.3.5].
[[nodiscard]] bool is_restricted_identifier(std::uint32_t base_identifier) noexcept;

/// Its identifier is a base identifier and a restricted one.
[[nodiscard]] bool is_restricted(CobId value) noexcept;

/// For `permitted` below: none.
inline constexpr std::uint32_t no_identifier = 0xFFFF'FFFF;

/// An entry with a "valid" bit 31 as its service uses it: not valid when its identifier is a restricted one, but for
/// `permitted`, whatever brought that into the dictionary (a device file, a stored value).
[[nodiscard]] CobId usable(CobId value, std::uint32_t permitted = no_identifier) noexcept;

/// The service that an entry's COB-ID is for. The default SDO server (1200H) has none that could be another.
enum class CobIdUse : std::uint8_t {
  none,
  sync,
  time,
  emcy,
  emcy_consumer,
  sdo_server,
  sdo_client,
  rpdo,
  tpdo
};
[[nodiscard]] CobIdUse cob_id_use(std::uint16_t index, std::uint8_t sub) noexcept;
/// The service would use the COB-ID, if CiA 301 did not restrict its identifier. An SDO client may use the
/// default channel of a server.
[[nodiscard]] bool is_refused(CobIdUse use, CobId value) noexcept;

/// The identifier part of a new value: bits 11-28 must be 0 in a base identifier; a base identifier in use
/// must not be a restricted one, but for `permitted`. 06090030H if it is not so.
[[nodiscard]] AbortCode check_identifier(CobId value, bool in_use, bool extended_allowed,
                                         std::uint32_t permitted = no_identifier) noexcept;

/// An entry with a "valid" bit 31: check_identifier(), and bits 0-29 stay as they are while it is valid (and
/// usable()) and stays so.
[[nodiscard]] AbortCode check_change(CobId old_value, CobId new_value, bool extended_allowed,
                                     std::uint32_t permitted = no_identifier) noexcept;

}  // namespace canopus::canopen
