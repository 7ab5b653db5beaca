#pragma once
// How a PLC program clears the errors of a module and restarts it, by the module's manual. Facts of a model, in its folder.

#include <cstdint>
#include <string_view>

#include "canopus/module/interface/module.hpp"

namespace canopus::module {

/// One of the two requests.
struct ResetRequest {
  enum class Kind : std::uint8_t {
    none,    ///< the manual has no such request
    signal,  ///< Y of this number ON, until X of the same number answers; then OFF
    word,    ///< `value` is written to the word, once
  };
  Kind kind = Kind::none;
  unsigned signal = 0;  ///< 0..31, from the head address on
  BufferAddress word = 0;
  std::uint16_t value = 0;
  std::string_view text{};  ///< as its manual names the signals or the word; of none: why there is none
};

struct ResetProcedure {
  ResetRequest clear_errors{};  ///< signal: until X is OFF
  ResetRequest restart{};       ///< signal: until X is ON
  /// The word whose bits are the errors that there are now, and its name; no name: it has none.
  BufferAddress error_word = 0;
  std::string_view error_word_name{};
};

}  // namespace canopus::module
