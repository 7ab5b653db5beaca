#pragma once
// Values that are a state, a choice or a set of bits, in words: of CiA 301, CiA 302 and, for a drive, CiA 402.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::trace {

struct ValueWords {
  std::string_view
      state{};  ///< "operation enabled", "profile position"; empty: the value is bits alone, or has no words
  std::vector<std::string_view> bits{};  ///< the names of all bits that are set, the lowest first

  [[nodiscard]] bool empty() const noexcept { return state.empty() && bits.empty(); }
  /// "operation enabled (ready to switch on, switched on, ...)", "generic, communication"; a bit of the state's name is left out
  [[nodiscard]] std::string text() const;
};

/// The words of a number, as its bit pattern. `dictionary`: the node's, which says whether it is a drive (low 16 bits of 1000H:
/// 402); nullptr: not known, so its objects from 6000H on have no words.
[[nodiscard]] ValueWords value_words(const canopen::DictionaryDescription* dictionary, std::uint16_t index,
                                     std::uint8_t sub, std::uint64_t value);

/// The unit that CiA 301 gives a value, or, for a drive, CiA 402: "ms", "mA", "x 0.1 %"; empty: none, or the device's own.
[[nodiscard]] std::string_view value_unit(const canopen::DictionaryDescription* dictionary,
                                          std::uint16_t index, std::uint8_t sub) noexcept;

/// The bits of 1001H that are set [CiA 301 7.5.2.2].
[[nodiscard]] std::vector<std::string_view> error_register_bits(std::uint8_t error_register);

}  // namespace canopus::trace
