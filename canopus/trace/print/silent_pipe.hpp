#pragma once

#include <functional>
#include <string_view>
#include <utility>

#include "canopus/text/output.hpp"

namespace canopus::trace {

/// A KeepReading for commands: prints on `err` that the command waits for a named pipe, and continues while
/// `goes_on()` is true.
inline std::function<bool(std::string_view)> wait_in_words(text::Output& err, std::function<bool()> goes_on) {
  return [&err, goes_on = std::move(goes_on)](std::string_view silent) {
    if (!silent.empty()) err.line("canopus: {}: waiting until a program writes to this named pipe", silent);
    return goes_on();
  };
}

}  // namespace canopus::trace
