#pragma once
// How settings lie in the non-volatile memory: buffer memory words as pairs of address and value, objects as
// index, sub-index, length and value; everything little-endian. Damage is the memory's to notice
// (NonVolatileMemory); what does not decode here is damaged all the same.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/canopen/object_dictionary.hpp"
#include "canopus/module/buffer_memory.hpp"

namespace canopus::module {

[[nodiscard]] std::vector<std::uint8_t> encode_words(const StoredWords& words);
[[nodiscard]] std::optional<StoredWords> decode_words(std::span<const std::uint8_t> bytes);

/// All objects of the dictionary that are described as stored.
[[nodiscard]] std::vector<std::uint8_t> encode_objects(const canopen::ObjectDictionary& dictionary);
/// Puts stored values into the dictionary, without checks or handlers. False when the bytes are not what
/// encode_objects() makes; nothing is put in then. Objects that no longer exist are left out.
bool apply_objects(std::span<const std::uint8_t> bytes, canopen::ObjectDictionary& dictionary);
/// The first entry of a mapping (16xxH, 1AxxH) that is switched on and names what cannot be mapped, or more
/// than 8 bytes altogether: a stored dictionary that a module cannot work with.
[[nodiscard]] std::optional<canopen::Entry> first_faulty_mapping(const canopen::ObjectDictionary& dictionary);
/// Appends one object in the same form.
void append_object(std::vector<std::uint8_t>& bytes, std::uint16_t index, std::uint8_t sub,
                   std::span<const std::uint8_t> value);

}  // namespace canopus::module
