// LSS commands of a gateway's client [CiA 309-3; CiA 305]. `_lss_slowscan` and the masks of `_lss_fastscan` are
// lely-core's, `lss_allnodes` and the time-out of `_lss_fastscan` CANopenNode's.

#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "canopus/client/gateway/gateway_session.hpp"

// False warning of g++ 12: when the construction of the next function throws, it assumes that the first one
// is destroyed unconstructed.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

namespace canopus::client {

using lss::LssAddress;
using lss::LssMaster;
using lss::LssResult;
using Step = GatewayLss::Step;

namespace {

constexpr std::uint64_t highest_number = 0xFFFF'FFFF;
constexpr std::uint64_t longest_lss_time = 65535;  // ms

/// That many numbers of 32 bits.
template <std::size_t count>
std::optional<std::array<std::uint32_t, count>> read_numbers(GatewayWords& words) {
  std::array<std::uint32_t, count> numbers{};
  for (auto& number : numbers) {
    const auto value = words.number(0, highest_number);
    if (!value) return std::nullopt;
    number = static_cast<std::uint32_t>(*value);
  }
  return numbers;
}

std::string show(const LssAddress& address) {
  return fmt::format("0x{:08X} 0x{:08X} 0x{:08X} 0x{:08X}", address.vendor, address.product, address.revision,
                     address.serial);
}

/// The error code of a refusal by the device, by the command.
GatewayError refusal(const LssMaster& master, std::uint8_t command) {
  constexpr std::uint8_t specific = 0xFF;
  if (master.error() == 0) return GatewayError::state;  // a reset of the gateway ended it
  if (master.error() == specific) return GatewayError::lss;
  switch (command) {
    case lss::command::configure_node_id: return GatewayError::lss_node_id;
    case lss::command::configure_bit_timing: return GatewayError::lss_bit_rate;
    case lss::command::store: return master.error() == 2 ? GatewayError::lss_media : GatewayError::lss_store;
    default: return GatewayError::lss;
  }
}

}  // namespace

void GatewaySession::lss_answer(LssResult result, const LssMaster& master, std::uint8_t command,
                                const LssAnswer& shown, can::Time now) {
  switch (result) {
    case LssResult::done: shown ? answer(shown(master)) : answer(GatewayError::none); break;
    case LssResult::refused: answer(refusal(master, command)); break;
    case LssResult::silence:
    case LssResult::lost: answer(GatewayError::time_out); break;
  }
  goes_on(now);
}

void GatewaySession::lss_request(GatewayLss::Request request, can::Time now, bool limited) {
  begins(now, limited);
  const Gateway::Ticket ticket = gateway_.lss(std::move(request), now);
  if (ticket_) ticket_ = ticket;
}

/// One service; `command` selects the error code of a refusal.
void GatewaySession::lss_service(LssService service, can::Time now, LssAnswer shown, std::uint8_t command) {
  lss_request({.first = {.begin = std::move(service)},
               .done = [this, command, shown = std::move(shown)](
                           LssResult result, const LssMaster& master,
                           can::Time when) { lss_answer(result, master, command, shown, when); }},
              now);
}

void GatewaySession::lss_command(std::string_view name, Words& words, can::Time now) {
  if (const GatewayError error = network_only(words); error != GatewayError::none) return answer(error);
  const auto wrong = [this] { answer(GatewayError::syntax); };
  if (name == "lss_switch_glob") {
    const auto state = words.number(0, 1);
    if (!state || !words.over()) return wrong();
    return lss_service(
        [on = *state == 1](LssMaster& master, can::Time when) { return master.switch_global(on, when); },
        now);
  }
  if (name == "lss_switch_sel") {
    const auto n = read_numbers<4>(words);
    if (!n || !words.over()) return wrong();
    const LssAddress address{(*n)[0], (*n)[1], (*n)[2], (*n)[3]};
    return lss_service([address](LssMaster& master, can::Time when) { return master.select(address, when); },
                       now);
  }
  if (name == "lss_set_node") {
    const auto node = words.number(1, lss::unconfigured);
    if (!node || !words.over()) return wrong();
    if (*node > 127 && *node != lss::unconfigured) return answer(GatewayError::unsupported_node);
    return lss_service([id = static_cast<std::uint8_t>(*node)](
                           LssMaster& master, can::Time when) { return master.configure_node_id(id, when); },
                       now, {}, lss::command::configure_node_id);
  }
  if (name == "lss_conf_bitrate") {
    const auto table = words.number(0, 255);
    const auto index = words.number(0, 255);
    if (!table || !index || !words.over()) return wrong();
    const auto number = static_cast<std::uint8_t>(*index);
    lss_rate_.reset();
    return lss_service(
        [number, selector = static_cast<std::uint8_t>(*table)](LssMaster& master, can::Time when) {
          return master.configure_bit_timing(number, when, selector);
        },
        now,
        [this, number, is_known = *table == 0 && number < lss::bit_rates.size()](const LssMaster&) {
          if (is_known) lss_rate_ = number;
          return std::string("OK");
        },
        lss::command::configure_bit_timing);
  }
  if (name == "lss_activate_bitrate") {
    const auto delay = words.number(0, longest_lss_time);
    if (!delay || !words.over()) return wrong();
    return lss_activate(std::chrono::milliseconds(*delay), now);
  }
  if (name == "lss_store") {
    if (!words.over()) return wrong();
    return lss_service([](LssMaster& master, can::Time when) { return master.store(when); }, now, {},
                       lss::command::store);
  }
  if (name == "lss_inquire_addr") {
    if (words.over()) return lss_inquire_all(now);
    auto part = words.number(0, lss::command::inquire_serial);
    if (part && *part >= lss::command::inquire_vendor) *part -= lss::command::inquire_vendor;
    if (!part || *part > 3 || !words.over()) return wrong();
    return lss_service([part = static_cast<unsigned>(*part)](
                           LssMaster& master, can::Time when) { return master.inquire(part, when); },
                       now, [](const LssMaster& master) { return fmt::format("0x{:08X}", master.value()); });
  }
  if (name == "lss_get_node") {
    if (!words.over()) return wrong();
    return lss_service([](LssMaster& master, can::Time when) { return master.inquire_node_id(when); }, now,
                       [](const LssMaster& master) { return fmt::format("{}", master.value() & 0xFFU); });
  }
  if (name == "lss_ident_nonconf") {
    if (!words.over()) return wrong();
    return lss_service([](LssMaster& master, can::Time when) { return master.identify_unconfigured(when); },
                       now);
  }
  if (name == "lss_identity" || name == "_lss_slowscan") {
    const auto n = read_numbers<6>(words);
    if (!n || !words.over()) return wrong();
    const LssAddress low{(*n)[0], (*n)[1], (*n)[2], (*n)[4]};
    const LssAddress high{(*n)[0], (*n)[1], (*n)[3], (*n)[5]};
    if (low.revision > high.revision || low.serial > high.serial) return wrong();
    if (name == "_lss_slowscan") {
      return lss_scan(
          [low, high](LssMaster& master, can::Time when) { return master.slow_scan(low, high, when); },
          GatewayLss::default_time_out, now);
    }
    return lss_service(
        [low, high](LssMaster& master, can::Time when) { return master.identify(low, high, when); }, now);
  }
  if (name == "_lss_fastscan") return lss_fastscan(words, now);
  if (name == "lss_allnodes") return lss_all_nodes(words, now);
  answer(GatewayError::syntax);
}

/// All four numbers of the address.
void GatewaySession::lss_inquire_all(can::Time now) {
  const auto found = std::make_shared<LssAddress>();
  const auto part = std::make_shared<unsigned>(0);
  const auto ask = [part](LssMaster& master, can::Time when) { return master.inquire(*part, when); };
  lss_request({.first = {.begin = ask},
               .next = [found, part, ask](LssResult result, const LssMaster& master,
                                          can::Time) -> std::optional<Step> {
                 if (result != LssResult::done) return std::nullopt;
                 found->set_part(*part, master.value());
                 if (++*part == 4) return std::nullopt;
                 return Step{.begin = ask};
               },
               .done =
                   [this, found](LssResult result, const LssMaster& master, can::Time when) {
                     lss_answer(
                         result, master, 0, [found](const LssMaster&) { return show(*found); }, when);
                   }},
              now);
}

/// The own controller changes its bit rate with the devices; no node transmits during the delay before and
/// after [CiA 305]. Continues after a disconnect of its client.
void GatewaySession::lss_activate(can::Duration delay, can::Time now) {
  enum class Stage : std::uint8_t { sent, before, after };
  const auto stage = std::make_shared<Stage>(Stage::sent);
  const auto failure = std::make_shared<std::string>();
  const std::uint32_t rate = lss_rate_ ? lss::bit_rates[*lss_rate_] : 0;
  lss_rate_.reset();
  lss_request({.first = {.begin = [ms = std::chrono::duration_cast<std::chrono::milliseconds>(delay)](
                                      LssMaster& master,
                                      can::Time when) { return master.activate_bit_timing(ms, when); }},
               .next = [stage, failure, rate, delay, &gateway = gateway_](LssResult, const LssMaster&,
                                                                          can::Time) -> std::optional<Step> {
                 switch (*stage) {
                   case Stage::sent:
                     *stage = Stage::before;
                     gateway.set_silent(true);
                     return Step{.pause = delay};
                   case Stage::before:
                     *stage = Stage::after;
                     if (rate != 0) {
                       if (const auto done = gateway.restart(rate); !done) *failure = done.error();
                     }
                     return Step{.pause = delay};
                   case Stage::after: gateway.set_silent(false); break;
                 }
                 return std::nullopt;
               },
               .done =
                   [this, failure](LssResult result, const LssMaster& master, can::Time when) {
                     if (failure->empty()) return lss_answer(result, master, 0, {}, when);
                     answer(GatewayError::controller, *failure);
                     goes_on(when);
                   },
               .goes_on = true},
              now, false);
}

/// Many questions: the time-out of a command does not count.
void GatewaySession::lss_scan(LssService scan, can::Duration time_out, can::Time now) {
  lss_request({.first = {.begin = std::move(scan)},
               .done =
                   [this](LssResult result, const LssMaster& master, can::Time when) {
                     lss_answer(
                         result, master, 0, [](const LssMaster& m) { return show(m.address()); }, when);
                   },
               .time_out = time_out},
              now, false);
}

/// `[TIME-OUT]`, or each of the four numbers with the mask of its bits that are known.
void GatewaySession::lss_fastscan(Words& words, can::Time now) {
  can::Duration time_out = GatewayLss::default_time_out;
  LssAddress known;
  LssAddress mask;
  Words ahead = words;
  if (const auto n = read_numbers<8>(ahead)) {
    words = ahead;
    for (unsigned part = 0; part < 4; ++part) {
      known.set_part(part, (*n)[2 * part]);
      mask.set_part(part, (*n)[2 * part + 1]);
    }
  } else if (!words.over()) {
    const auto given = words.number(1, longest_lss_time);
    if (!given) return answer(GatewayError::syntax);
    time_out = std::chrono::milliseconds(*given);
  }
  if (!words.over()) return answer(GatewayError::syntax);
  lss_scan([known, mask](LssMaster& master, can::Time when) { return master.fastscan(known, mask, when); },
           time_out, now);
}

/// `[TIME-OUT [FIRST-NODE STORE]]`: fastscan, node-ID, store, waiting; until no device without a node-ID
/// answers.
void GatewaySession::lss_all_nodes(Words& words, can::Time now) {
  std::array<std::uint64_t, 3> given{100, 2, 0};
  constexpr std::array<std::pair<std::uint64_t, std::uint64_t>, 3> bounds{
      {{1, longest_lss_time}, {1, 127}, {0, 1}}};
  for (std::size_t i = 0; i < given.size() && !words.over(); ++i) {
    const auto value = words.number(bounds[i].first, bounds[i].second);
    if (!value) return answer(GatewayError::syntax);
    given[i] = *value;
  }
  if (!words.over()) return answer(GatewayError::not_supported);  // scan types of CANopenNode
  enum class Stage : std::uint8_t { scan, set_node, store, waiting };
  struct State {
    Stage stage = Stage::scan;
    unsigned node = 0;
    unsigned found = 0;
  };
  const auto state = std::make_shared<State>(State{.node = static_cast<unsigned>(given[1])});
  const auto scan = [](LssMaster& master, can::Time when) { return master.fastscan(when); };
  const auto waiting = [](LssMaster& master, can::Time when) { return master.switch_global(false, when); };
  const auto store = [](LssMaster& master, can::Time when) { return master.store(when); };
  const auto set_node = [state](LssMaster& master, can::Time when) {
    return master.configure_node_id(static_cast<std::uint8_t>(state->node), when);
  };
  lss_request(
      {.first = {.begin = scan},
       .next = [=, stores = given[2] == 1](LssResult result, const LssMaster&,
                                           can::Time) -> std::optional<Step> {
         if (result != LssResult::done) return std::nullopt;
         switch (state->stage) {
           case Stage::scan:
             if (state->node > 127) return std::nullopt;
             state->stage = Stage::set_node;
             return Step{.begin = set_node};
           case Stage::set_node:
             state->stage = stores ? Stage::store : Stage::waiting;
             return stores ? Step{.begin = store} : Step{.begin = waiting};
           case Stage::store: state->stage = Stage::waiting; return Step{.begin = waiting};
           case Stage::waiting: break;
         }
         ++state->node;
         ++state->found;
         state->stage = Stage::scan;
         return Step{.begin = scan};
       },
       .done =
           [this, state, first = given[1]](LssResult result, const LssMaster& master, can::Time when) {
             if (state->stage == Stage::scan && result == LssResult::silence) {
               answer(fmt::format("OK, found {} nodes starting at node ID {}.", state->found, first));
               return goes_on(when);
             }
             if (state->stage == Stage::scan && result == LssResult::done) {  // no node-ID is left for it
               answer(GatewayError::unsupported_node);
               return goes_on(when);
             }
             lss_answer(
                 result, master,
                 state->stage == Stage::set_node ? lss::command::configure_node_id : lss::command::store, {},
                 when);
           },
       .time_out = std::chrono::milliseconds(given[0])},
      now, false);
}

}  // namespace canopus::client
