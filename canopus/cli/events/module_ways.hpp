#pragma once
// How a PLC program clears the errors of a module and restarts it, by the manual of each model.

#include <cstdint>
#include <string_view>

namespace canopus::cli {

/// One of the two requests.
struct ModuleWay {
  enum class Kind : std::uint8_t {
    none,    ///< the manual has no such request
    signal,  ///< Y of this number ON, until X of the same number answers; then OFF
    word,    ///< `value` is written to the word, once
  };
  Kind kind = Kind::none;
  unsigned signal = 0;  ///< 0..31, from the head address on
  std::uint32_t word = 0;
  std::uint16_t value = 0;
  std::string_view how{};  ///< as its manual calls the signals or the word; of none: why there is none
};

struct ModuleWays {
  std::string_view model{};
  ModuleWay clear{};    ///< signal: until X is OFF
  ModuleWay restart{};  ///< signal: until X is ON
  /// The word whose bits are the errors that there are now, and its name; no name: it has none.
  std::uint32_t error_word = 0;
  std::string_view error_word_name{};
};

/// Of this model, as the catalogue spells it; of another one: without ways.
[[nodiscard]] const ModuleWays& module_ways(std::string_view model) noexcept;

}  // namespace canopus::cli
