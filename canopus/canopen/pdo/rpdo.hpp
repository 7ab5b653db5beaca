#pragma once
// Receive PDOs [CiA 301 7.2.2]. 14xxH: 01H COB-ID (bit 31: not valid), 02H transmission type, 05H event timer
// in ms; 16xxH: the mapping. In Operational a frame of at least the mapped length is put into the dictionary:
// at once with types FEH and FFH, at the next SYNC with 00H-F0H. A shorter one is dropped (EMCY 8210H), a
// longer one is taken as far as mapped (EMCY 8220H). The event timer watches for the next frame from the
// first one on; its end is EMCY 8250H and NodeListener::rpdo_timed_out().
//
// Checks: COB-ID rules; reserved transmission types 06090030H; changing the mapping: check_mapping_write().

#include <bit>
#include <vector>

#include "canopus/canopen/pdo/mpdo.hpp"
#include "canopus/canopen/pdo/pdo_mapping.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"
#include "canopus/canopen/service/node_listener.hpp"

namespace canopus::canopen {

class Rpdos final : public ObjectHandler {
 public:
  /// Only the RPDOs that the dictionary has exist.
  explicit Rpdos(NodeContext& node);

  /// Reads the parameters. `defaults_of`: they are the defaults for this node-ID; 0: they may be others. What was read of
  /// the same defaults before is kept.
  void start(std::uint8_t defaults_of);
  void stop();
  /// Operational was left: forgets what waits for SYNC and stops watching.
  void leave_operational();
  /// A frame of the RPDO at this position came.
  void receive(std::uint16_t position, const can::Frame& frame, can::Time window_end, can::Time now) {
    if (!node_.is_operational()) return;
    Rpdo& pdo = rpdos_[position];
    if (frame.dlc != pdo.plan.length() || pdo.path == Path::checked) {
      return receive_other(pdo, frame, window_end, now);
    }
    if (pdo.path == Path::wait) return wait_for_sync(pdo, frame, window_end, now);
    pdo.plan.scatter_single(std::bit_cast<std::uint64_t>(frame.data), node_.dictionary.block().data());
    if (node_.listener != nullptr) node_.listener->rpdo_received(pdo.number, now);
  }
  void sync(can::Time now);
  void tick(std::uint16_t position, can::Time now);
  void list_identifiers(std::vector<IdentifierTable::Route>& routes) const;
  [[nodiscard]] std::size_t size() const noexcept { return rpdos_.size(); }
  [[nodiscard]] TimerQueue::Number first_timer() const noexcept { return first_timer_; }

  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time) override;

 private:
  /// What a frame of the mapped length costs.
  enum class Path : std::uint8_t {
    checked,
    copy,  // one copy, at once: nothing waits, is watched or was wrong
    wait,  // the same, but it waits for SYNC
  };
  struct Rpdo {
    std::uint64_t waiting_data = 0;  // for the next SYNC
    CopyPlan plan;
    CobId cob_id;
    std::uint16_t number = 0;
    std::uint16_t event_timer = 0;  // ms
    std::uint8_t transmission_type = 0xFF;
    std::uint8_t addressing = 0;   // of an MPDO, else 0
    std::uint8_t error_count = 0;  // EMCYs that wait for their end: length, deadline
    bool watched = false;          // has an event timer, or is an MPDO
    Path path = Path::checked;
    bool is_waiting = false;
    bool length_error = false;
    bool timed_out = false;
  };
  void apply(Rpdo& pdo, const can::Frame& frame, can::Time window_end, can::Time now);
  void receive_other(Rpdo& pdo, const can::Frame& frame, can::Time window_end, can::Time now);
  void receive_unusual(Rpdo& pdo, const can::Frame& frame, can::Time window_end, can::Time now);
  void read(Rpdo& pdo);
  [[nodiscard]] CobId read_cob_id(const Rpdo& pdo) const noexcept;
  [[nodiscard]] CommunicationError time_out_of(const Rpdo& pdo) const noexcept;
  static void classify(Rpdo& pdo) noexcept {
    const bool is_usual = !pdo.watched && pdo.error_count == 0;
    const bool waits = pdo.transmission_type <= 240;
    pdo.path = is_usual && waits ? Path::wait : is_usual && pdo.plan.is_single() ? Path::copy : Path::checked;
  }
  void wait_for_sync(Rpdo& pdo, const can::Frame& frame, can::Time window_end, can::Time now) {
    if (now > window_end) return;
    pdo.waiting_data = std::bit_cast<std::uint64_t>(frame.data);
    pdo.is_waiting = true;
    any_waiting_ = true;
  }
  void forget_errors(Rpdo& pdo, can::Time now);
  [[nodiscard]] Rpdo* find(std::uint16_t index) noexcept;
  [[nodiscard]] TimerQueue::Number timer(const Rpdo& pdo) const noexcept {
    return static_cast<TimerQueue::Number>(first_timer_ + (&pdo - rpdos_.data()));
  }

  NodeContext& node_;
  MpdoConsumer mpdo_consumer_{node_};
  std::vector<Rpdo> rpdos_;  // in order of number
  TimerQueue::Number first_timer_ = 0;
  bool any_waiting_ = false;
  std::uint8_t defaults_of_ = 0;  // all was read of the defaults for this node-ID; 0: of others
};

}  // namespace canopus::canopen
