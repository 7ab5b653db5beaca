// The NMT master as one of several flying masters [CiA 302-2; ME3CAN1-Q 4.8.10, notes B10].

#include <algorithm>

#include "canopus/manager/nmt_master_engine.hpp"

namespace canopus::manager {

using canopen::NmtCommand;
using canopen::NmtState;

namespace {

constexpr can::Duration per_node_id = std::chrono::milliseconds(10);

std::uint32_t milliseconds(can::Duration duration) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

}  // namespace

void NmtMaster::Engine::begin_flying(can::Time now) {
  phase_ = Phase::slave;
  canopen::ObjectDictionary& objects = node_->dictionary();
  if (objects.get<std::uint16_t>(0x1017, 0) == 0) {
    const auto period = canopen::little_endian(milliseconds(options_.flying_heartbeat), 2);
    static_cast<void>(objects.write(0x1017, 0, period, now));  // without the object: no heartbeat
  }
  const auto time = [&](std::uint8_t sub, unsigned otherwise) {
    return std::chrono::milliseconds(
        objects.get<std::uint16_t>(0x1F90, sub, static_cast<std::uint16_t>(otherwise)));
  };
  FlyingMasterTiming timing;
  timing.time_out = time(1, 100);
  timing.negotiation_delay = time(2, 500);
  timing.level = static_cast<std::uint8_t>(objects.get<std::uint16_t>(0x1F90, 3, 1));
  timing.priority_slot = time(4, 1500);
  timing.device_slot = time(5, 10);
  timing.detect_cycle = time(6, 4000 + 10U * node_->node_id());
  flying_.start(node_->node_id(), timing, now);
  refresh_master(now);
}

void NmtMaster::Engine::mastership_won(can::Time now) {
  // A slave that was Operational begins the start-up as any other master does.
  if (node_->state() != NmtState::pre_operational) node_->command(NmtCommand::enter_pre_operational, now);
  reset_all_nodes(now);  // also those that want to be kept alive [ME3CAN1-Q 4.8.6]
  network_was_reset_ = true;
  start_network(now);
}

void NmtMaster::Engine::mastership_lost(can::Time now) {
  abandon_search(now);
  abandon_boots();
  boot_end_ = can::never;
  begin_pending_ = network_was_reset_ = false;
  command_count_ = 0;
  heartbeat_lost_pending_.reset();
  enter(Phase::slave, now);
  for (std::uint8_t n = 1; n < 128; ++n) {
    guarding_[n].stop();
    set_flags(n, 0, error_control::guarding_active, now);
    refresh(n);
  }
  node_->set_active_master(false, now);
  listener_->active_changed(false, now);
  tell_starting(now);
}

can::Duration NmtMaster::Engine::standby_for(std::uint8_t master_node_id, can::Time now) {
  if (const can::Duration configured = heartbeat_time(master_node_id); configured > can::Duration{}) {
    return configured;
  }
  const can::Duration time = options_.flying_consumer_time + per_node_id * node_->node_id();
  canopen::ObjectDictionary& objects = node_->dictionary();
  const auto entries = objects.get<std::uint8_t>(0x1016, 0);
  for (unsigned sub = 1; sub <= entries && standby_entry_ == 0; ++sub) {
    if (objects.get<std::uint32_t>(0x1016, static_cast<std::uint8_t>(sub)) == 0) {
      standby_entry_ = static_cast<std::uint8_t>(sub);
    }
  }
  if (standby_entry_ != 0) {
    const auto entry = canopen::little_endian(
        std::uint32_t{master_node_id} << 16 | std::min<std::uint32_t>(milliseconds(time), 0xFFFF), 4);
    static_cast<void>(objects.write(0x1016, standby_entry_, entry, now));
  }
  return time;
}

void NmtMaster::Engine::reset_all_nodes(can::Time now) { send_nmt(NmtCommand::reset_communication, 0, now); }

}  // namespace canopus::manager
