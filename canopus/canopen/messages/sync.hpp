#pragma once
// SYNC, consumer and producer [CiA 301 7.2.5]. The frame has the identifier of 1005H (default 080H) and no
// data, or one byte, a counter 1..1019H, when 1019H is not 0. The producer sends it every 1006H microseconds
// in Pre-operational and Operational while bit 30 of 1005H is set, the first one a period after it was set.
// A received SYNC whose length does not fit 1019H is not acted upon: EMCY 8240H. 1007H is the time after SYNC
// within which synchronous RPDOs are still accepted.
//
// Checks: 1005H: identifier rules; changing bits 0-29 while bit 30 stays 1 06090030H; bit 30 in a dictionary
// without 1006H 06090030H. 1019H: 1 and above 240 06090030H; any write while 1006H is not 0 08000022H.

#include <vector>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/canopen/service/identifier_table.hpp"
#include "canopus/canopen/service/node_context.hpp"

namespace canopus::canopen {

class Sync final : public ObjectHandler {
 public:
  explicit Sync(NodeContext& node);

  /// Reads 1005H, 1006H, 1007H and 1019H.
  void start(can::Time now);
  void stop();
  /// The NMT state or the master's role changed: production starts (counter 1) or stops.
  void state_changed(can::Time now);

  /// A frame with the SYNC identifier came. True: it is a SYNC, and counter() is what it carried.
  bool receive(const can::Frame& frame, can::Time now);
  /// Time to produce one: sends it. True when it was sent, and counter() is what it carried.
  bool tick(can::Time now);
  [[nodiscard]] std::uint8_t counter() const noexcept { return counter_; }
  /// End of the synchronous window that the last SYNC opened; never when there is no window.
  [[nodiscard]] can::Time window_end() const noexcept { return window_end_; }

  void list_identifiers(std::vector<IdentifierTable::Route>& routes) const;
  [[nodiscard]] TimerQueue::Number timer() const noexcept { return timer_; }

  AbortCode before_write(ObjectDictionary&, const Entry&, std::span<const std::uint8_t>, can::Time) override;
  void after_write(ObjectDictionary&, const Entry&, can::Time now) override;

 private:
  [[nodiscard]] bool produces() const noexcept;
  void read();
  void opened(can::Time now);

  NodeContext& node_;
  TimerQueue::Number timer_;
  CobId cob_id_;
  can::Duration period_{};
  can::Duration window_{};
  can::Time window_end_ = can::never;
  can::Time next_{};
  std::uint8_t overflow_ = 0;  // 1019H
  std::uint8_t counter_ = 0;
  std::uint8_t next_counter_ = 1;
  bool length_error_ = false;
};

}  // namespace canopus::canopen
