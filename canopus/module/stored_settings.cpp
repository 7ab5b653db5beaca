#include "canopus/module/stored_settings.hpp"

#include "canopus/canopen/pdo_mapping.hpp"

namespace canopus::module {

namespace {

void put16(std::vector<std::uint8_t>& bytes, std::size_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8 & 0xFF));
}

std::uint16_t get16(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
}

}  // namespace

std::vector<std::uint8_t> encode_words(const StoredWords& words) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(words.size() * 4);
  for (const auto& [address, value] : words) {
    put16(bytes, address);
    put16(bytes, value);
  }
  return bytes;
}

std::optional<StoredWords> decode_words(std::span<const std::uint8_t> bytes) {
  if (bytes.size() % 4 != 0) return std::nullopt;
  StoredWords words;
  for (; !bytes.empty(); bytes = bytes.subspan(4)) words[get16(bytes)] = get16(bytes.subspan(2));
  return words;
}

std::vector<std::uint8_t> encode_objects(const canopen::ObjectDictionary& dictionary) {
  std::vector<std::uint8_t> bytes;
  const canopen::DictionaryDescription& description = dictionary.description();
  for (const canopen::ObjectDescription& object : description.objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const canopen::Entry entry = description.find(object, static_cast<std::uint8_t>(sub));
      if (!entry || !entry.description->stored) continue;
      append_object(bytes, object.index, static_cast<std::uint8_t>(sub), dictionary.bytes(entry));
    }
  }
  return bytes;
}

void append_object(std::vector<std::uint8_t>& bytes, std::uint16_t index, std::uint8_t sub,
                   std::span<const std::uint8_t> value) {
  put16(bytes, index);
  bytes.push_back(sub);
  put16(bytes, value.size());
  bytes.insert(bytes.end(), value.begin(), value.end());
}

namespace {

// Calls use(entry, value) for every stored object that exists. False at the first that cannot be what
// encode_objects() makes.
template <typename Use>
bool for_each_object(std::span<const std::uint8_t> bytes, const canopen::DictionaryDescription& description,
                     Use use) {
  while (!bytes.empty()) {
    if (bytes.size() < 5) return false;
    const std::uint16_t index = get16(bytes);
    const std::uint8_t sub = bytes[2];
    const std::size_t length = get16(bytes.subspan(3));
    bytes = bytes.subspan(5);
    if (bytes.size() < length) return false;
    if (const canopen::Entry entry = description.find(index, sub)) {
      const std::uint8_t fixed = entry.description->length;
      if (fixed != 0 && fixed != length) return false;
      use(entry, bytes.first(length));
    }
    bytes = bytes.subspan(length);
  }
  return true;
}

}  // namespace

bool apply_objects(std::span<const std::uint8_t> bytes, canopen::ObjectDictionary& dictionary) {
  const canopen::DictionaryDescription& description = dictionary.description();
  if (!for_each_object(bytes, description, [](const auto&, const auto&) {})) return false;
  return for_each_object(bytes, description,
                         [&](const canopen::Entry& entry, auto value) { dictionary.assign(entry, value); });
}

namespace {

// The first wrong entry of a mapping that is switched on.
std::optional<canopen::Entry> faulty_mapping(const canopen::ObjectDictionary& dictionary, std::uint16_t index,
                                             canopen::PdoDirection direction) {
  const auto count = dictionary.get<std::uint8_t>(index, 0);
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
