#pragma once
// The PDOs of a node as its device file has them: communication and mapping parameters [CiA 301 7.5.2.35-38].

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/eds/device_file.hpp"

namespace canopus::network_project {

struct MappedObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bits = 0;
  friend bool operator==(const MappedObject&, const MappedObject&) = default;

  /// A data type, which leaves bits of an RPDO unused.
  [[nodiscard]] bool is_dummy() const noexcept { return index < 0x1000; }
  /// The value of a mapping parameter.
  [[nodiscard]] std::uint32_t value() const noexcept {
    return std::uint32_t{index} << 16 | std::uint32_t{sub} << 8 | bits;
  }
};

struct Pdo {
  bool transmit = false;
  unsigned number = 0;  ///< from 1 to 512
  canopen::CobId cob_id{};
  std::uint8_t transmission_type = 0;
  std::optional<std::uint16_t> inhibit_time{};  ///< 100 us; nothing: the device has none
  std::optional<std::uint16_t> event_timer{};   ///< ms; nothing: the device has none
  std::vector<MappedObject> mapping{};
  bool can_change_cob_id = false;
  bool can_change_mapping = false;
  unsigned most_objects = 0;  ///< that its mapping has sub-indexes for

  /// 1400H or 1800H on.
  [[nodiscard]] std::uint16_t communication_index() const noexcept {
    return static_cast<std::uint16_t>((transmit ? 0x1800U : 0x1400U) + number - 1);
  }
  /// 1600H or 1A00H on.
  [[nodiscard]] std::uint16_t mapping_index() const noexcept {
    return static_cast<std::uint16_t>(communication_index() + 0x200U);
  }
  [[nodiscard]] unsigned bits() const noexcept;
  /// Length of the frame in bytes.
  [[nodiscard]] unsigned length() const noexcept { return (bits() + 7) / 8; }
  /// It is sent or taken: valid, with a CAN-ID that it may have, and something mapped.
  [[nodiscard]] bool is_active() const noexcept {
    return canopen::usable(cob_id).is_valid() && !mapping.empty();
  }
  /// "TPDO3"
  [[nodiscard]] std::string name() const;
};

/// All that have a communication parameter, RPDOs first.
[[nodiscard]] std::vector<Pdo> read_pdos(const eds::DeviceFile& file, std::uint8_t node_id);

/// "6000:01, 6000:02"
[[nodiscard]] std::string describe_mapping(const Pdo& pdo);
/// "183H", "0000183H" of 29 bits.
[[nodiscard]] std::string describe_can_id(canopen::CobId cob_id);
/// "synchronous, every 4th SYNC", "event-driven, of the manufacturer" ...
[[nodiscard]] std::string describe_transmission_type(std::uint8_t type, bool transmit);

}  // namespace canopus::network_project
