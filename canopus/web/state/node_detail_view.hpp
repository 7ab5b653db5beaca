#pragma once
// Views of the page with one thing in words: the errors of a module, a value of many bytes of a node.

#include <cstddef>
#include <expected>
#include <string>

#include "canopus/plant/plant.hpp"
#include "canopus/text/json.hpp"

namespace canopus::web {

/// The event of a view {"errors": MODULE}: what the module of that number in `state` shows and keeps of errors, as
/// plant::error_history() has them, and how a program clears errors and restarts it; empty: there is no such module.
[[nodiscard]] std::string errors_event(plant::Plant& plant, const text::Json& wish);

/// The event of a view {"domain": NODE, "object": "1F22:05"}: the value in words, as domain_words() says, of an object of variable
/// length of the node of that number. With "part": N its bytes from N on, as many as `domain_part` says. Empty: there is none.
[[nodiscard]] std::string domain_event(plant::Plant& plant, const text::Json& wish);
inline constexpr std::size_t domain_part = 32768;

/// Of {"bus": "line1", "object": "1F22:03", "bytes": "0200..."}: these bytes in words, as domain_words() says, a concise DCF with the names
/// of the device file of the node that it is for. The error is a sentence.
[[nodiscard]] std::expected<text::Json, std::string> domain_in_words(plant::Plant& plant,
                                                                     const text::Json& wish);

}  // namespace canopus::web
