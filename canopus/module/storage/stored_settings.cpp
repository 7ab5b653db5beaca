#include "canopus/module/storage/stored_settings.hpp"

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/pdo/pdo_mapping.hpp"

namespace canopus::module {

std::vector<std::uint8_t> encode_words(const StoredWords& words) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(words.size() * 4);
  for (const auto& [address, value] : words) {
    can::append_value(bytes, address, 2);
    can::append_value(bytes, value, 2);
  }
  return bytes;
}

std::optional<StoredWords> decode_words(std::span<const std::uint8_t> bytes) {
  if (bytes.size() % 4 != 0) return std::nullopt;
  StoredWords words;
  for (; !bytes.empty(); bytes = bytes.subspan(4)) {
    words[can::load_as<std::uint16_t>(&bytes[0])] = can::load_as<std::uint16_t>(&bytes[2]);
  }
  return words;
}

namespace {

// The first wrong entry of a mapping that is switched on. One that cannot be changed, as those of a device profile, is right.
std::optional<canopen::Entry> faulty_mapping(const canopen::ObjectDictionary& dictionary, std::uint16_t index,
                                             canopen::PdoDirection direction) {
  const canopen::Entry entries = dictionary.description().find(index, 0);
  if (!entries || !entries.description->stored) return std::nullopt;
  const auto count = dictionary.get<std::uint8_t>(entries);
  unsigned bits = 0;
  for (unsigned sub = 1; sub <= count; ++sub) {
    const canopen::Entry entry = dictionary.description().find(index, static_cast<std::uint8_t>(sub));
    if (!entry) return dictionary.description().find(index, 0);
    const auto mapping = dictionary.get<std::uint32_t>(entry);
    bits += mapping & 0xFF;
    const auto code = canopen::check_mapping_entry(dictionary, mapping, direction);
    if (code != canopen::AbortCode::none || bits > 64) return entry;
  }
  return std::nullopt;
}

}  // namespace

std::optional<canopen::Entry> first_faulty_mapping(const canopen::ObjectDictionary& dictionary) {
  for (const canopen::ObjectDescription& object : dictionary.description().objects()) {
    const bool receives = object.index >= 0x1600 && object.index <= 0x17FF;
    const bool transmits = object.index >= 0x1A00 && object.index <= 0x1BFF;
    if (!receives && !transmits) continue;
    const auto direction = receives ? canopen::PdoDirection::receive : canopen::PdoDirection::transmit;
    if (const auto faulty = faulty_mapping(dictionary, object.index, direction)) return faulty;
  }
  return std::nullopt;
}

}  // namespace canopus::module
