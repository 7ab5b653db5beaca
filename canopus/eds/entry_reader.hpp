#pragma once
// One section of the file as one sub-index.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/eds/draft.hpp"

namespace canopus::eds {

/// The keys of an object's section, misspelt ones included.
class ObjectKeys {
 public:
  /// Warns of misspelt keys.
  ObjectKeys(const Section& section, Problems& problems);

  [[nodiscard]] const Section& section() const noexcept { return section_; }
  /// The key (folded) when it is there and has a value, else nullptr.
  [[nodiscard]] const Item* find(std::string_view key) const noexcept;

 private:
  const Section& section_;
  std::vector<std::pair<std::string_view, const Item*>> misspelt_;
};

/// Attributes that a sub-index inherits from its object if its own section has none.
struct EntryFallback {
  std::string name;
  std::optional<canopen::DataType> type;
};

/// Reads the section of a VAR, of a sub-index, or (`as_member`) of the head of a compact object, whose keys
/// hold for all members.
[[nodiscard]] EntryDraft read_entry(const ObjectKeys& keys, std::uint16_t index, std::uint8_t sub,
                                    const EntryFallback& fallback, Problems& problems);

/// DataType, when the section has one that can be understood.
[[nodiscard]] std::optional<canopen::DataType> read_data_type(const ObjectKeys& keys, Problems& problems);
/// ObjectType, when the section has one that can be understood.
[[nodiscard]] std::optional<canopen::ObjectCode> read_object_code(const ObjectKeys& keys, Problems& problems);

/// Puts the text of `item` as the value of the entry.
void set_value(EntryDraft& entry, const Item& item, std::uint16_t index, std::uint8_t sub,
               Problems& problems);

}  // namespace canopus::eds
