#pragma once
// What a configuration tool downloads to a PLC for its communication module, where that is a node list: the module's own
// parameters, and what is to be written to each slave.

#include <cstdint>
#include <optional>
#include <vector>

namespace canopus::module {

/// An object of a slave that a PDO carries.
struct DownloadedObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bits = 16;  ///< 8, 16, 32 or 64
};

/// A PDO of a slave, in the slave's view: an RxPDO goes from the master to it.
struct DownloadedPdo {
  std::uint16_t number = 1;  ///< 1..512
  /// 11 bits; none: that of the predefined connection set, for PDO 1 to 4.
  std::optional<std::uint16_t> cob_id{};
  std::uint8_t type = 255;                      ///< 0..240, 254, 255
  std::optional<std::uint16_t> inhibit_time{};  ///< 100 us, of a TxPDO; none: not written
  std::optional<std::uint16_t> event_timer{};   ///< ms, of a TxPDO; none: not written
  std::vector<DownloadedObject> objects{};      ///< 1 to 8 bytes in all
  bool writes_mapping = true;                   ///< false: the slave's mapping is fixed

  [[nodiscard]] constexpr unsigned bytes() const noexcept {
    unsigned bits = 0;
    for (const DownloadedObject& object : objects) bits += object.bits;
    return (bits + 7) / 8;
  }
};

/// An SDO that the master writes before it starts the slave.
struct DownloadedSdo {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::vector<std::uint8_t> value{};
};

/// A slave of the node list.
struct DownloadedSlave {
  std::uint8_t node_id = 0;
  // What it must be; none: not checked.
  std::optional<std::uint32_t> device_type{};
  std::optional<std::uint32_t> vendor{};
  std::optional<std::uint32_t> product{};
  std::optional<std::uint32_t> revision{};
  /// Error control: the slave's heartbeat, ms, and after how long without one it is lost. 0: there is none.
  std::uint16_t heartbeat = 0;
  std::uint16_t heartbeat_time_out = 0;
  std::vector<DownloadedPdo> rx_pdos{};
  std::vector<DownloadedPdo> tx_pdos{};
  std::vector<DownloadedSdo> auto_sdos{};
};

struct Download {
  enum class WorkMode : std::uint8_t { master, slave };
  WorkMode work_mode = WorkMode::master;
  unsigned node_id = 1;                   ///< 1..127; another one is a setting error of the module
  std::uint16_t bit_rate = 1000;          ///< kbit/s
  std::uint16_t cycle_period = 50;        ///< between two SYNC messages, ms; 0: none
  std::uint16_t master_heartbeat = 200;   ///< ms; 0: none
  std::vector<DownloadedSlave> slaves{};  ///< the node list, in its order
};

}  // namespace canopus::module
