#pragma once
// The objects of a file while they are being read and repaired, before they become a dictionary.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/eds/ini.hpp"

namespace canopus::eds {

struct EntryDraft {
  canopen::EntrySpec spec;
  EntryFacts facts;
  bool has_value = false;   ///< the file gives one that could be read
  unsigned value_line = 0;  ///< of that value, or of the section
  /// The value as a number, when its type is fixed in length.
  [[nodiscard]] std::uint64_t number() const noexcept;
  void set_number(std::uint64_t value);
};

struct ObjectDraft {
  canopen::ObjectCode code = canopen::ObjectCode::variable;
  std::string name;
  unsigned line = 0;
  std::uint8_t uniform_count = 0;  ///< not 0: subs[1] describes sub-indexes 01H..uniform_count
  std::map<std::uint8_t, EntryDraft> subs;

  [[nodiscard]] bool is_structured() const noexcept;
  [[nodiscard]] std::uint8_t highest_sub() const noexcept;
  /// The sub-index, or nullptr.
  [[nodiscard]] EntryDraft* find(std::uint8_t sub) noexcept;
};

using Draft = std::map<std::uint16_t, ObjectDraft>;

/// The sub-index, or nullptr.
[[nodiscard]] EntryDraft* find(Draft& draft, std::uint16_t index, std::uint8_t sub) noexcept;

/// A constant or default made by the reader, not by the file.
[[nodiscard]] EntryDraft made_entry(std::string name, canopen::DataType type, canopen::Access access,
                                    std::uint64_t value, unsigned line);

/// The meaning of an object's section name.
struct ObjectSection {
  enum class Kind : std::uint8_t { head, sub, names, values, denotations, links };
  Kind kind = Kind::head;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  bool irregular = false;  ///< 0x1000, 1000h, 1018subindex1
};
/// Reads a folded section name such as 1018, 1018sub1, 1016value. Nothing for other sections.
[[nodiscard]] std::optional<ObjectSection> object_section(std::string_view folded_name);

[[nodiscard]] constexpr bool is_communication_record(std::uint16_t index) noexcept {
  return (index >= 0x1400 && index <= 0x15FF) || (index >= 0x1800 && index <= 0x19FF);
}
[[nodiscard]] constexpr bool is_mapping_record(std::uint16_t index) noexcept {
  return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF);
}

}  // namespace canopus::eds
