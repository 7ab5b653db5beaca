#include "canopus/client/gateway/gateway.hpp"

#include <algorithm>
#include <deque>
#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace canopus::client {

using canopen::AbortCode;
using canopen::NmtState;

/// The transfers with one node, the first one running.
struct Gateway::Channel final : canopen::SdoClientListener {
  struct Job {
    Ticket ticket;
    Transfer transfer;
  };

  Channel(can::Sink& bus, std::uint8_t node) : client(bus) {
    client.set_server(node);
    client.set_maximum_size(longest_value);
  }
  void start(can::Time now) {
    while (!jobs.empty() && !client.busy()) {
      const Transfer& next = jobs.front().transfer;
      const auto mode = next.block ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented;
      const bool started =
          next.value ? client.download(next.index, next.sub, *next.value, *this, now, next.time_out, mode)
                     : client.upload(next.index, next.sub, *this, now, next.time_out, mode);
      if (started) return;
      finish({.code = AbortCode::general}, now);
    }
  }
  void sdo_finished(canopen::SdoClient&, can::Time now) override {
    const std::vector<std::uint8_t> bytes(client.data().begin(), client.data().end());
    finish({client.abort_code(), bytes, client.is_size_indicated(), client.short_answer()}, now);
    start(now);
  }
  void finish(const Answer& answer, can::Time now) {
    if (jobs.empty()) return;
    const Job job = std::move(jobs.front());
    jobs.pop_front();
    if (job.transfer.done) job.transfer.done(answer, now);
  }

  canopen::SdoClient client;
  std::deque<Job> jobs;
};

Gateway::Gateway(can::Sink& bus, std::uint8_t node_id, std::string version)
    : bus_(bus), node_id_(node_id), version_(std::move(version)), pdos_(bus_, *this), lss_(bus_) {
  for (can::Alarm* part : {&pdos_.alarm(), &lss_.alarm(), &next_heartbeat_, &next_watch_})
    alarm().add_part(*part);
}

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
  if (channel == nullptr) {
    channel = std::make_unique<Channel>(bus_, transfer.node);
    alarm().add_part(channel->client.alarm());
  }
  const Ticket ticket = ++last_ticket_;
  channel->jobs.push_back({ticket, std::move(transfer)});
  channel->start(now);
  return ticket;
}

void Gateway::call_off(Ticket ticket, can::Time now) {
  pdos_.call_off(ticket);
  lss_.call_off(ticket, now);
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
  NmtState state{};  // a reset is no state to stay in
  if (command == canopen::NmtCommand::start) state = NmtState::operational;
  if (command == canopen::NmtCommand::stop) state = NmtState::stopped;
  if (command == canopen::NmtCommand::enter_pre_operational) state = NmtState::pre_operational;
  if (node == 0) commanded_.fill(static_cast<std::uint8_t>(state));
  commanded_[node] = static_cast<std::uint8_t>(state);
  return bus_.send(can::data_frame(canopen::cob_id::nmt, {static_cast<std::uint8_t>(command), node}));
}

void Gateway::watch_heartbeat(std::uint8_t node, can::Duration time, can::Time) {
  if (time.count() == 0) {
    watches_.erase(node);
  } else {
    watches_[node] = {.time = time};  // from the first heartbeat on [CiA 301 7.2.8.2.2.2]
  }
  set_watch_alarm();
}

void Gateway::watch_guarding(std::uint8_t node, can::Duration time, unsigned factor, can::Time now) {
  if (time.count() == 0) {
    watches_.erase(node);
  } else {
    watches_[node] = {.time = time, .factor = std::max(1U, factor), .heard = now, .deadline = now};
  }
  set_watch_alarm();
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
  set_watch_alarm();
  if (!std::exchange(watch.alive, true) && watch.factor == 0)
    node_event(node, GatewayError::heartbeat_started);
  watch.lost = watch.asked = watch.missed = false;
  const std::uint8_t before = std::exchange(watch.state, state);
  if (before == state) return;
  const std::string_view name = state == 4 ? "STOP" : state == 5 ? "OPER" : state == 0x7F ? "PREO" : "";
  if (!name.empty()) event(fmt::format("{} {} ERRORx {}", network, node, name));
  // It was where its last command had sent it, and left by itself.
  if (commanded_[node] != 0 && before == commanded_[node]) node_event(node, GatewayError::wrong_state);
}

