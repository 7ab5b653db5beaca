#include "canopus/client/gateway/gateway_pdo.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/service/nmt.hpp"

namespace canopus::client {
namespace {

using Type = GatewayPdo::Type;

unsigned bits_of(const GatewayPdo& pdo) {
  unsigned bits = 0;
  for (const GatewayType& type : pdo.types) bits += type.bits;
  return bits;
}

std::uint8_t bytes_of(const GatewayPdo& pdo) { return static_cast<std::uint8_t>((bits_of(pdo) + 7) / 8); }

bool is_of(const GatewayPdo& pdo, const can::Frame& frame) {
  return pdo.identifier == frame.identifier && pdo.extended == frame.extended;
}

/// Its turn has come with this SYNC.
bool counts_up(GatewayPdo& pdo, const can::Frame& sync) {
  if (pdo.type != Type::sync || !pdo.waits) return false;
  const bool has_counter = sync.length() == 1;
  if (!pdo.counting && pdo.sync_start != 0 && has_counter && sync.data[0] != pdo.sync_start) return false;
  pdo.counting = true;
  if (++pdo.syncs < pdo.sync) return false;
  pdo.waits = false;
  pdo.syncs = 0;
  return true;
}

}  // namespace

std::string show_pdo_values(const GatewayPdo& pdo) {
  std::string text = fmt::format("{}", pdo.types.size());
  if (pdo.values) {
    for (const std::uint64_t value : *pdo.values) text += fmt::format(" 0x{:x}", value);
  }
  return text;
}

GatewayError GatewayPdos::set(Pdos& pdos, unsigned number, GatewayPdo pdo) {
  if (number == 0 || number > most) return GatewayError::syntax;
  if (bits_of(pdo) > 64) return GatewayError::pdo_length;
  for (const Pdos* each : {&rpdos_, &tpdos_}) {
    for (const auto& [other, entry] : *each) {
      const bool itself = each == &pdos && other == number;
      if (!itself && entry.identifier == pdo.identifier && entry.extended == pdo.extended)
        return GatewayError::pdo_in_use;
    }
  }
  pdos[number] = std::move(pdo);
  set_alarm();
  return GatewayError::none;
}

void GatewayPdos::clear() {
  rpdos_.clear();
  tpdos_.clear();
  waiting_.clear();
  set_alarm();
}

const GatewayPdo* GatewayPdos::rpdo(unsigned number) const {
  const auto pdo = rpdos_.find(number);
  return pdo == rpdos_.end() ? nullptr : &pdo->second;
}

GatewayError GatewayPdos::request(unsigned number, Ticket ticket, Done done) {
  const GatewayPdo* pdo = rpdo(number);
  if (pdo == nullptr) return GatewayError::state;
  can::Frame frame = can::remote_frame(pdo->identifier, bytes_of(*pdo));
  frame.extended = pdo->extended;
  if (!bus_.send(frame)) return GatewayError::overflow;
  waiting_.push_back({ticket, number, std::move(done)});
  return GatewayError::none;
}

void GatewayPdos::call_off(Ticket ticket) {
  std::erase_if(waiting_, [ticket](const Waiting& entry) { return entry.ticket == ticket; });
}

// --- sending

GatewayError GatewayPdos::write(unsigned number, std::span<const std::uint64_t> values, can::Time now) {
  const auto found = tpdos_.find(number);
  if (found == tpdos_.end()) return GatewayError::state;
  GatewayPdo& pdo = found->second;
  if (values.size() != pdo.types.size()) return GatewayError::pdo_length;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const unsigned bits = pdo.types[i].bits;
    if (bits < 64 && values[i] >> bits != 0) return GatewayError::pdo_length;
  }
  pdo.values.emplace(values.begin(), values.end());
  switch (pdo.type) {
    case Type::remote: return GatewayError::none;
    case Type::sync:
      pdo.waits = true;
      pdo.syncs = 0;
      return GatewayError::none;
    case Type::event: break;
  }
  if (now < pdo.inhibited_until) {
    pdo.waits = true;
    pdo.next = pdo.inhibited_until;
    set_alarm();
    return GatewayError::none;
  }
  return send(pdo, now) ? GatewayError::none : GatewayError::overflow;
}

