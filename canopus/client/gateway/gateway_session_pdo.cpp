// PDO commands of a gateway's client.

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/client/gateway/gateway_session.hpp"

namespace canopus::client {
namespace {

using Type = GatewayPdo::Type;

constexpr std::uint64_t longest_pdo_time = 65535;  // ms
constexpr std::uint64_t most_syncs = 240;

/// The digits right behind `word`, or the next word.
std::optional<std::uint64_t> number_behind(GatewayWords& words, std::string_view digits, std::uint64_t most) {
  const auto value = gateway_number(digits.empty() ? words.next() : digits);
  return value && *value <= most ? value : std::nullopt;
}

/// `event`, `syncN`, `rtr`; extended: `eventINHIBIT TIMER`, `syncN START`, `rtr`.
bool read_type(GatewayWords& words, bool extended, GatewayPdo& pdo) {
  const std::string_view type = words.next();
  if (type == "rtr") {
    pdo.type = Type::remote;
  } else if (type.starts_with("sync")) {
    const auto sync = gateway_number(type.substr(4));
    const auto start = extended ? words.number(0, most_syncs) : std::optional<std::uint64_t>(0);
    if (!sync || *sync > most_syncs || !start) return false;
    pdo.type = Type::sync;
    pdo.sync = std::max(1U, static_cast<unsigned>(*sync));
    pdo.sync_start = static_cast<std::uint8_t>(*start);
  } else if (extended && type.starts_with("event")) {
    const auto inhibit = number_behind(words, type.substr(5), longest_pdo_time);
    const auto timer = words.number(0, longest_pdo_time);
    if (!inhibit || !timer) return false;
    pdo.inhibit_time = std::chrono::milliseconds(*inhibit);
    pdo.event_timer = std::chrono::milliseconds(*timer);
  } else {
    return type == "event";
  }
  return true;
}

}  // namespace

/// `NUMBER COB-ID TYPE COUNT DATA-TYPE...`; the COB-ID as in 1400:01.
void GatewaySession::set_pdo(Words& words, bool received, bool extended) {
  const auto number = words.number(1, GatewayPdos::most);
  const auto entry = words.number(0, 0xFFFF'FFFF);
  GatewayPdo pdo;
  if (!number || !entry || !read_type(words, extended, pdo)) return answer(GatewayError::syntax);
  const canopen::CobId cob_id{static_cast<std::uint32_t>(*entry)};
  const std::uint32_t flags =
      canopen::CobId::invalid_bit | canopen::CobId::bit_30 | canopen::CobId::extended_bit;
  if ((cob_id.raw & ~flags) != cob_id.identifier()) return answer(GatewayError::syntax);
  if (cob_id.is_valid() && canopen::is_restricted(cob_id)) return answer(GatewayError::pdo_in_use);
  pdo.identifier = cob_id.identifier();
  pdo.extended = cob_id.is_extended();
  const auto count = words.number(0, 64);
  if (!count) return answer(GatewayError::syntax);
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto each = parse_gateway_type(words.next());
    if (!each) return answer(GatewayError::syntax);
    if (each->bits == 0) return answer(GatewayError::not_supported);
    pdo.types.push_back(*each);
  }
  if (!words.over()) return answer(GatewayError::syntax);
  if (const GatewayError error = network_only(words); error != GatewayError::none) return answer(error);
  GatewayPdos& pdos = gateway_.pdos();
  const auto place = static_cast<unsigned>(*number);
  if (!cob_id.is_valid()) {
    received ? pdos.remove_rpdo(place) : pdos.remove_tpdo(place);
    return answer(GatewayError::none);
  }
  answer(received ? pdos.set_rpdo(place, std::move(pdo)) : pdos.set_tpdo(place, std::move(pdo)));
}

void GatewaySession::read_pdo(Words& words, can::Time now) {
  const auto number = words.number(1, GatewayPdos::most);
  if (!number || !words.over()) return answer(GatewayError::syntax);
  const auto place = static_cast<unsigned>(*number);
  const auto show = [this](const GatewayPdo& pdo) {
    answer(fmt::format("{} pdo {}", Gateway::network, show_pdo_values(pdo)));
  };
  const GatewayPdo* pdo = gateway_.pdos().rpdo(place);
  if (pdo == nullptr) return answer(GatewayError::state);
  if (pdo->type != Type::remote) return pdo->values ? show(*pdo) : answer(GatewayError::state);
  const auto ticket = gateway_.request_pdo(place, [this, show](const GatewayPdo& answered, can::Time when) {
    show(answered);
    goes_on(when);
  });
  if (!ticket) return answer(GatewayError::overflow);
  begins(now);
  ticket_ = ticket;
  alarm().bring_forward(can::later(now, sdo_time_out_));
}

void GatewaySession::write_pdo(Words& words, can::Time now) {
  const auto number = words.number(1, GatewayPdos::most);
  const auto count = words.number(0, 64);
  if (!number || !count) return answer(GatewayError::syntax);
  std::vector<std::uint64_t> values;
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto value = gateway_number(words.next());
    if (!value) return answer(GatewayError::syntax);
    values.push_back(*value);
  }
  if (!words.over()) return answer(GatewayError::syntax);
  answer(gateway_.pdos().write(static_cast<unsigned>(*number), values, now));
}

}  // namespace canopus::client
