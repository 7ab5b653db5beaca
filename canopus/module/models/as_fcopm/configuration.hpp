#pragma once
// What CANopen Builder downloads to the AS300 for the card: the card's own parameters and the node list, with what is to
// be written to each slave [AS-FCOPM 10.6]. Where the slaves' process data lie follows from it.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/module/interface/download.hpp"

namespace canopus::module::as_fcopm {

inline constexpr unsigned most_slaves = 64;           ///< nodes 1 to 64 [10.1.2, 10.5.1]
inline constexpr unsigned most_pdos = 256;            ///< each way, of all slaves [10.1.1]
inline constexpr unsigned most_process_bytes = 1894;  ///< each way [10.1.1]
inline constexpr unsigned most_auto_sdos = 20;        ///< per slave [10.1.1]

// As CANopen Builder calls them.
using Configuration = Download;
using WorkMode = Download::WorkMode;
using SlaveSetting = DownloadedSlave;
using SlavePdo = DownloadedPdo;
using MappedObject = DownloadedObject;
using AutoSdo = DownloadedSdo;

/// What is wrong with a configuration, one sentence each. None: it is good.
[[nodiscard]] std::vector<std::string> check(const Configuration& configuration);
/// What of it CANopen Builder would not download: all but the card's own node-ID, which the card itself finds wrong (F5H).
[[nodiscard]] std::vector<std::string> check_download(Configuration configuration);

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
