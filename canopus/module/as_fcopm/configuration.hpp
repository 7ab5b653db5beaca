#pragma once
// What CANopen Builder downloads to the AS300 for the card: the card's own parameters and the node list, with what is to
// be written to each slave [AS-FCOPM 10.6]. Where the slaves' process data lie follows from it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/module/interface/module.hpp"

namespace canopus::module::as_fcopm {

inline constexpr unsigned most_slaves = 64;           ///< nodes 1 to 64 [10.1.2, 10.5.1]
inline constexpr unsigned most_pdos = 256;            ///< each way, of all slaves [10.1.1]
inline constexpr unsigned most_process_bytes = 1894;  ///< each way [10.1.1]
inline constexpr unsigned most_auto_sdos = 20;        ///< per slave [10.1.1]

enum class WorkMode : std::uint8_t { master, slave };

/// An object of a slave that a PDO carries.
struct MappedObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bits = 16;  ///< 8, 16, 32 or 64
};

/// A PDO of a slave, in the slave's view: an RxPDO goes from the master to it.
struct SlavePdo {
  std::uint16_t number = 1;  ///< 1..512
  /// 11 bits; none: that of the predefined connection set, for PDO 1 to 4.
  std::optional<std::uint16_t> cob_id{};
  std::uint8_t type = 255;                      ///< 0..240, 254, 255
  std::optional<std::uint16_t> inhibit_time{};  ///< 100 us, of a TxPDO; none: not written
  std::optional<std::uint16_t> event_timer{};   ///< ms, of a TxPDO; none: not written
  std::vector<MappedObject> objects{};          ///< 1 to 8 bytes in all
  bool writes_mapping = true;                   ///< false: the slave's mapping is fixed

  [[nodiscard]] unsigned bytes() const noexcept;
};

/// An SDO that the master writes before it starts the slave.
struct AutoSdo {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::vector<std::uint8_t> value{};
};

/// A slave of the node list.
struct SlaveSetting {
  std::uint8_t node_id = 0;
  // What it must be; none: not checked.
  std::optional<std::uint32_t> device_type{};
  std::optional<std::uint32_t> vendor{};
  std::optional<std::uint32_t> product{};
  std::optional<std::uint32_t> revision{};
  /// Error control: the slave's heartbeat, ms, and after how long without one it is lost. 0: there is none.
  std::uint16_t heartbeat = 0;
  std::uint16_t heartbeat_time_out = 0;
  std::vector<SlavePdo> rx_pdos{};
  std::vector<SlavePdo> tx_pdos{};
  std::vector<AutoSdo> auto_sdos{};
};

struct Configuration {
  WorkMode work_mode = WorkMode::master;
  unsigned node_id = 1;                  ///< 1..127
  std::uint16_t bit_rate = 1000;         ///< kbit/s
  std::uint16_t cycle_period = 50;       ///< between two SYNC messages, ms; 0: none
  std::uint16_t master_heartbeat = 200;  ///< ms; 0: none
  std::vector<SlaveSetting> slaves{};    ///< the node list, in its order
};

/// Everything that CANopen Builder would not download, one sentence each. None: the configuration is good.
[[nodiscard]] std::vector<std::string> check(const Configuration& configuration);

/// A slave's PDO and its bytes in the registers. Each PDO begins with a register.
struct PdoPlace {
  std::uint8_t node_id = 0;
  const SlavePdo* pdo = nullptr;
  std::size_t first_word = 0;  ///< from D24032, or D25032, on
  unsigned bytes = 0;
  std::uint16_t cob_id = 0;
};
/// In the order of the node list; a configuration that check() finds good.
struct Layout {
  std::vector<PdoPlace> received{};  ///< TxPDOs
  std::vector<PdoPlace> sent{};      ///< RxPDOs
};
[[nodiscard]] Layout lay_out(const Configuration& configuration);

/// What is written to a slave before it is started, as a concise DCF: its PDOs, its heartbeat, the auto SDOs.
[[nodiscard]] std::vector<std::uint8_t> concise_dcf(const SlaveSetting& slave);

/// What a failed write of that file means for the slave's code.
enum class WrittenFor : std::uint8_t { pdo_parameter, error_control, auto_sdo };
[[nodiscard]] WrittenFor written_for(const SlaveSetting& slave, std::uint16_t index, std::uint8_t sub);

}  // namespace canopus::module::as_fcopm
