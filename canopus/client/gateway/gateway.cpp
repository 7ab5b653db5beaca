#include "canopus/client/gateway/gateway.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace canopus::client {

using canopen::AbortCode;
using canopen::NmtState;

/// The transfers with one node, the first one running.
struct Gateway::Channel final : canopen::SdoClientUser {
  struct Job {
    Ticket ticket;
    Transfer transfer;
  };

  Channel(can::Sink& bus, std::uint8_t node) : client(bus) { client.set_server(node); }
  void start(can::Time now) {
    while (!jobs.empty() && !client.busy()) {
      const Transfer& next = jobs.front().transfer;
      const auto mode = next.block ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented;
      const bool started =
          next.value ? client.download(next.index, next.sub, *next.value, *this, now, next.time_out, mode)
                     : client.upload(next.index, next.sub, *this, now, next.time_out, mode);
      if (started) return;
      finish(AbortCode::general, {}, now);
    }
  }
  void sdo_finished(canopen::SdoClient&, can::Time now) override {
    const std::vector<std::uint8_t> bytes(client.data().begin(), client.data().end());
    finish(client.abort_code(), bytes, now);
    start(now);
  }
  void finish(AbortCode code, std::span<const std::uint8_t> bytes, can::Time now) {
    if (jobs.empty()) return;
    const Job job = std::move(jobs.front());
    jobs.pop_front();
    if (job.transfer.done) job.transfer.done(code, bytes, now);
  }

  canopen::SdoClient client;
  std::deque<Job> jobs;
};

std::string_view describe(GatewayError error) noexcept {
  switch (error) {
    case GatewayError::none: return "no error";
    case GatewayError::not_supported: return "request not supported";
    case GatewayError::syntax: return "syntax error";
    case GatewayError::state: return "request not processed due to the internal state";
    case GatewayError::time_out: return "time-out";
    case GatewayError::no_network: return "no default network set";
    case GatewayError::no_node: return "no default node set";
    case GatewayError::unsupported_network: return "unsupported network";
    case GatewayError::unsupported_node: return "unsupported node";
    case GatewayError::guarding_lost: return "lost guarding message";
    case GatewayError::heartbeat_started: return "heartbeat started";
    case GatewayError::heartbeat_lost: return "heartbeat lost";
    case GatewayError::error_passive: return "error passive";
    case GatewayError::bus_off: return "bus-off";
    case GatewayError::pdo_length: return "PDO length exceeded";
  }
  return "error";
}

Gateway::Gateway(can::Sink& bus, std::uint8_t node_id, std::string version)
    : bus_(bus), node_id_(node_id), version_(std::move(version)) {}

Gateway::~Gateway() {
  for (const auto& channel : channels_) {
    if (channel != nullptr && channel->client.busy()) channel->client.cancel(AbortCode::general);
  }
}

void Gateway::event(std::string_view line, bool boot_up) {
  const auto listeners = listeners_;
  for (GatewayListener* listener : listeners) listener->gateway_event(line, boot_up);
}

void Gateway::node_event(unsigned node, GatewayError error) {
  event(fmt::format("{} {} ERROR {} #{}", network, node, static_cast<unsigned>(error), describe(error)));
}

void Gateway::controller_error(GatewayError error) {
  event(fmt::format("{} ERROR {} #{}", network, static_cast<unsigned>(error), describe(error)));
}

// --- SDO

Gateway::Ticket Gateway::transfer(Transfer transfer, can::Time now) {
  auto& channel = channels_.at(transfer.node);
  if (channel == nullptr) channel = std::make_unique<Channel>(bus_, transfer.node);
  const Ticket ticket = ++last_ticket_;
  channel->jobs.push_back({ticket, std::move(transfer)});
  channel->start(now);
  return ticket;
}

void Gateway::call_off(Ticket ticket, can::Time now) {
  for (const auto& channel : channels_) {
    if (channel == nullptr) continue;
    const auto job = std::ranges::find(channel->jobs, ticket, &Channel::Job::ticket);
    if (job == channel->jobs.end()) continue;
    const bool runs = job == channel->jobs.begin() && channel->client.busy();
    if (runs) channel->client.cancel(AbortCode::timed_out);
    channel->jobs.erase(job);
    if (runs) channel->start(now);
    return;
  }
}

