#pragma once
// What the views of the page have alike: numbers and texts of a wish, rows that hold a text, the event as JSON.

#include <cstddef>
#include <string>
#include <string_view>

#include "canopus/text/json.hpp"

namespace canopus::web {

/// A number of a wish, within 0 and `most`; 0 when it is none.
[[nodiscard]] std::size_t view_number(const text::Json& wish, const char* key, std::size_t most);
/// A text of a wish in lower-case letters, for has_words(); empty when it is none.
[[nodiscard]] std::string view_text(const text::Json& wish, const char* key);
/// `text`, in whatever case of its letters, holds `lower_words`; empty words are in every text.
[[nodiscard]] bool has_words(std::string_view text, std::string_view lower_words) noexcept;
/// One line, with nothing in it that would control a terminal.
[[nodiscard]] std::string view_event(const text::Json& event);

}  // namespace canopus::web
