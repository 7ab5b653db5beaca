#pragma once
// The bus side of a gateway [CiA 309-1]: SDO transfers of its clients, one at a time with each node, NMT commands, the
// supervision of nodes, its own heartbeat, and PDOs as words of a client. What happens on the bus is told to everybody
// who listens, as lines of CiA 309-3.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/client/gateway/gateway_value.hpp"

namespace canopus::client {

/// Codes of answers and events that are no SDO abort codes [CiA 309-3].
enum class GatewayError : std::uint16_t {
  none = 0,
  not_supported = 100,
  syntax = 101,
  state = 102,
  time_out = 103,
  no_network = 104,
  no_node = 105,
  unsupported_network = 106,
  unsupported_node = 107,
  guarding_lost = 200,
  heartbeat_started = 202,
  heartbeat_lost = 203,
  error_passive = 300,
  bus_off = 301,
  pdo_length = 401,
};
[[nodiscard]] std::string_view describe(GatewayError error) noexcept;

class GatewayListener {
 public:
  /// "1 5 EMCY 8130 11 0 0 0 0 0"; a boot-up is wanted by those who asked for it.
  virtual void gateway_event(std::string_view line, bool boot_up) = 0;

 protected:
  ~GatewayListener() = default;
};

/// A PDO of the gateway. Received ones are RPDOs, sent ones TPDOs.
struct GatewayPdo {
  std::uint32_t cob_id = 0;  ///< 11 bits
  unsigned sync = 0;         ///< 0: at once, when it comes or is written; n: with the n-th SYNC
  std::vector<GatewayType> types{};
  std::optional<std::vector<std::uint64_t>> values{};  ///< the last ones
  bool waits = false;                                  ///< for a SYNC
  unsigned syncs = 0;                                  ///< since it waits
};

class Gateway final : public can::Participant {
 public:
  static constexpr unsigned network = 1;  ///< the only one
  static constexpr std::size_t most_pdos = 512;

  /// `node_id`: the gateway's own, 0: it has none, and sends no heartbeat. `version` is the program's: "1.2".
  Gateway(can::Sink& bus, std::uint8_t node_id, std::string version);
  ~Gateway() override;

  void add(GatewayListener& listener) { listeners_.push_back(&listener); }
  void remove(GatewayListener& listener) { std::erase(listeners_, &listener); }

  // SDO. Transfers with one node wait for each other.
  using Done =
      std::function<void(canopen::AbortCode code, std::span<const std::uint8_t> bytes, can::Time now)>;
  struct Transfer {
    std::uint8_t node = 0;  ///< 1..127
    std::uint16_t index = 0;
    std::uint8_t sub = 0;
    std::optional<std::vector<std::uint8_t>> value{};  ///< none: read
    bool block = false;
    can::Duration time_out{};
    Done done{};
  };
  using Ticket = std::uint64_t;
  Ticket transfer(Transfer transfer, can::Time now);
  /// Its client is gone, or its time is over; `done` is not called.
  void call_off(Ticket ticket, can::Time now);

  /// 0: all nodes. False: the bus takes no frame.
  bool command(canopen::NmtCommand command, std::uint8_t node);
  /// Zero: off.
  void watch_heartbeat(std::uint8_t node, can::Duration time, can::Time now);
  void watch_guarding(std::uint8_t node, can::Duration time, unsigned factor, can::Time now);
  /// Zero: off.
  void set_heartbeat(can::Duration period, can::Time now);
  void set_node_id(std::uint8_t node_id) { node_id_ = node_id; }
  [[nodiscard]] std::uint8_t node_id() const noexcept { return node_id_; }
  [[nodiscard]] const std::string& version() const noexcept { return version_; }

  // PDOs by their number, 1..512.
  GatewayError set_rpdo(unsigned number, GatewayPdo pdo) { return set(rpdos_, number, std::move(pdo)); }
  GatewayError set_tpdo(unsigned number, GatewayPdo pdo) { return set(tpdos_, number, std::move(pdo)); }
  [[nodiscard]] const GatewayPdo* rpdo(unsigned number) const;
  GatewayError write_pdo(unsigned number, std::span<const std::uint64_t> values);
  /// The controller's state, where the transport tells it.
  void controller_error(GatewayError error);

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override;

 private:
  using Pdos = std::map<unsigned, GatewayPdo>;
  struct Channel;
  struct Watch {
    can::Duration time{};
    unsigned factor = 0;  // of guarding; 0: heartbeat
    bool alive = false;
    bool lost = false;
    can::Time heard{};
    can::Time deadline = can::never;
    std::uint8_t state = 0xFF;
  };

  static GatewayError set(Pdos& pdos, unsigned number, GatewayPdo pdo);
  void event(std::string_view line, bool boot_up = false);
  void node_event(unsigned node, GatewayError error);
  void error_control(unsigned node, const can::Frame& frame, can::Time now);
  void watched(unsigned node, std::uint8_t state, can::Time now);
  void look_at(unsigned node, can::Time now);
  void take_pdo(const can::Frame& frame);
  void sync();
  void show_rpdo(unsigned number, const GatewayPdo& pdo);
  bool send_tpdo(const GatewayPdo& pdo);

  can::Sink& bus_;
  std::uint8_t node_id_;
  std::string version_;
  std::vector<GatewayListener*> listeners_;
  std::array<std::unique_ptr<Channel>, 128> channels_;
  std::map<unsigned, Watch> watches_;
  Pdos rpdos_;
  Pdos tpdos_;
  can::Duration heartbeat_{};
  can::Time next_heartbeat_ = can::never;
  Ticket last_ticket_ = 0;
};

/// "1 pdo 2 2 0x12 0x3456" without the network; the number only of events.
[[nodiscard]] std::string show_pdo_values(const GatewayPdo& pdo);

}  // namespace canopus::client