// --- NMT

bool Gateway::command(canopen::NmtCommand command, std::uint8_t node) {
  return bus_.send(can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(command), node}));
}

void Gateway::watch_heartbeat(std::uint8_t node, can::Duration time, can::Time) {
  if (time.count() == 0) {
    watches_.erase(node);
  } else {
    watches_[node] = {.time = time};  // from the first heartbeat on [CiA 301 7.2.8.2.2.2]
  }
}

void Gateway::watch_guarding(std::uint8_t node, can::Duration time, unsigned factor, can::Time now) {
  if (time.count() == 0) {
    watches_.erase(node);
  } else {
    watches_[node] = {.time = time, .factor = std::max(1U, factor), .heard = now, .deadline = now};
  }
}

void Gateway::set_heartbeat(can::Duration period, can::Time now) {
  heartbeat_ = period;
  next_heartbeat_ = period.count() == 0 ? can::never : now;
}

void Gateway::error_control(unsigned node, const can::Frame& frame, can::Time now) {
  if (frame.remote || frame.length() != 1) return;
  const auto watch = watches_.find(node);
  const bool guarded = watch != watches_.end() && watch->second.factor != 0;
  const auto state = static_cast<std::uint8_t>(frame.data[0] & (guarded ? 0x7FU : 0xFFU));
  if (frame.data[0] == 0) event(fmt::format("{} {} BOOT_UP", network, node), true);
  if (watch != watches_.end()) watched(node, state, now);
}

void Gateway::watched(unsigned node, std::uint8_t state, can::Time now) {
  Watch& watch = watches_[node];
  watch.heard = now;
  if (watch.factor == 0) watch.deadline = now + watch.time;
  if (!std::exchange(watch.alive, true) && watch.factor == 0)
    node_event(node, GatewayError::heartbeat_started);
  watch.lost = false;
  if (std::exchange(watch.state, state) == state) return;
  const std::string_view name = state == 4 ? "STOP" : state == 5 ? "OPER" : state == 0x7F ? "PREO" : "";
  if (!name.empty()) event(fmt::format("{} {} ERRORx {}", network, node, name));
}

void Gateway::look_at(unsigned node, can::Time now) {
  Watch& watch = watches_[node];
  if (watch.factor == 0) {
    watch.deadline = can::never;
    watch.alive = false;
    watch.state = 0xFF;
    return node_event(node, GatewayError::heartbeat_lost);
  }
  watch.deadline = now + watch.time;
  (void)bus_.send(can::remote_frame(canopen::cob_id::error_control + node, 1));
  if (watch.lost || now - watch.heard < watch.time * watch.factor) return;
  watch.lost = true;
  watch.state = 0xFF;
  node_event(node, GatewayError::guarding_lost);
}

// --- PDO

GatewayError Gateway::set(Pdos& pdos, unsigned number, GatewayPdo pdo) {
  if (number == 0 || number > most_pdos) return GatewayError::syntax;
  unsigned bits = 0;
  for (const GatewayType& type : pdo.types) bits += type.bits;
  if (bits > 64) return GatewayError::pdo_length;
  pdos[number] = std::move(pdo);
  return GatewayError::none;
}

const GatewayPdo* Gateway::rpdo(unsigned number) const {
  const auto pdo = rpdos_.find(number);
  return pdo == rpdos_.end() ? nullptr : &pdo->second;
}

GatewayError Gateway::write_pdo(unsigned number, std::span<const std::uint64_t> values) {
  const auto found = tpdos_.find(number);
  if (found == tpdos_.end()) return GatewayError::state;
  GatewayPdo& pdo = found->second;
  if (values.size() != pdo.types.size()) return GatewayError::pdo_length;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const unsigned bits = pdo.types[i].bits;
    if (bits < 64 && values[i] >> bits != 0) return GatewayError::pdo_length;
  }
  pdo.values.emplace(values.begin(), values.end());
  if (pdo.sync != 0) {
    pdo.waits = true;
    pdo.syncs = 0;
    return GatewayError::none;
  }
  return send_tpdo(pdo) ? GatewayError::none : GatewayError::state;
}

