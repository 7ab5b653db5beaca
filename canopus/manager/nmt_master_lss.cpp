// Boot time over and mandatory slaves missing: those whose identity is known are looked for by LSS before the
// start-up counts as failed [ME3CAN1-Q 4.8.11, RJ71CN91 1.2 LSS, FX3U-CAN 5.8.12].

#include "canopus/manager/nmt_master_engine.hpp"

namespace canopus::manager {

bool NmtMaster::Engine::lss_configured(std::uint8_t node_id) const noexcept {
  constexpr std::uint32_t needed =
      assignment_bit::slave | assignment_bit::boot_slave | assignment_bit::mandatory;
  if (node_id == 0 || node_id > 127 || (assignment(node_id) & needed) != needed) return false;
  const canopen::ObjectDictionary& objects = node_->dictionary();
  if (objects.get<std::uint32_t>(0x1F89, 0) == 0) return false;
  for (std::uint16_t index = 0x1F84; index <= 0x1F88; ++index) {
    if (objects.get<std::uint32_t>(index, node_id) == 0) return false;
  }
  return true;
}

// The boots stand still from here on: what they ask would be in the way, and at other bit rates be noise.
bool NmtMaster::Engine::begin_searches(can::Time now) {
  wanted_.reset();
  for (std::uint8_t n = 1; n < 128; ++n) {
    wanted_[n] = lss_configured(n) && boots_[n] && boots_[n]->running() && !boots_[n]->answered();
  }
  if (wanted_.none() || options_.bit_rate == 0) return false;
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (boots_[n] && boots_[n]->running()) boots_[n]->suspend();
    refresh(n);
  }
  searching_for_ = 0;
  enter(Phase::searching, now);
  listener_->lss_active_changed(true, now);
  if (phase_ == Phase::searching) search_next(now);
  return true;
}

void NmtMaster::Engine::search_next(can::Time now) {
  const canopen::ObjectDictionary& objects = node_->dictionary();
  while (++searching_for_ < 128) {
    const std::uint8_t n = searching_for_;
    if (!wanted_[n]) continue;
    const LssAddress address{objects.get<std::uint32_t>(0x1F85, n), objects.get<std::uint32_t>(0x1F86, n),
                             objects.get<std::uint32_t>(0x1F87, n), objects.get<std::uint32_t>(0x1F88, n)};
    if (search_.start(n, address, options_.bit_rate, now)) return refresh_master(now);
  }
  listener_->lss_active_changed(false, now);
  if (phase_ == Phase::searching) start_up_failed(now);
}

void NmtMaster::Engine::abandon_search(can::Time now) {
  if (phase_ != Phase::searching) return;
  const bool away = search_.running() && search_.bit_rate() != options_.bit_rate;
  search_.cancel();
  muted_ = false;
  if (away) listener_->change_bit_rate(options_.bit_rate, now);
  listener_->lss_active_changed(false, now);
}

void NmtMaster::Engine::change_bit_rate(std::uint32_t bit_rate, can::Time now) {
  muted_ = bit_rate != options_.bit_rate;
  listener_->change_bit_rate(bit_rate, now);
}

void NmtMaster::Engine::lss_search_finished(std::uint8_t node_id, bool found, can::Time now) {
  listener_->lss_search_ended(node_id, found, now);
  if (phase_ == Phase::searching) search_next(now);
}

}  // namespace canopus::manager
