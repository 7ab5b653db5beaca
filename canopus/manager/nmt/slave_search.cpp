#include "canopus/manager/nmt/slave_search.hpp"

#include "canopus/manager/nmt/start_up.hpp"

namespace canopus::manager {

bool SlaveSearch::is_configured(std::uint8_t node_id) const noexcept {
  constexpr std::uint32_t needed =
      assignment_bit::slave | assignment_bit::boot_slave | assignment_bit::mandatory;
  if (node_id == 0 || node_id > 127 || (master_.assignment(node_id) & needed) != needed) return false;
  const canopen::ObjectDictionary& objects = master_.dictionary();
  if (objects.get<std::uint32_t>(0x1F89, 0) == 0) return false;
  for (std::uint16_t index = 0x1F84; index <= 0x1F88; ++index) {
    if (objects.get<std::uint32_t>(index, node_id) == 0) return false;
  }
  return true;
}

bool SlaveSearch::goes_on() const noexcept { return start_up_.phase() == StartUp::Phase::searching; }

// The boots stand still from here on: what they ask would be in the way, and at other bit rates be noise.
bool SlaveSearch::begin(can::Time now) {
  bool any = false;
  for (std::uint8_t n = 1; n < 128; ++n) {
    Slave& slave = master_.slaves[n];
    slave.is_wanted = is_configured(n) && slave.is_booting() && !slave.boot->answered();
    any = any || slave.is_wanted;
  }
  if (!any || master_.options.bit_rate == 0) return false;
  for (std::uint8_t n = 1; n < 128; ++n) {
    if (master_.slaves[n].is_booting()) master_.slaves[n].boot->suspend();
  }
  node_id_ = 0;
  start_up_.enter(StartUp::Phase::searching);
  master_.listener->lss_active_changed(true, now);
  if (goes_on()) next(now);
  return true;
}

void SlaveSearch::next(can::Time now) {
  const canopen::ObjectDictionary& objects = master_.dictionary();
  while (++node_id_ < 128) {
    if (!master_.slaves[node_id_].is_wanted) continue;
    const auto part = [&](std::uint16_t index) { return objects.get<std::uint32_t>(index, node_id_); };
    const lss::LssAddress address{part(0x1F85), part(0x1F86), part(0x1F87), part(0x1F88)};
    if (search_.start(node_id_, address, master_.options.bit_rate, now)) return;
  }
  master_.listener->lss_active_changed(false, now);
  if (goes_on()) start_up_.fail(now);
}

void SlaveSearch::abandon(can::Time now) {
  if (!goes_on()) return;
  const bool is_away = search_.running() && search_.bit_rate() != master_.options.bit_rate;
  search_.cancel();
  master_.mute(false);
  if (is_away) master_.listener->change_bit_rate(master_.options.bit_rate, now);
  master_.listener->lss_active_changed(false, now);
}

void SlaveSearch::change_bit_rate(std::uint32_t bit_rate, can::Time now) {
  master_.mute(bit_rate != master_.options.bit_rate);
  master_.listener->change_bit_rate(bit_rate, now);
}

void SlaveSearch::lss_search_finished(std::uint8_t node_id, bool found, can::Time now) {
  master_.listener->lss_search_ended(node_id, found, now);
  if (goes_on()) next(now);
}

}  // namespace canopus::manager
