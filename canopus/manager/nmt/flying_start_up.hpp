#pragma once
// The start-up of one of several flying masters [CiA 302-2; ME3CAN1-Q 4.8.10, notes B10]: 1F90H into the
// negotiation (flying_master.hpp), and what its outcome means for the network.

#include <cstdint>

#include "canopus/manager/nmt/error_control.hpp"
#include "canopus/manager/nmt/flying_master.hpp"
#include "canopus/manager/nmt/master_context.hpp"
#include "canopus/manager/nmt/nmt_command_queue.hpp"
#include "canopus/manager/nmt/start_up.hpp"

namespace canopus::manager {

class FlyingStartUp final : private FlyingMasterListener {
 public:
  FlyingStartUp(MasterContext& master, can::Sink& sink, StartUp& start_up, ErrorControl& error_control,
                NmtCommandQueue& commands)
      : master_(master),
        start_up_(start_up),
        error_control_(error_control),
        commands_(commands),
        flying_(sink, *this) {}

  /// Begins the negotiation, with a heartbeat for the others to watch.
  void begin(can::Time now);
  void stop() noexcept;
  /// Node-ID of the active master that is known of, 0 = none.
  [[nodiscard]] std::uint8_t active_master() const noexcept { return flying_.active_master(); }

  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now) { flying_.tick(now); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return flying_.alarm(); }

 private:
  void mastership_won(can::Time now) override;
  void mastership_lost(can::Time now) override;
  can::Duration standby_for(std::uint8_t master_node_id, can::Time now) override;
  void reset_all_nodes(can::Time now) override;

  MasterContext& master_;
  StartUp& start_up_;
  ErrorControl& error_control_;
  NmtCommandQueue& commands_;
  FlyingMaster flying_;
  std::uint8_t standby_entry_ = 0;  // sub-index of 1016H that was set to watch the active master; 0 = none
};

}  // namespace canopus::manager