void Gateway::check_node(unsigned node, can::Time now) {
  Watch& watch = watches_[node];
  if (watch.factor == 0) {
    watch.deadline = can::never;
    set_watch_alarm();
    watch.alive = false;
    watch.state = 0xFF;
    return node_event(node, GatewayError::heartbeat_lost);
  }
  watch.deadline = now + watch.time;
  set_watch_alarm();
  const bool missed = std::exchange(watch.asked, true);
  (void)bus_.send(can::remote_frame(canopen::cob_id::error_control + node, 1));
  if (missed && !std::exchange(watch.missed, true)) node_event(node, GatewayError::guarding_lost);
  if (watch.lost || now - watch.heard < watch.time * watch.factor) return;
  watch.lost = true;
  watch.state = 0xFF;
  node_event(node, GatewayError::connection_lost);
}

// --- PDO, LSS

void Gateway::pdo_received(unsigned number, const GatewayPdo& pdo) {
  event(fmt::format("{} pdo {} {}", network, number, show_pdo_values(pdo)));
}

std::optional<Gateway::Ticket> Gateway::request_pdo(unsigned number, GatewayPdos::Done done) {
  const Ticket ticket = ++last_ticket_;
  if (pdos_.request(number, ticket, std::move(done)) != GatewayError::none) return std::nullopt;
  return ticket;
}

Gateway::Ticket Gateway::lss(GatewayLss::Request request, can::Time now) {
  const Ticket ticket = ++last_ticket_;
  lss_.request(ticket, std::move(request), now);
  return ticket;
}

// --- the controller

std::expected<void, std::string> Gateway::restart(std::uint32_t bit_rate) {
  if (!restart_) return std::unexpected("the bit rate of this bus is not set from here");
  return restart_(bit_rate);
}

void Gateway::reset(can::Time now) {
  watches_.clear();
  set_watch_alarm();
  commanded_ = {};
  pdos_.clear();
  next_heartbeat_ = can::never;
  bus_.silent = false;
  // A client may start another command in the callback of an ended one.
  std::vector<Channel::Job> ended;
  for (const auto& channel : channels_) {
    if (channel == nullptr) continue;
    if (channel->client.busy()) channel->client.cancel(AbortCode::general);
    std::ranges::move(channel->jobs, std::back_inserter(ended));
    channel->jobs.clear();
  }
  if (node_id_ != 0) (void)bus_.send(can::data_frame(canopen::cob_id::error_control + node_id_, {0}));
  for (const Channel::Job& job : ended) {
    if (job.transfer.done) job.transfer.done({.code = AbortCode::local_control}, now);
  }
  lss_.clear(now);
}

// --- can::Participant

void Gateway::receive(const can::Frame& frame, can::Time now) {
  pdos_.receive(frame, now);
  if (frame.extended) return;
  lss_.receive(frame, now);
  const std::uint32_t function = frame.identifier & 0x780U;
  const unsigned node = frame.identifier & 0x7FU;
  if (function == canopen::cob_id::sdo_response && channels_[node] != nullptr)
    channels_[node]->client.receive(frame, now);
  if (function == canopen::cob_id::error_control && node != 0) error_control(node, frame, now);
  if (function == canopen::cob_id::emcy && node != 0 && !frame.remote && frame.length() == 8) {
    const auto& data = frame.data;
    event(fmt::format("{} {} EMCY {:04X} {:02X} {} {} {} {} {}", network, node, data[0] | data[1] << 8,
                      data[2], data[3], data[4], data[5], data[6], data[7]));
  }
}

void Gateway::tick(can::Time now) {
  for (const auto& channel : channels_) {
    if (channel != nullptr && channel->client.deadline() <= now) channel->client.tick(now);
  }
  pdos_.tick(now);
  lss_.tick(now);
  std::vector<unsigned> due;
  for (const auto& [node, watch] : watches_) {
    if (watch.deadline <= now) due.push_back(node);
  }
  for (const unsigned node : due) check_node(node, now);
  if (next_heartbeat_ <= now) {
    next_heartbeat_ = now + heartbeat_;
    const auto state = static_cast<std::uint8_t>(NmtState::operational);
    if (node_id_ != 0) (void)bus_.send(can::data_frame(canopen::cob_id::error_control + node_id_, {state}));
  }
}

void Gateway::set_watch_alarm() {
  can::Time first = can::never;
  for (const auto& [node, watch] : watches_) first = std::min(first, watch.deadline);
  next_watch_ = first;
}

}  // namespace canopus::client
