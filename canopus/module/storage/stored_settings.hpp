#pragma once
// How a module's settings lie in the non-volatile memory: buffer memory words as pairs of address and value,
// little-endian; objects as canopen/dictionary/stored_values.hpp says, lengths in two bytes. Damage is the memory's to
// notice (NonVolatileMemory); what does not decode here is damaged all the same.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/canopen/dictionary/stored_values.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

inline constexpr auto stored_length = canopen::StoredLength::two_bytes;

[[nodiscard]] std::vector<std::uint8_t> encode_words(const StoredWords& words);
[[nodiscard]] std::optional<StoredWords> decode_words(std::span<const std::uint8_t> bytes);

/// The first entry of a mapping (16xxH, 1AxxH) that is switched on and names what cannot be mapped, or more
/// than 8 bytes altogether: a stored dictionary that a module cannot work with.
[[nodiscard]] std::optional<canopen::Entry> first_faulty_mapping(const canopen::ObjectDictionary& dictionary);

}  // namespace canopus::module
