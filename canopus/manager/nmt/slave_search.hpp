#pragma once
// The boot time is over and mandatory slaves are missing: those whose identity is known are looked for by
// LSS, one after another (lss_search.hpp), before the start-up counts as failed [ME3CAN1-Q 4.8.11, RJ71CN91
// 1.2 LSS, FX3U-CAN 5.8.12].

#include <cstdint>

#include "canopus/lss/lss_search.hpp"
#include "canopus/manager/nmt/master_context.hpp"

namespace canopus::manager {

class StartUp;

class SlaveSearch final : private lss::LssSearchListener {
 public:
  /// LSS frames go to `wire`.
  SlaveSearch(MasterContext& master, StartUp& start_up, can::Sink& wire)
      : master_(master), start_up_(start_up), search_(wire, *this) {}

  /// 1F89H, 1F84H-1F88H of the node are set, and its 1F81H bits 0, 2 and 3.
  [[nodiscard]] bool is_configured(std::uint8_t node_id) const noexcept;
  /// Begins, as a phase of the start-up. False: no slave is to be searched.
  bool begin(can::Time now);
  /// Ends it, if it goes on; the own controller gets its bit rate back.
  void abandon(can::Time now);

  void receive(const can::Frame& frame, can::Time now) { search_.receive(frame, now); }
  void tick(can::Time now) { search_.tick(now); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return search_.alarm(); }

 private:
  void change_bit_rate(std::uint32_t bit_rate, can::Time now) override;
  void lss_search_finished(std::uint8_t node_id, bool found, can::Time now) override;
  [[nodiscard]] bool goes_on() const noexcept;
  void next(can::Time now);

  MasterContext& master_;
  StartUp& start_up_;
  lss::LssSearch search_;
  std::uint8_t node_id_ = 0;  // the slave that is being looked for
};

}  // namespace canopus::manager