bool Gateway::send_tpdo(const GatewayPdo& pdo) {
  std::uint64_t word = 0;
  unsigned place = 0;
  for (std::size_t i = 0; i < pdo.types.size(); ++i) {
    if (place < 64) word |= (*pdo.values)[i] << place;
    place += pdo.types[i].bits;
  }
  can::Frame frame{.identifier = pdo.cob_id, .dlc = static_cast<std::uint8_t>((place + 7) / 8)};
  for (std::size_t i = 0; i < frame.length(); ++i) frame.data[i] = static_cast<std::uint8_t>(word >> (8 * i));
  return bus_.send(frame);
}

void Gateway::take_pdo(const can::Frame& frame) {
  for (auto& [number, pdo] : rpdos_) {
    if (pdo.cob_id != frame.identifier) continue;
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < frame.length(); ++i) word |= std::uint64_t{frame.data[i]} << (8 * i);
    std::vector<std::uint64_t> values;
    unsigned place = 0;
    for (const GatewayType& type : pdo.types) {
      const std::uint64_t mask = type.bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << type.bits) - 1;
      values.push_back(place < 64 ? word >> place & mask : 0);
      place += type.bits;
    }
    if (place > 8 * frame.length()) {
      controller_error(GatewayError::pdo_length);
      continue;
    }
    pdo.values = std::move(values);
    if (pdo.sync == 0) {
      show_rpdo(number, pdo);
    } else {
      pdo.waits = true;
    }
  }
}

void Gateway::sync() {
  for (auto& [number, pdo] : rpdos_) {
    if (!pdo.waits || ++pdo.syncs < pdo.sync) continue;
    pdo.waits = false;
    pdo.syncs = 0;
    show_rpdo(number, pdo);
  }
  for (auto& [number, pdo] : tpdos_) {
    if (!pdo.waits || ++pdo.syncs < pdo.sync) continue;
    pdo.waits = false;
    pdo.syncs = 0;
    (void)send_tpdo(pdo);
  }
}

std::string show_pdo_values(const GatewayPdo& pdo) {
  std::string text = fmt::format("{}", pdo.types.size());
  if (pdo.values) {
    for (const std::uint64_t value : *pdo.values) text += fmt::format(" 0x{:x}", value);
  }
  return text;
}

void Gateway::show_rpdo(unsigned number, const GatewayPdo& pdo) {
  event(fmt::format("{} pdo {} {}", network, number, show_pdo_values(pdo)));
}

// --- can::Participant

void Gateway::receive(const can::Frame& frame, can::Time now) {
  if (frame.extended) return;
  const std::uint32_t function = frame.identifier & 0x780U;
  const unsigned node = frame.identifier & 0x7FU;
  if (frame.identifier == canopen::cob_id::sync && !frame.remote) sync();
  if (function == canopen::cob_id::sdo_response && channels_[node] != nullptr)
    channels_[node]->client.receive(frame, now);
  if (function == canopen::cob_id::error_control && node != 0) error_control(node, frame, now);
  if (function == canopen::cob_id::emcy && node != 0 && !frame.remote && frame.length() == 8) {
    const auto& data = frame.data;
    event(fmt::format("{} {} EMCY {:04X} {:02X} {} {} {} {} {}", network, node, data[0] | data[1] << 8,
                      data[2], data[3], data[4], data[5], data[6], data[7]));
  }
  if (!frame.remote) take_pdo(frame);
}

void Gateway::tick(can::Time now) {
  for (const auto& channel : channels_) {
    if (channel != nullptr && channel->client.deadline() <= now) channel->client.tick(now);
  }
  std::vector<unsigned> due;
  for (const auto& [node, watch] : watches_) {
    if (watch.deadline <= now) due.push_back(node);
  }
  for (const unsigned node : due) look_at(node, now);
  if (next_heartbeat_ <= now) {
    next_heartbeat_ = now + heartbeat_;
    const auto state = static_cast<std::uint8_t>(NmtState::operational);
    if (node_id_ != 0) (void)bus_.send(can::data_frame(canopen::cob_id::error_control + node_id_, {state}));
  }
}

can::Time Gateway::deadline() const noexcept {
  can::Time first = next_heartbeat_;
  for (const auto& channel : channels_) {
    if (channel != nullptr) first = std::min(first, channel->client.deadline());
  }
  for (const auto& [node, watch] : watches_) first = std::min(first, watch.deadline);
  return first;
}

}  // namespace canopus::client
