#include "canopus/manager/nmt/flying_start_up.hpp"

#include <algorithm>

#include "canopus/manager/nmt/flying_master.hpp"

namespace canopus::manager {

using canopen::NmtCommand;
using canopen::NmtState;

namespace {

constexpr can::Duration per_node_id = std::chrono::milliseconds(10);

std::uint32_t milliseconds(can::Duration duration) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

}  // namespace

void FlyingStartUp::begin(can::Time now) {
  canopen::ObjectDictionary& objects = master_.node.dictionary();
  if (objects.get<std::uint16_t>(0x1017, 0) == 0) {
    const auto period = canopen::little_endian(milliseconds(master_.options.flying_heartbeat), 2);
    static_cast<void>(objects.write(0x1017, 0, period, now));  // without the object: no heartbeat
  }
  const FlyingMasterTiming timing = flying_timing(objects, master_.node.node_id());
  flying_.start(master_.node.node_id(), timing, now);
}

void FlyingStartUp::stop() noexcept {
  flying_.stop();
  standby_entry_ = 0;
}

void FlyingStartUp::receive(const can::Frame& frame, can::Time now) {
  if (flying_.state() != FlyingMaster::State::off || frame.identifier == canopen::cob_id::nmt)
    flying_.receive(frame, now);
}

void FlyingStartUp::mastership_won(can::Time now) {
  // A slave that was Operational begins the start-up as any other master does.
  if (master_.node.state() != NmtState::pre_operational) {
    master_.node.command(NmtCommand::enter_pre_operational, now);
  }
  reset_all_nodes(now);  // also those that want to be kept alive [ME3CAN1-Q 4.8.6]
  start_up_.start_network(true, now);
}

void FlyingStartUp::mastership_lost(can::Time now) {
  start_up_.withdraw(now);
  commands_.clear();
  error_control_.forget_lost_heartbeats();
  start_up_.enter(StartUp::Phase::slave);
  for (std::uint8_t n = 1; n < 128; ++n) error_control_.stop_guarding(n, now);
  start_up_.show_active(false, now);
  start_up_.show_starting(now);
}

can::Duration FlyingStartUp::standby_for(std::uint8_t master_node_id, can::Time now) {
  const can::Duration configured = master_.heartbeat_time(master_node_id);
  if (configured > can::Duration{}) return configured;
  const can::Duration time = master_.options.flying_consumer_time + per_node_id * master_.node.node_id();
  canopen::ObjectDictionary& objects = master_.node.dictionary();
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

void FlyingStartUp::reset_all_nodes(can::Time now) {
  master_.send_nmt(NmtCommand::reset_communication, all_nodes, now);
}

}  // namespace canopus::manager
