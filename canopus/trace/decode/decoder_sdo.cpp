// SDO: frames, and transfers folded into one message.

#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/decode/decoder_channel.hpp"
#include "canopus/trace/decode/value_text.hpp"
#include "canopus/trace/decode/value_words.hpp"

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
  if (frame.expected_toggle) text += fmt::format(", expected {}", *frame.expected_toggle ? 1 : 0);
  if (frame.size) text += ", " + ascii::counted(*frame.size, "byte");
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
    case TransferEnd::unanswered:
      return transfer.short_answer ? fmt::format("no valid answer: one of {}, expected 8",
                                                 ascii::counted(*transfer.short_answer, "byte"))
                                   : "no answer";
    case TransferEnd::unfinished:
      return fmt::format("unfinished after {} in {}, {}", ascii::counted(transfer.size, "byte"),
                         ascii::counted(transfer.frames, "frame"), took);
    case TransferEnd::overtaken:
      return fmt::format("overtaken by another request after {} in {}, {}",
                         ascii::counted(transfer.size, "byte"), ascii::counted(transfer.frames, "frame"),
                         took);
    case TransferEnd::done: break;
  }
  return {};
}

/// The value with its unit, and in words what it has in words.
std::string value_in_words(const SdoTransfer& transfer, canopen::DataType type,
                           const canopen::DictionaryDescription* dictionary) {
  std::string text = object_value_text(transfer.index, transfer.sub, transfer.data, type);
  if (transfer.data.empty() || transfer.data.size() > 8) return text;
  if (object_unit(transfer.index, transfer.sub).empty()) {
    const std::string_view unit = value_unit(dictionary, transfer.index, transfer.sub);
    if (!unit.empty()) text += fmt::format(" {}", unit);
  }
  const ValueWords words =
      value_words(dictionary, transfer.index, transfer.sub, can::load_value(transfer.data));
  return words.empty() ? text : text + " " + words.text();
}

std::string value_and_facts(const SdoTransfer& transfer, canopen::DataType type, const std::string& took,
                            const canopen::DictionaryDescription* dictionary) {
  std::string facts;
  if (type != canopen::DataType::none) facts = fmt::format("{}, ", eds::name(type));
  const bool has_fixed_length =
      canopen::byte_length(type) != 0 && canopen::byte_length(type) == transfer.size;
  if (!has_fixed_length) facts += ascii::counted(transfer.size, "byte") + ", ";
  if (transfer.is_block) facts += "block transfer, ";
  std::string note;
  if (transfer.announced && *transfer.announced != transfer.size)
    note = fmt::format("; {} announced", ascii::counted(*transfer.announced, "byte"));
  return fmt::format("{} ({}{}){}", value_in_words(transfer, type, dictionary), facts, took, note);
}

}  // namespace

void Decoder::receive_sdo(Channel& channel, Message& message, const SdoSide& side, const Sink& sink) {
  message.service = Service::sdo;
  message.node = side.server;
  name_node(channel, message);
  SdoChannel& sdo = channel.sdo[std::uint32_t{side.server} << 24 | side.channel];
  const auto bytes = message.frame.bytes();
  if (bytes.size() != 8) {
    message.kind = "malformed";
    message.is_malformed = true;
    message.data.assign(bytes.begin(), bytes.end());
    message.text =
        fmt::format("{}, expected 8: {}", ascii::counted(bytes.size(), "byte"), hexadecimal(bytes));
    if (!side.from_client) sdo.note_short_answer(bytes);
    return sink(message);
  }
  SdoFollower::Step step = sdo.follow(message.frame, side.from_client, message.time);
  message.is_malformed = step.frame.expected_toggle.has_value();
  const bool is_shown = options_.frames || message.is_malformed;
  if (is_shown) {
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
  if (is_shown) sink(message);
  if (step.overtaken) {
    at.time = step.overtaken->last;
    emit_transfer(channel, side.server, at, std::move(*step.overtaken), sink);
    at.time = message.time;
  }
  if (step.ended) emit_transfer(channel, side.server, at, std::move(*step.ended), sink);
}

void Decoder::emit_transfer(Channel& channel, std::uint8_t server, const Message& at, SdoTransfer transfer,
                            const Sink& sink) {
  const NodeDescription* const node = channel.knowledge.node(server);
  const canopen::DictionaryDescription* const dictionary = node == nullptr ? nullptr : node->dictionary.get();
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
  message.text =
      fmt::format("{} {}: {}", object, message.kind,
                  transfer.end == TransferEnd::done ? value_and_facts(transfer, facts.type, took, dictionary)
                                                    : end_text(transfer, took));
  message.data = std::move(transfer.data);
  sink(message);
}

}  // namespace canopus::trace
