#pragma once
// A value of many bytes for people: a concise DCF of 1F22H [CiA 302-3] as the objects that it writes, any
// other DOMAIN as its bytes with the text in them. The command line and the page both print this text.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/text/json.hpp"

namespace canopus::client {

inline constexpr std::uint16_t concise_dcf_object = 0x1F22;

struct DomainWords {
  static constexpr std::size_t most_dumped = 4096;   ///< bytes
  static constexpr std::size_t most_entries = 8192;  ///< more than the largest file of a module has

  /// An entry of a concise DCF.
  struct Entry {
    std::string object;  ///< "1017:00"
    std::string name;    ///< of the device file, else of CiA 301 or 302; empty: not known
    std::string value;
  };
  std::string heading;  ///< "concise DCF, 27 bytes, 2 entries", "70000 bytes, the first 4096 of them"
  std::vector<Entry> entries;
  std::string problem;            ///< what does not fit; empty: nothing
  std::vector<std::string> dump;  ///< lines of 16 bytes; of a concise DCF from where it does not fit on
};

/// The text of a value of this object. `device`: the dictionary of the destination node, for names and types;
/// may be nullptr. The bytes may be invalid.
[[nodiscard]] DomainWords domain_words(std::uint16_t index, std::span<const std::uint8_t> bytes,
                                       const canopen::DictionaryDescription* device);
/// The same for a terminal, a line each.
[[nodiscard]] std::vector<std::string> lines_of(const DomainWords& words);
/// `heading`, `entries`, `problem`, `dump` as fields.
[[nodiscard]] text::Json json_of(const DomainWords& words);

/// A character for each byte: itself from 20H to 7EH, else a dot.
[[nodiscard]] std::string ascii_of(std::span<const std::uint8_t> bytes);

/// "00000000  00 11 22 ...  |...text...|" for each 16 bytes; `first` is the address of the first one.
[[nodiscard]] std::vector<std::string> hex_dump(std::span<const std::uint8_t> bytes, std::size_t first = 0);

}  // namespace canopus::client
