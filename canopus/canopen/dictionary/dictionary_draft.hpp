#pragma once
// A description's layout while DictionaryBuilder makes it: tables that grow. pack() puts them into one piece of
// memory, which has nothing but what is needed: a slave may have a description of its own.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::canopen {

/// The name of a sub-index 00H that was not added. Nearly all descriptions have it, none keeps it: its number is beyond
/// all texts.
inline constexpr std::string_view highest_sub_name = "Highest sub-index supported";
inline constexpr std::uint32_t highest_sub_name_number = 0x7FFF'FFFF;

struct DictionaryDescription::Draft {
  std::vector<ObjectDescription> objects;
  std::vector<EntryDescription> entries;
  std::string text;
  std::vector<Limits> limits;
  std::vector<std::uint8_t> image;
  std::vector<std::vector<std::uint8_t>> slots;
  std::vector<NodeIdDefault> node_id_defaults;
  std::size_t communication_block_size = 0;
  std::size_t communication_slot_count = 0;
  std::size_t pdo_values_begin = 0;
  std::size_t pdo_values_end = 0;
  bool marks_stored = false;

  std::uint32_t add_name(std::string_view name);
  /// Returns where they are; `known`: by hash, those that were added before.
  std::uint32_t add_entries(const std::vector<EntryDescription>& added,
                            std::unordered_multimap<std::size_t, std::uint32_t>& known);
  [[nodiscard]] std::shared_ptr<const Layout> pack() const;

 private:
  /// A hash table over the index.
  struct Hash {
    std::vector<std::uint16_t> positions;
    std::uint32_t multiplier = 0;
    std::uint32_t places = 0;
  };
  [[nodiscard]] Hash index_objects() const;
};

}  // namespace canopus::canopen
