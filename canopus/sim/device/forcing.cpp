#include "canopus/sim/device/forcing.hpp"

#include <algorithm>
#include <utility>

namespace canopus::sim {

using canopen::Entry;

namespace {

std::pair<std::uint16_t, std::uint8_t> key(const Entry& entry) noexcept { return {entry.index, entry.sub}; }

}  // namespace

std::vector<Forcing::Force>::iterator Forcing::find(const Entry& entry) noexcept {
  return std::ranges::find(forces_, key(entry), [](const Force& force) { return key(force.entry); });
}

bool Forcing::is_forced(const Entry& entry) const noexcept {
  return std::ranges::any_of(forces_, [&](const Force& force) { return key(force.entry) == key(entry); });
}

bool Forcing::force(const Entry& entry, std::uint64_t value, can::Time until) {
  const auto before = dictionary().get<std::uint64_t>(entry);
  auto known = find(entry);
  if (known == forces_.end()) {
    node_.attach(entry.index, entry.index, *this);
    const auto place = std::ranges::lower_bound(forces_, key(entry), {},
                                                [](const Force& force) { return key(force.entry); });
    known = forces_.insert(place, {.entry = entry, .beneath = before});
  }
  dictionary().set(entry, value);
  known->value = dictionary().get<std::uint64_t>(entry);
  known->until = until;
  set_alarm();
  return known->value != before;
}

bool Forcing::release(const Entry& entry) {
  const auto known = find(entry);
  if (known == forces_.end()) return false;
  const bool changes = known->value != known->beneath;
  dictionary().set(entry, known->beneath);
  forces_.erase(known);
  if (forces_.empty()) node_.detach(*this);
  set_alarm();
  return changes;
}

bool Forcing::put(const Entry& entry, std::uint64_t value) {
  if (!forces_.empty()) {
    if (const auto known = find(entry); known != forces_.end()) {
      dictionary().set(entry, value);
      keep_beneath(*known);
      return false;
    }
  }
  const auto before = dictionary().get<std::uint64_t>(entry);
  dictionary().set(entry, value);
  return dictionary().get<std::uint64_t>(entry) != before;
}

/// The dictionary has another value than the forced one: it goes beneath.
void Forcing::keep_beneath(Force& force) {
  force.beneath = dictionary().get<std::uint64_t>(force.entry);
  dictionary().set(force.entry, force.value);
}

void Forcing::rpdo_received(std::uint16_t number) {
  if (forces_.empty()) return;
  const auto mapping = static_cast<std::uint16_t>(0x1600 + number);
  const auto count = dictionary().get<std::uint8_t>(mapping, 0);
  for (std::uint8_t i = 1; i <= count && i <= 64; ++i) {
    const auto mapped = dictionary().get<std::uint32_t>(mapping, i);
    for (Force& force : forces_) {
      if ((mapped >> 8) == (std::uint32_t{force.entry.index} << 8 | force.entry.sub)) keep_beneath(force);
    }
  }
}

void Forcing::values_loaded() {
  for (Force& force : forces_) keep_beneath(force);
}

// An SDO, or an MPDO. Before the other listeners of the write, so that no TPDO leaves with the value beneath.
void Forcing::after_write(canopen::ObjectDictionary&, const Entry& entry, can::Time) {
  if (const auto known = find(entry); known != forces_.end()) keep_beneath(*known);
}

void Forcing::set_alarm() noexcept {
  can::Time next = can::never;
  for (const Force& force : forces_) next = std::min(next, force.until);
  alarm_ = next;
}

}  // namespace canopus::sim
