// PDOs and their values.

#include <algorithm>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/trace/decode/decoder.hpp"
#include "canopus/trace/decode/decoder_channel.hpp"
#include "canopus/trace/decode/value_text.hpp"
#include "canopus/trace/decode/value_words.hpp"

namespace canopus::trace {
namespace {

/// Data types 0001H.. fill bits of an RPDO that mean nothing.
constexpr bool is_dummy(std::uint16_t index) noexcept { return index < 0x0020; }

constexpr std::uint64_t bits_of(std::uint64_t raw, unsigned bits) noexcept {
  return bits < 64 ? raw & ((std::uint64_t{1} << bits) - 1) : raw;
}

/// A value of `bits` bits as its type has it: enough bytes for the type.
std::string signal_text(std::uint64_t raw, unsigned bits, canopen::DataType type) {
  std::array<std::uint8_t, 8> bytes{};
  can::store_value(bytes.data(), bits_of(raw, bits), 8);
  const unsigned natural = canopen::byte_length(type);
  const std::size_t length = natural != 0 ? natural : (bits + 7) / 8;
  return value_text(std::span(bytes).first(length), type);
}

}  // namespace

void Decoder::decode_pdo(Channel& channel, Message& message, const PdoFacts& pdo) {
  message.service = Service::pdo;
  message.node = pdo.node;
  message.pdo = pdo.number;
  message.kind = pdo.transmit ? "TPDO" : "RPDO";
  if (message.frame.remote) {
    message.kind = pdo.transmit ? "TPDO request" : "RPDO request";
    message.text = "remote request";
    return;
  }
  const auto bytes = message.frame.bytes();
  message.data.assign(bytes.begin(), bytes.end());
  const auto& sharing = channel.knowledge.pdos(key_of(message.frame));
  const bool is_mpdo =
      bytes.size() == 8 && std::ranges::any_of(sharing, [](const PdoFacts& one) { return one.mpdo != 0; });
  if (is_mpdo) return decode_mpdo(channel, message);
  decode_signals(channel, message, pdo);
}

void Decoder::decode_mpdo(Channel& channel, Message& message) const {
  message.service = Service::mpdo;
  const std::uint8_t head = message.data[0];
  const bool destination = (head & 0x80U) != 0;
  const auto addressed = static_cast<std::uint8_t>(head & 0x7FU);
  message.kind = destination ? "DAM" : "SAM";
  message.index = can::load_as<std::uint16_t>(&message.data[1]);
  message.sub = message.data[3];
  message.data.erase(message.data.begin(), message.data.begin() + 4);
  if (!destination) message.node = addressed;
  const ObjectFacts& facts = channel.facts(addressed, *message.index, message.sub);
  message.object_name = facts.name;
  const unsigned length = canopen::byte_length(facts.type);
  const auto value = std::span(message.data).first(length >= 1 && length <= 4 ? length : 4);
  message.text =
      fmt::format("{} {}{} = {}",
                  destination ? addressed == 0 ? "to all:" : fmt::format("to node {}:", addressed) : "from",
                  canopen::object_text(*message.index, message.sub),
                  facts.name.empty() ? "" : fmt::format(" '{}'", facts.name), value_text(value, facts.type));
}

void Decoder::decode_signals(Channel& channel, Message& message, const PdoFacts& pdo) {
  const std::uint64_t raw = can::load_value(message.data);
  const NodeDescription* const node = channel.knowledge.node(pdo.node);
  const canopen::DictionaryDescription* const dictionary = node == nullptr ? nullptr : node->dictionary.get();
  const unsigned room = static_cast<unsigned>(message.data.size()) * 8;
  unsigned bit = 0;
  for (const std::uint32_t entry : pdo.mapping) {
    const auto index = static_cast<std::uint16_t>(entry >> 16);
    const auto sub = static_cast<std::uint8_t>(entry >> 8);
    const unsigned bits = entry & 0xFFU;
    const unsigned first = bit;
    bit += bits;
    if (is_dummy(index)) continue;
    if (bits == 0 || bit > 64) break;
    if (bit > room) continue;
    const ObjectFacts& facts = channel.facts(pdo.node, index, sub);
    const bool fits = facts.type != canopen::DataType::none && canopen::bit_length(facts.type) <= 64 &&
                      (canopen::bit_length(facts.type) == bits || !canopen::is_signed(facts.type));
    const canopen::DataType type = fits ? facts.type : canopen::DataType::none;
    Signal signal{.index = index,
                  .sub = sub,
                  .first_bit = static_cast<std::uint8_t>(first),
                  .bits = static_cast<std::uint8_t>(bits),
                  .type = facts.type,
                  .name = facts.name,
                  .value = signal_text(raw >> first, bits, type),
                  .number = number_of(raw >> first, bits, facts.type),
                  .unit = value_unit(dictionary, index, sub)};
    const ValueWords words = value_words(dictionary, index, sub, bits_of(raw >> first, bits));
    signal.words = words.state.empty() ? words.text() : std::string(words.state);
    message.text += message.text.empty() ? "" : ", ";
    message.text +=
        (signal.name.empty() ? canopen::object_text(index, sub) : signal.name) + " = " + signal.value;
    if (!signal.unit.empty()) message.text += fmt::format(" {}", signal.unit);
    if (!signal.words.empty()) message.text += fmt::format(" ({})", signal.words);
    message.signals.push_back(std::move(signal));
  }
  if (message.signals.empty()) message.text = hexadecimal(message.data);
  message.is_malformed = !pdo.mapping.empty() && bit > room;
  if (message.is_malformed)
    message.text +=
        fmt::format(" (too short: {} of {})", ascii::counted(message.data.size(), "byte"), (bit + 7) / 8);
}

}  // namespace canopus::trace
