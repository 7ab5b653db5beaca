#pragma once
// The bus side of a gateway [CiA 309-1]: SDO transfers of its clients, one at a time with each node, NMT
// commands, the supervision of nodes, its own heartbeat, PDOs, LSS, and the CAN controller. Events of the bus
// go to all listeners, as lines of CiA 309-3.

#include <array>
#include <cstdint>
#include <expected>
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
#include "canopus/client/gateway/gateway_error.hpp"
#include "canopus/client/gateway/gateway_lss.hpp"
#include "canopus/client/gateway/gateway_pdo.hpp"

namespace canopus::client {

class GatewayListener {
 public:
  /// "1 5 EMCY 8130 11 0 0 0 0 0"; `boot_up`: only for clients that have enabled boot-up indications.
  virtual void gateway_event(std::string_view line, bool boot_up) = 0;

 protected:
  ~GatewayListener() = default;
};

class Gateway final : public can::Participant, private GatewayPdoListener {
 public:
  static constexpr unsigned network = 1;  ///< the only one
  /// Bytes of an object that is read; one with more is given up as SdoClient::buffer_too_small.
  static constexpr std::size_t longest_value = 512 * 1024;

  /// `node_id`: the gateway's own, 0: it has none, and sends no heartbeat. `version` is the program's: "1.2".
  Gateway(can::Sink& bus, std::uint8_t node_id, std::string version);
  ~Gateway() override;

  void add(GatewayListener& listener) { listeners_.push_back(&listener); }
  void remove(GatewayListener& listener) { std::erase(listeners_, &listener); }

  // SDO. Transfers with one node wait for each other.
  struct Answer {
    canopen::AbortCode code = canopen::AbortCode::none;
    std::span<const std::uint8_t> bytes{};     ///< what was read
    bool size_indicated = true;                ///< false: all four bytes of an expedited answer
    const can::Frame* short_answer = nullptr;  ///< one of fewer than 8 bytes: the reason for `code`
  };
  using Done = std::function<void(const Answer& answer, can::Time now)>;
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

  [[nodiscard]] GatewayPdos& pdos() noexcept { return pdos_; }
  /// The values of an RPDO, asked for by a remote frame. None: the bus takes no frame, or there is no such PDO.
  std::optional<Ticket> request_pdo(unsigned number, GatewayPdos::Done done);
  Ticket lss(GatewayLss::Request request, can::Time now);

  /// Restarts the own controller at a bit rate (bit/s); the error is a sentence.
  using Restart = std::function<std::expected<void, std::string>(std::uint32_t bit_rate)>;
  void set_restart(Restart restart) { restart_ = std::move(restart); }
  std::expected<void, std::string> restart(std::uint32_t bit_rate);
  /// Resets to the state after power-on: ends all transfers, clears PDOs and supervision, stops the
  /// heartbeat, and sends its boot-up message.
  void reset(can::Time now);
  /// While devices change their bit rate nothing may be sent [CiA 305].
  void set_silent(bool silent) { bus_.silent = silent; }
  /// The controller's state, where the transport reports it.
  void controller_error(GatewayError error);

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;

 private:
  struct Channel;
  /// The bus, while sending is allowed.
  struct Way final : can::Sink {
    explicit Way(can::Sink& sink) : bus(sink) {}
    bool send(const can::Frame& frame) override { return !silent && bus.send(frame); }
    can::Sink& bus;
    bool silent = false;
  };
  struct Watch {
    can::Duration time{};
    unsigned factor = 0;  // of guarding; 0: heartbeat
    bool alive = false;
    bool asked = false;   // guarding: and not yet answered
    bool missed = false;  // an answer
    bool lost = false;
    can::Time heard{};
    can::Time deadline = can::never;
    std::uint8_t state = 0xFF;
  };

  void pdo_received(unsigned number, const GatewayPdo& pdo) override;
  void pdo_too_short() override { controller_error(GatewayError::pdo_length); }
  void event(std::string_view line, bool boot_up = false);
  void node_event(unsigned node, GatewayError error);
  void error_control(unsigned node, const can::Frame& frame, can::Time now);
  void watched(unsigned node, std::uint8_t state, can::Time now);
  void check_node(unsigned node, can::Time now);
  /// Sets next_watch_ to the earliest deadline of the watches.
  void set_watch_alarm();

  Way bus_;
  std::uint8_t node_id_;
  std::string version_;
  std::vector<GatewayListener*> listeners_;
  std::array<std::unique_ptr<Channel>, 128> channels_;
  std::map<unsigned, Watch> watches_;
  std::array<std::uint8_t, 128> commanded_{};  // state that a node was sent to; 0: none
  GatewayPdos pdos_;
  GatewayLss lss_;
  Restart restart_;
  can::Duration heartbeat_{};
  can::Alarm next_heartbeat_;
  can::Alarm next_watch_;
  Ticket last_ticket_ = 0;
};

}  // namespace canopus::client
