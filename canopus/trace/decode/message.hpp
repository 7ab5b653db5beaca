#pragma once
// The decoded form of a frame, or of the frames of one SDO transfer.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::trace {

/// The service a frame belongs to.
enum class Service : std::uint8_t {
  nmt,
  failsafe,  ///< global failsafe command of CiA 304, 001H
  flying_master,
  sync,
  time,
  emcy,
  pdo,
  mpdo,
  sdo,
  error_control,  ///< boot-up, heartbeat, node guarding
  lss,
  layer2,       ///< a frame that belongs to no service of CANopen
  error_frame,  ///< an error that the CAN controller of the recorder saw
};
inline constexpr unsigned service_count = 13;

/// As options and JSON write it: "nmt", "flying-master", "error-control", "layer2", ...
[[nodiscard]] std::string_view name(Service service) noexcept;
[[nodiscard]] std::optional<Service> parse_service(std::string_view name) noexcept;

/// A value that a PDO carries.
struct Signal {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t first_bit = 0;                        ///< in the frame, 0..63
  std::uint8_t bits = 0;                             ///< 1..64
  canopen::DataType type = canopen::DataType::none;  ///< none: not known
  std::string name{};                                ///< of the object; empty: not known
  std::string value{};                               ///< for people, without unit
  std::optional<double> number{};                    ///< of a numeric type
  std::string_view unit{};                           ///< of CiA 301 or 402; empty: none is known
  std::string words{};                               ///< a state, or bits, in words; empty: it has none
};

/// How an SDO transfer ended.
enum class TransferEnd : std::uint8_t {
  done,
  aborted,
  unanswered,  ///< the server never answered the request
  unfinished,  ///< it stopped in the middle, or the trace did
  overtaken,   ///< the client began another one in the middle of it
};
[[nodiscard]] std::string_view name(TransferEnd end) noexcept;

/// A frame, or a whole SDO transfer.
struct Message {
  can::Time time{};  ///< of the frame; of a transfer: of its last frame
  std::uint16_t channel = 0;
  can::Frame frame{};  ///< of a transfer: its last one
  Service service = Service::layer2;
  std::string_view kind{};  ///< what of the service: "boot-up", "download request", "TPDO"; never empty
  std::uint8_t node = 0;    ///< 0: none, or all
  std::string node_name{};  ///< empty: not known
  std::uint16_t pdo = 0;    ///< number of the PDO, from 1
  std::optional<std::uint16_t> index{};  ///< with `sub`
  std::uint8_t sub = 0;
  std::string object_name{};
  std::vector<std::uint8_t>
      data{};  ///< that the service carries for its user; of a long transfer the beginning
  std::optional<std::uint32_t> abort_code{};
  std::optional<std::uint16_t> emcy_code{};
  std::vector<Signal> signals{};
  std::string text{};    ///< for people, without time, channel, identifier, service and node
  bool is_copy = false;  ///< the recorder received its own frame and recorded it again
  /// Against its protocol: too short or too long, or a toggle bit that does not alternate. `text` says what was expected.
  bool is_malformed = false;

  // Of transfers only.
  bool is_transfer = false;
  bool is_read = false;  ///< upload, else download
  TransferEnd end = TransferEnd::done;
  std::uint64_t size = 0;  ///< bytes of the value that went over
  std::uint32_t frames = 0;
  can::Duration duration{};  ///< from the first frame to the last
};

/// "3 (encoder)", "3", "all".
[[nodiscard]] std::string node_text(const Message& message);

}  // namespace canopus::trace
