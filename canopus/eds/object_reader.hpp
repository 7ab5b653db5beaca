#pragma once
// All object sections of a file, and its object lists, as a draft of the dictionary.

#include <map>
#include <string_view>

#include "canopus/eds/draft.hpp"

namespace canopus::eds {

/// The sections that belong to one object.
struct ObjectSections {
  const Section* head = nullptr;
  std::map<std::uint8_t, const Section*> subs;
  const Section* names = nullptr;        ///< [xxxxName]
  const Section* values = nullptr;       ///< [xxxxValue]
  const Section* denotations = nullptr;  ///< [xxxxDenotation]
};
using ObjectSectionMap = std::map<std::uint16_t, ObjectSections>;

/// The object sections whose folded names begin with `prefix` (empty, or "m1fixed").
[[nodiscard]] ObjectSectionMap find_object_sections(const IniFile& file, std::string_view prefix,
                                                    Problems& problems);

/// Reads one object into the draft. Data type definitions and objects that cannot be made sense of are left
/// out, with a note or warning.
void read_object(Draft& draft, std::uint16_t index, const ObjectSections& sections, Problems& problems);

}  // namespace canopus::eds