bool GatewayPdos::send(GatewayPdo& pdo, can::Time now) {
  std::uint64_t word = 0;
  unsigned place = 0;
  for (std::size_t i = 0; i < pdo.types.size(); ++i) {
    if (place < 64) word |= (*pdo.values)[i] << place;
    place += pdo.types[i].bits;
  }
  can::Frame frame{.identifier = pdo.identifier, .extended = pdo.extended, .dlc = bytes_of(pdo)};
  for (std::size_t i = 0; i < frame.length(); ++i) frame.data[i] = static_cast<std::uint8_t>(word >> (8 * i));
  if (pdo.type == Type::event) {
    pdo.waits = false;
    pdo.inhibited_until = can::later(now, pdo.inhibit_time);
    pdo.next = pdo.event_timer.count() == 0 ? can::never
                                            : can::later(now, std::max(pdo.event_timer, pdo.inhibit_time));
    set_alarm();
  }
  return bus_.send(frame);
}

void GatewayPdos::tick(can::Time now) {
  for (auto& [number, pdo] : tpdos_) {
    if (pdo.next <= now) (void)send(pdo, now);
  }
}

void GatewayPdos::set_alarm() {
  can::Time first = can::never;
  for (const auto& [number, pdo] : tpdos_) first = std::min(first, pdo.next);
  alarm() = first;
}

// --- receiving

void GatewayPdos::store(unsigned number, GatewayPdo& pdo, const can::Frame& frame, can::Time now) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < frame.length(); ++i) word |= std::uint64_t{frame.data[i]} << (8 * i);
  std::vector<std::uint64_t> values;
  unsigned place = 0;
  for (const GatewayType& type : pdo.types) {
    const std::uint64_t mask = type.bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << type.bits) - 1;
    values.push_back(place < 64 ? word >> place & mask : 0);
    place += type.bits;
  }
  if (place > 8 * frame.length()) return user_.pdo_too_short();
  pdo.values = std::move(values);
  switch (pdo.type) {
    case Type::event: return user_.pdo_received(number, pdo);
    case Type::sync: pdo.waits = true; return;
    case Type::remote: break;
  }
  // A client may make another request in the callback of its answer.
  std::vector<Waiting> answered;
  std::erase_if(waiting_, [&](Waiting& entry) {
    if (entry.number != number) return false;
    answered.push_back(std::move(entry));
    return true;
  });
  const GatewayPdo copy = pdo;
  for (const Waiting& entry : answered) entry.done(copy, now);
}

void GatewayPdos::sync(const can::Frame& frame, can::Time now) {
  for (auto& [number, pdo] : rpdos_) {
    if (counts_up(pdo, frame)) user_.pdo_received(number, pdo);
  }
  for (auto& [number, pdo] : tpdos_) {
    if (counts_up(pdo, frame)) (void)send(pdo, now);
  }
}

void GatewayPdos::receive(const can::Frame& frame, can::Time now) {
  if (frame.identifier == canopen::cob_id::sync && !frame.extended && !frame.remote) sync(frame, now);
  if (frame.remote) {
    for (auto& [number, pdo] : tpdos_) {
      if (pdo.type == Type::remote && is_of(pdo, frame) && pdo.values) (void)send(pdo, now);
    }
    return;
  }
  // An identifier is of one PDO at most.
  const auto found =
      std::ranges::find_if(rpdos_, [&](const auto& entry) { return is_of(entry.second, frame); });
  if (found != rpdos_.end()) store(found->first, found->second, frame, now);
}

}  // namespace canopus::client
