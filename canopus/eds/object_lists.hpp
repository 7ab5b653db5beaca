#pragma once
// Numbered lists (1=, 2=, ...) and the object lists.

#include <cstdint>
#include <string_view>
#include <vector>

#include "canopus/eds/object_reader.hpp"

namespace canopus::eds {

/// Compares [MandatoryObjects], [OptionalObjects] and [ManufacturerObjects] with the sections that are there.
void check_object_lists(const IniFile& file, const ObjectSectionMap& sections, Problems& problems);

/// The entries 1=, 2= ... of a list, with the number of them that `count_key` (folded) announces; warns when
/// it differs.
struct ListEntry {
  std::uint64_t key = 0;
  const Item* item = nullptr;
};
[[nodiscard]] std::vector<ListEntry> read_list(const Section& section, std::string_view count_key,
                                               Problems& problems);

}  // namespace canopus::eds
