#include "canopus/trace/decode/decoder.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/trace/decode/decoder_channel.hpp"
#include "canopus/trace/decode/service_text.hpp"
#include "canopus/trace/decode/value_text.hpp"

namespace canopus::trace {
namespace {

using namespace std::chrono_literals;

/// A frame that the recorder sent is received again within this time, if at all.
constexpr can::Duration echo_time = 10ms;
constexpr std::size_t most_echoes = 64;

constexpr std::uint32_t lss_slave = 0x7E4, lss_master = 0x7E5, failsafe = 0x001;

/// "5 bytes, expected 8".
void malformed(Message& message, std::string_view expected) {
  message.kind = "malformed";
  message.is_malformed = true;
  message.text = fmt::format("{}, expected {}: {}", ascii::counted(message.frame.length(), "byte"), expected,
                             hexadecimal(message.frame.bytes()));
}

void copy_data(Message& message) {
  const auto bytes = message.frame.bytes();
  message.data.assign(bytes.begin(), bytes.end());
}

void decode_layer2(Message& message) {
  message.service = Service::layer2;
  message.kind = message.frame.remote ? "remote frame" : "frame";
  copy_data(message);
  message.text = message.frame.remote ? "remote frame, asks for " + ascii::counted(message.frame.dlc, "byte")
                                      : hexadecimal(message.frame.bytes());
}

void decode_sync(Message& message) {
  message.service = Service::sync;
  message.kind = "SYNC";
  copy_data(message);
  if (message.data.size() == 1) message.text = fmt::format("counter {}", message.data[0]);
  if (message.data.size() > 1) malformed(message, "0 or 1");
}

void decode_time(Message& message) {
  message.service = Service::time;
  message.kind = "TIME";
  copy_data(message);
  if (message.data.size() < 6) return malformed(message, "6");
  message.text =
      value_text(std::span(message.data).first(6), canopen::DataType::time_of_day) + " since 1984-01-01";
}

void decode_lss(Message& message) {
  message.service = Service::lss;
  copy_data(message);
  if (message.data.size() != 8) return malformed(message, "8");
  LssText text = lss_text(message.frame, message.frame.identifier == lss_master);
  message.kind = text.kind;
  message.text = std::move(text.text);
}

void decode_flying_master(Message& message) {
  message.service = Service::flying_master;
  message.kind = flying_master_name(message.frame.identifier);
  copy_data(message);
  message.text = message.kind;
  if (message.frame.identifier == 0x071 && message.data.size() < 2) {
    malformed(message, "2");
  } else if (message.frame.identifier == 0x071) {
    message.node = message.data[1] & 0x7FU;
    message.text += fmt::format(": node {}, priority level {}", message.data[1], message.data[0]);
  } else if (!message.data.empty()) {
    message.text += ": " + hexadecimal(message.data);
  }
}

void decode_error_frame(Message& message) {
  message.service = Service::error_frame;
  message.kind = "error frame";
  copy_data(message);
  message.text = error_frame_text(message.frame);
}

}  // namespace

Decoder::Decoder(Names names, DecoderOptions options) : names_(std::move(names)), options_(options) {}
Decoder::~Decoder() = default;

const BusKnowledge* Decoder::knowledge(std::uint16_t channel) const {
  const auto found = channels_.find(channel);
  return found == channels_.end() ? nullptr : &found->second->knowledge;
}

Decoder::Channel& Decoder::channel_of(const TraceRecord& record, std::string_view name) {
  auto& channel = channels_[record.channel];
  if (!channel) {
    channel = std::make_unique<Channel>(names_.on_channel(name));
    channel->number = record.channel;
  }
  return *channel;
}

void Decoder::name_node(const Channel& channel, Message& message) const {
  if (const NodeDescription* const node = channel.knowledge.node(message.node))
    message.node_name = node->name;
}

bool Decoder::is_copy(Channel& channel, const TraceRecord& record, const Sink& sink) {
  while (!channel.sent.empty() &&
         (record.time - channel.sent.front().time > echo_time || channel.sent.size() > most_echoes)) {
    channel.sent.pop_front();
  }
  if (record.transmitted) return false;
  const auto original =
      std::ranges::find_if(channel.sent, [&](const Message& sent) { return sent.frame == record.frame; });
  if (original == channel.sent.end()) return false;
  Message copy = std::move(*original);
  channel.sent.erase(original);
  copy.time = record.time;
  copy.is_copy = true;
  if (options_.frames) sink(copy);
  return true;
}

void Decoder::receive(const TraceRecord& record, std::string_view channel_name, const Sink& sink) {
  Channel& channel = channel_of(record, channel_name);
  expire(channel, record.time, sink);
  if (!record.error_frame && is_copy(channel, record, sink)) return;
  Message message{.time = record.time, .channel = record.channel, .frame = record.frame};
  if (record.error_frame) {
    decode_error_frame(message);
    return sink(message);
  }
  const auto side = channel.knowledge.sdo(key_of(record.frame));
  if (side && !record.frame.remote) {
    receive_sdo(channel, message, *side, sink);
  } else {
    decode(channel, message);
    name_node(channel, message);
    sink(message);
  }
  if (record.transmitted) channel.sent.push_back(std::move(message));
}

void Decoder::decode(Channel& channel, Message& message) {
  const can::Frame& frame = message.frame;
  const FrameKey key = key_of(frame);
  const bool guards = !frame.extended && frame.identifier > 0x700 && frame.identifier < 0x780;
  if (guards) return decode_error_control(channel, message);
  if (!frame.remote && !frame.extended) {
    if (frame.identifier == canopen::cob_id::nmt) return decode_nmt(message);
    if (frame.identifier == failsafe) {
      decode_layer2(message);
      message.service = Service::failsafe;
      message.kind = "global failsafe command";
      return;
    }
    if (!flying_master_name(frame.identifier).empty()) return decode_flying_master(message);
    if (frame.identifier == lss_slave || frame.identifier == lss_master) return decode_lss(message);
  }
  if (!frame.remote) {
    if (channel.knowledge.is_sync(key)) return decode_sync(message);
    if (channel.knowledge.is_time(key)) return decode_time(message);
    if (const std::uint8_t producer = channel.knowledge.emcy_producer(key)) {
      message.node = producer;
      return decode_emcy(message);
    }
  }
  if (const PdoFacts* const pdo = channel.knowledge.pdo(key)) return decode_pdo(channel, message, *pdo);
  const auto node = static_cast<std::uint8_t>(key & 0x7FU);
  if (key >= 0x180 && key < 0x580 && node != 0) {
    const PdoFacts usual{.node = node,
                         .transmit = (key & 0x80U) != 0,
                         .number = static_cast<std::uint16_t>((key - 0x180U) / 0x100U + 1)};
    return decode_pdo(channel, message, usual);
  }
  decode_layer2(message);
}

void Decoder::decode_nmt(Message& message) const {
  message.service = Service::nmt;
  copy_data(message);
  message.kind = "command";
  if (message.data.size() != 2) return malformed(message, "2");
  message.node = message.data[1] & 0x7FU;
  const std::string_view command = nmt_command_name(message.data[0]);
  if (command.empty()) {
    message.kind = "unknown command";
    message.text = fmt::format("unknown command {:02X}H", message.data[0]);
  } else {
    message.kind = command;
    message.text = command;
  }
  if (message.data[1] > 127) message.text += fmt::format(", node-ID {}", message.data[1]);
}

void Decoder::decode_error_control(Channel& channel, Message& message) const {
  message.service = Service::error_control;
  message.node = message.frame.identifier & 0x7FU;
  if (message.frame.remote) {
    channel.guarded.set(message.node);
    message.kind = "guarding request";
    message.text = "guarding request";
    return;
  }
  copy_data(message);
  if (message.data.size() != 1) return malformed(message, "1");
  const std::uint8_t value = message.data[0];
  const auto state = canopen::name(static_cast<canopen::NmtState>(value & 0x7FU));
  if (value == 0) {
    message.kind = "boot-up";
    message.text = "boot-up";
    channel.guarded.reset(message.node);
    channel.toggles[message.node] = true;  // the first answer after it has 0 [CiA 301 7.2.8.3.2.1]
    return;
  }
  const bool answers = channel.guarded.test(message.node);
  channel.guarded.reset(message.node);
  message.kind = answers || value >= 0x80 ? "guarding answer" : "heartbeat";
  message.text =
      state == "unknown" ? fmt::format("unknown state {:02X}H", value & 0x7FU) : std::string(state);
  const bool toggle = value >= 0x80;
  if (message.kind != "guarding answer") {
    channel.toggles[message.node].reset();  // a heartbeat has no toggle bit
    return;
  }
  const auto before = std::exchange(channel.toggles[message.node], toggle);
  message.text += fmt::format(", toggle {}", toggle ? 1 : 0);
  if (before == toggle) {
    message.is_malformed = true;
    message.text += fmt::format(", expected {}: it does not alternate", toggle ? 0 : 1);
  }
}

void Decoder::decode_emcy(Message& message) const {
  message.service = Service::emcy;
  message.kind = "EMCY";
  copy_data(message);
  if (message.data.size() < 3) return malformed(message, "8");
  message.emcy_code = can::load_as<std::uint16_t>(message.data.data());
  message.text = emcy_text(message.frame);
  message.is_malformed = message.data.size() != 8;
  if (message.is_malformed)
    message.text += fmt::format(" ({}, expected 8)", ascii::counted(message.data.size(), "byte"));
}

void Decoder::expire(Channel& channel, can::Time now, const Sink& sink) {
  if (now < channel.next_expiry && channel.next_expiry - now < 2s) return;
  channel.next_expiry = can::later(now, 1s);
  for (auto& [place, sdo] : channel.sdo)
    emit_ended(channel, static_cast<std::uint8_t>(place >> 24), sdo.expire(now, options_.sdo_time_out), sink);
}

void Decoder::finish(const Sink& sink) {
  for (auto& [number, channel] : channels_) {
    for (auto& [place, sdo] : channel->sdo)
      emit_ended(*channel, static_cast<std::uint8_t>(place >> 24), sdo.give_up(), sink);
  }
}

void Decoder::emit_ended(Channel& channel, std::uint8_t server, std::vector<EndedSdoTransfer> ended,
                         const Sink& sink) {
  for (EndedSdoTransfer& one : ended) {
    const Message at{.time = one.transfer.last, .channel = channel.number, .frame = one.frame};
    emit_transfer(channel, server, at, std::move(one.transfer), sink);
  }
}

}  // namespace canopus::trace
