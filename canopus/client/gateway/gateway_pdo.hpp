#pragma once
// PDOs as words of a gateway's clients [CiA 309-1]: RPDOs, which it receives, and TPDOs, which it sends, by
// their numbers. The transmission type decides when one is sent: at once, with a SYNC, or on a remote frame.
// All clients share them.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/client/gateway/gateway_error.hpp"
#include "canopus/client/gateway/gateway_value.hpp"

namespace canopus::client {

struct GatewayPdo {
  enum class Type : std::uint8_t { event, sync, remote };

  std::uint32_t identifier = 0;
  bool extended = false;  ///< 29 bits
  Type type = Type::event;
  unsigned sync = 1;             ///< of synchronous ones: with the n-th SYNC
  std::uint8_t sync_start = 0;   ///< TPDO: counting begins at the SYNC with this counter; 0: at any
  can::Duration inhibit_time{};  ///< TPDO: from one transmission to the next
  can::Duration event_timer{};   ///< TPDO: sent again after this time; 0: not
  std::vector<GatewayType> types{};

  // What became of it since.
  std::optional<std::vector<std::uint64_t>> values{};  ///< the last ones
  bool waits = false;                                  ///< for a SYNC, or for the end of the inhibit time
  bool counting = false;                               ///< its first SYNC was there
  unsigned syncs = 0;                                  ///< since it waits
  can::Time inhibited_until{};
  can::Time next = can::never;  ///< by its event timer, or when the inhibit time is over
};

/// "2 0x12 0x3456": how many, and each.
[[nodiscard]] std::string show_pdo_values(const GatewayPdo& pdo);

class GatewayPdoListener {
 public:
  /// New values of an RPDO of type event or sync.
  virtual void pdo_received(unsigned number, const GatewayPdo& pdo) = 0;
  /// A frame was too short for an RPDO.
  virtual void pdo_too_short() = 0;

 protected:
  ~GatewayPdoListener() = default;
};

class GatewayPdos final : public can::Participant {
 public:
  static constexpr unsigned most = 512;
  using Ticket = std::uint64_t;
  using Done = std::function<void(const GatewayPdo& pdo, can::Time now)>;

  GatewayPdos(can::Sink& bus, GatewayPdoListener& user) : bus_(bus), user_(user) {}

  // By their numbers, 1..512. pdo_in_use: another PDO has this identifier.
  GatewayError set_rpdo(unsigned number, GatewayPdo pdo) { return set(rpdos_, number, std::move(pdo)); }
  GatewayError set_tpdo(unsigned number, GatewayPdo pdo) { return set(tpdos_, number, std::move(pdo)); }
  void remove_rpdo(unsigned number) { rpdos_.erase(number); }
  void remove_tpdo(unsigned number) { tpdos_.erase(number); }
  /// Removes all PDOs. Clients that wait for a PDO are not notified.
  void clear();

  [[nodiscard]] const GatewayPdo* rpdo(unsigned number) const;
  /// Asks by a remote frame; `done` is called when the PDO comes.
  GatewayError request(unsigned number, Ticket ticket, Done done);
  void call_off(Ticket ticket);
  GatewayError write(unsigned number, std::span<const std::uint64_t> values, can::Time now);

  // can::Participant
  void receive(const can::Frame& frame, can::Time now) override;
  void tick(can::Time now) override;

 private:
  using Pdos = std::map<unsigned, GatewayPdo>;
  /// Sets the alarm to the earliest deadline of the TPDOs.
  void set_alarm();
  struct Waiting {
    Ticket ticket;
    unsigned number;
    Done done;
  };

  GatewayError set(Pdos& pdos, unsigned number, GatewayPdo pdo);
  bool send(GatewayPdo& pdo, can::Time now);
  void store(unsigned number, GatewayPdo& pdo, const can::Frame& frame, can::Time now);
  void sync(const can::Frame& frame, can::Time now);

  can::Sink& bus_;
  GatewayPdoListener& user_;
  Pdos rpdos_;
  Pdos tpdos_;
  std::vector<Waiting> waiting_;
};

}  // namespace canopus::client
