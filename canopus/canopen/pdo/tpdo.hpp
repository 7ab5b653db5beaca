#pragma once
// Transmit PDOs [CiA 301 7.2.2]. 18xxH: 01H COB-ID (bit 31: not valid, bit 30: no RTR), 02H transmission
// type, 03H inhibit time in 100 us, 05H event timer in ms, 06H SYNC start value; 1AxxH: the mapping. In
// Operational:
//
//   00H       after the next SYNC, if an event happened before it
//   01H-F0H   after every n-th SYNC; with a counter in SYNC, counted from the SYNC of the start value on
//   FCH, FDH  asked for by a remote frame; FCH sends the values of the last SYNC
//   FEH, FFH  on an event, at most once in an inhibit time, and when the event timer ends, which starts
//             anew with each transmission. An event during the inhibit time waits for its end, or is
//             forgotten (option).
//
// A remote frame is answered in every type if bit 30 is 0. A PDO with nothing mapped is never sent. Values
// are those before the RPDOs of the same SYNC.
//
// Checks: COB-ID rules; reserved types, FCH/FDH with bit 30 set and a SYNC start value above 240 06090030H;
// inhibit time and SYNC start value cannot be changed while valid (06090030H); changing the mapping:
// check_mapping_write().

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "canopus/canopen/pdo/mpdo.hpp"
#include "canopus/canopen/pdo/pdo_mapping.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/frame_of.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class alignas(64) Tpdos final : public ObjectHandler {
 public:
  /// Only the TPDOs that the dictionary has exist.
  explicit Tpdos(NodeContext& node);

  /// Reads the parameters. `defaults_of`: they are the defaults for this node-ID; 0: they may be others. What was read of
  /// the same defaults before is kept.
  void start(std::uint8_t defaults_of, can::Time now);
  void stop();
  void enter_operational(can::Time now);
  void leave_operational();

  /// Every event-driven or acyclic TPDO whose values differ from what it last sent has its event. How many had. `places`,
  /// not 0: no others were changed since the last call, but by the node itself below 2000H.
  unsigned values_changed(ValueMask places, can::Time now);
  /// The event of TPDO `number`. False: it does not exist, is not valid or event-driven, or was dismissed.
  bool event(std::uint16_t number, can::Time now);
  /// False: object_written() would do nothing for this entry.
  [[nodiscard]] bool may_have_event_of(const Entry& entry) const noexcept {
    return entry.offset - first_watched_ < watched_bytes_;
  }
  /// A mapped value was written: its TPDOs have their events.
  void object_written(const Entry& entry, can::Time now);
  /// Sends `value` (up to 4 bytes) to an object of another node (0 = all) through the MPDO in TPDO `number`.
  /// False: that is none in destination addressing mode, it is not valid, or its inhibit time runs.
  bool send_to(std::uint16_t number, std::uint8_t node_id, std::uint16_t index, std::uint8_t sub,
               std::span<const std::uint8_t> value, can::Time now);
  /// Sends an object of the scanner list through the MPDO in source addressing mode, if there is one.
  bool send_from(std::uint16_t index, std::uint8_t sub, can::Time now);
  void sync(std::uint8_t counter, can::Time now);
  /// A remote frame came for the TPDO at this position.
  void requested(std::uint16_t position, can::Time now);
  void tick(std::uint16_t position, can::Time now);

  void list_identifiers(std::vector<IdentifierTable::Route>& routes) const;
  [[nodiscard]] std::size_t size() const noexcept { return tpdos_.size(); }
  [[nodiscard]] TimerQueue::Number first_timer() const noexcept { return first_timer_; }

  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time now) override;

 private:
  static constexpr std::uint8_t rtr_synchronous = 0xFC;  // transmission type
  // All of it lies in one cache line.
  struct alignas(64) Tpdo {
    std::uint64_t last_data = 0;  // as sent; of type FCH as sampled
    FrameHead head;
    [[no_unique_address]] CopyPlan plan;
    std::uint8_t transmission_type = 0xFF;
    std::uint16_t event_timer = 0;  // ms
    can::Time inhibited_until{};
    can::Time event_due = can::never;
    std::uint32_t inhibit_time = 0;  // us, in steps of the node's resolution
    std::uint8_t sync_start = 0;
    std::uint8_t syncs_left = 0;  // of type 01H-F0H, until the next transmission
    std::uint16_t number : 9 = 0;
    bool is_valid : 1 = false;         // no, too, when there is nothing mapped
    bool answers_requests : 1 = true;  // remote frames
    bool is_source : 1 = false;        // MPDO in source addressing mode
    bool is_destination : 1 = false;   // MPDO in destination addressing mode
    bool was_sent : 1 = false;         // last_data is what the receivers have
    bool has_event : 1 = false;        // waits for SYNC or for the end of the inhibit time
    bool waits_for_start : 1 = false;  // for the SYNC whose counter is sync_start

    [[nodiscard]] bool is_mpdo() const noexcept { return is_source || is_destination; }
    [[nodiscard]] bool is_event_driven() const noexcept { return transmission_type >= 0xFE && !is_mpdo(); }
    [[nodiscard]] bool may_have_events() const noexcept {
      return is_event_driven() || transmission_type == 0;
    }
    [[nodiscard]] bool is_synchronous() const noexcept { return transmission_type <= 0xF0; }
  };
  static_assert(sizeof(Tpdo) == 64);
  struct Valid {
    std::uint16_t position = 0;
    ValueMask places = 0;  // of what it maps
  };
  void read(Tpdo& pdo);
  [[nodiscard]] CobId cob_id_of(std::uint16_t number) const noexcept;
  /// What its frames look like, once all else is read.
  void complete(Tpdo& pdo, CobId cob_id) const noexcept;
  void activate(Tpdo& pdo, can::Time now);
  void start_timer(Tpdo& pdo, can::Time now);
  bool event(Tpdo& pdo, can::Time now) { return event_with(pdo, gather(pdo), now); }
  /// `data`: what the PDO would carry now.
  bool event_with(Tpdo& pdo, std::uint64_t data, can::Time now);
  bool send(Tpdo& pdo, std::uint64_t data, can::Time now);
  void send_on_sync(Tpdo& pdo, can::Time now);
  void sync_unusual(Tpdo& pdo, std::uint8_t counter, can::Time now);
  bool send_mpdo(Tpdo& pdo, std::uint64_t data, can::Time now);
  [[nodiscard]] std::uint64_t gather(const Tpdo& pdo) const noexcept {
    return pdo.plan.gather(node_.dictionary.block().data());
  }
  void schedule(const Tpdo& pdo);
  void list_valid();
  void add_valid(Valid valid);
  void list_watched();
  [[nodiscard]] Tpdo* find(std::uint16_t index) noexcept;
  [[nodiscard]] TimerQueue::Number timer(const Tpdo& pdo) const noexcept {
    return static_cast<TimerQueue::Number>(first_timer_ + (&pdo - tpdos_.data()));
  }

  // What a look at values needs lies in the first cache line.
  NodeContext& node_;
  bool all_told_ = false;         // no event that values_changed() found is still to be sent
  std::uint8_t defaults_of_ = 0;  // all was read of the defaults for this node-ID; 0: of others
  TimerQueue::Number first_timer_ = 0;
  // First those that SYNC concerns, then those that may have events.
  std::uint16_t synchronous_ = 0;
  std::uint16_t valid_count_ = 0;
  Valid* valid_ = nullptr;
  std::array<Valid, 4> few_valid_;  // as many as most devices have
  std::vector<Tpdo> tpdos_;         // in order of number
  std::unique_ptr<Valid[]> more_valid_;
  // All that TPDOs with events map lies here in the value block; values of another place need no look at them.
  std::uint32_t first_watched_ = 0;
  std::uint32_t watched_bytes_ = 0;
  MpdoScanner scanner_{node_};
};

}  // namespace canopus::canopen
