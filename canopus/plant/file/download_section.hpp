#pragma once
// The download of CANopen Builder for a function card: [plc.module.download] [AS-FCOPM 10.6].

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/object_value.hpp"

namespace canopus::plant {

struct DownloadSection {
  text::Place place{};
  bool is_slave = false;                            ///< work_mode = "slave"
  std::optional<std::uint8_t> wrong_node_id{};      ///< node_id: 0, or 128 to 255
  std::optional<can::Duration> again_at{};          ///< when the same is downloaded once more
  std::optional<std::uint16_t> cycle_period{};      ///< ms
  std::optional<std::uint16_t> master_heartbeat{};  ///< ms
  struct Object {
    text::Place place{};
    text::ObjectName object{};
  };
  struct Pdo {
    text::Place place{};
    std::uint16_t number = 1;
    std::uint8_t type = 255;
    std::optional<std::uint16_t> cob_id{};
    std::optional<std::uint16_t> inhibit_time{};  ///< 100 us
    std::optional<std::uint16_t> event_timer{};   ///< ms
    std::vector<Object> objects{};
  };
  /// A slave of the node list: [[plc.module.download.slave]].
  struct Slave {
    text::Place place{};
    text::Place eds_place{};
    std::uint8_t node = 0;
    std::string eds{};  ///< of a node outside of the plant, or of what is expected there
    std::optional<std::uint16_t> heartbeat{};           ///< ms
    std::optional<std::uint16_t> heartbeat_time_out{};  ///< ms
    std::vector<Pdo> rx_pdos{};
    std::vector<Pdo> tx_pdos{};
    std::vector<text::ObjectSetting> auto_sdos{};
  };
  std::vector<Slave> slaves{};
};

}  // namespace canopus::plant
