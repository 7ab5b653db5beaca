// SDO: frames, and transfers folded into one message.

#include <utility>

#include <fmt/format.h>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/decode/decoder_channel.hpp"
#include "canopus/trace/decode/value_text.hpp"

namespace canopus::trace {
namespace {

/// "6000:01 'Position value'".
std::string named_object(std::uint16_t index, std::uint8_t sub, std::string_view name) {
  return canopen::object_text(index, sub) + (name.empty() ? "" : fmt::format(" '{}'", name));
}

std::string abort_text(std::uint32_t code) {
  return fmt::format("{:08X}H {}", code, canopen::describe(static_cast<canopen::AbortCode>(code)));
}

/// An expedited value without a stated length has as many bytes as its type.
void cut_to_type(std::vector<std::uint8_t>& data, bool length_unstated, canopen::DataType type) {
  const unsigned length = canopen::byte_length(type);
  if (length_unstated && length != 0 && length < data.size()) data.resize(length);
}

std::string frame_text(const SdoFrame& frame, std::string_view object, canopen::DataType type,
                       bool has_whole_value) {
  std::string text(frame.kind);
  if (!object.empty()) text += fmt::format(" {}", object);
  if (frame.sequence) text += fmt::format(", number {}", *frame.sequence);
  if (frame.toggle) text += fmt::format(", toggle {}", *frame.toggle ? 1 : 0);
  if (frame.size) text += fmt::format(", {} bytes", *frame.size);
  if (frame.block_size) text += fmt::format(", block size {}", *frame.block_size);
  if (frame.last) text += ", last";
  if (frame.abort_code) text += ": " + abort_text(*frame.abort_code);
  if (!frame.data.empty()) {
    text += ": " + (has_whole_value ? object_value_text(*frame.index, frame.sub, frame.data, type)
                                    : hexadecimal(frame.data));
  }
  return text;
}

std::string end_text(const SdoTransfer& transfer, const std::string& took) {
  switch (transfer.end) {
    case TransferEnd::aborted:
      return fmt::format("aborted by the {} after {}: {}", transfer.aborted_by_client ? "client" : "server",
                         took, abort_text(transfer.abort_code.value_or(0)));
    case TransferEnd::unanswered: return "no answer";
    case TransferEnd::unfinished:
      return fmt::format("unfinished after {} bytes in {} frames, {}", transfer.size, transfer.frames, took);
    case TransferEnd::overtaken:
      return fmt::format("overtaken by another request after {} bytes in {} frames, {}", transfer.size,
                         transfer.frames, took);
    case TransferEnd::done: break;
  }
  return {};
}

std::string value_and_facts(const SdoTransfer& transfer, canopen::DataType type, const std::string& took) {
  std::string facts;
  if (type != canopen::DataType::none) facts = fmt::format("{}, ", eds::name(type));
  const bool has_fixed_length =
      canopen::byte_length(type) != 0 && canopen::byte_length(type) == transfer.size;
  if (!has_fixed_length) facts += fmt::format("{} byte{}, ", transfer.size, transfer.size == 1 ? "" : "s");
  if (transfer.is_block) facts += "block transfer, ";
  std::string note;
  if (transfer.announced && *transfer.announced != transfer.size)
    note = fmt::format("; {} bytes were announced", *transfer.announced);
  return fmt::format("{} ({}{}){}", object_value_text(transfer.index, transfer.sub, transfer.data, type),
                     facts, took, note);
}

}  // namespace

void Decoder::receive_sdo(Channel& channel, Message& message, const SdoSide& side, const Sink& sink) {
  message.service = Service::sdo;
  message.node = side.server;
  name_node(channel, message);
  const auto bytes = message.frame.bytes();
  if (bytes.size() != 8) {
    message.kind = "malformed";
    message.data.assign(bytes.begin(), bytes.end());
    message.text = fmt::format("{} bytes, expected 8: {}", bytes.size(), hexadecimal(bytes));
    if (options_.frames) sink(message);
    return;
  }
  SdoFollower& follower = channel.sdo[std::uint32_t{side.server} << 24 | side.channel];
  SdoFollower::Step step = follower.follow(message.frame, side.from_client, message.time);
  if (options_.frames) {
    const SdoFrame& frame = step.frame;
    message.kind = frame.kind;
    message.data = frame.data;
    message.abort_code = frame.abort_code;
    message.index = frame.index;
    message.sub = frame.sub;
    std::string object;
    canopen::DataType type = canopen::DataType::none;
    if (frame.index) {
      const ObjectFacts& facts = channel.facts(side.server, *frame.index, frame.sub);
      message.object_name = facts.name;
      type = facts.type;
      object = named_object(*frame.index, frame.sub, facts.name);
    }
    const bool whole = frame.kind == "download request" || frame.kind == "upload response";
    SdoFrame shown = frame;
    if (whole) cut_to_type(shown.data, frame.length_unstated, type);
    message.text = frame_text(shown, object, type, whole);
  }
  Message at = message;
  if (options_.frames) sink(message);
  if (step.overtaken) {
    at.time = step.overtaken->last;
    emit_transfer(channel, side.server, at, std::move(*step.overtaken), sink);
    at.time = message.time;
  }
  if (step.ended) emit_transfer(channel, side.server, at, std::move(*step.ended), sink);
}

void Decoder::emit_transfer(Channel& channel, std::uint8_t server, const Message& at, SdoTransfer transfer,
                            const Sink& sink) {
  const ObjectFacts facts =
      transfer.is_joined ? ObjectFacts{} : channel.facts(server, transfer.index, transfer.sub);
  const std::size_t before = transfer.data.size();
  cut_to_type(transfer.data, transfer.length_unstated, facts.type);
  transfer.size -= before - transfer.data.size();
  if (transfer.end == TransferEnd::done && !transfer.is_joined && transfer.size >= 1 && transfer.size <= 4) {
    channel.knowledge.learn(server, transfer.index, transfer.sub, can::load_u32(transfer.data));
  }
  if (!options_.transfers) return;
  Message message{.time = at.time, .channel = at.channel, .frame = at.frame};
  message.service = Service::sdo;
  message.kind = transfer.is_read ? "read" : "write";
  message.node = server;
  name_node(channel, message);
  if (!transfer.is_joined) message.index = transfer.index;
  message.sub = transfer.sub;
  message.object_name = facts.name;
  message.abort_code = transfer.abort_code;
  message.is_transfer = true;
  message.is_read = transfer.is_read;
  message.end = transfer.end;
  message.size = transfer.size;
  message.frames = transfer.frames;
  message.duration = transfer.last - transfer.begin;
  const std::string took = duration_text(message.duration.count());
  const std::string object = transfer.is_joined ? "unknown object, begun before the trace,"
                                                : named_object(transfer.index, transfer.sub, facts.name);
  message.text = fmt::format("{} {}: {}", object, message.kind,
                             transfer.end == TransferEnd::done ? value_and_facts(transfer, facts.type, took)
                                                               : end_text(transfer, took));
  message.data = std::move(transfer.data);
  sink(message);
}

}  // namespace canopus::trace
