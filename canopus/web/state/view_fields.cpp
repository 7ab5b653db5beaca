#include "canopus/web/state/view_fields.hpp"

#include <algorithm>
#include <cstdint>

#include "canopus/ascii/words.hpp"
#include "canopus/text/printable.hpp"

namespace canopus::web {

std::size_t view_number(const text::Json& wish, const char* key, std::size_t most) {
  const auto found = wish.find(key);
  if (found == wish.end() || !found->is_number_unsigned()) return 0;
  return static_cast<std::size_t>(std::min<std::uint64_t>(found->get<std::uint64_t>(), most));
}

std::string view_text(const text::Json& wish, const char* key) { return ascii::lower(wish.value(key, "")); }

bool has_words(std::string_view text, std::string_view lower_words) noexcept {
  return ascii::contains_ignoring_case(text, lower_words);
}

std::string view_event(const text::Json& event) { return text::printable_json(event.dump()); }

}  // namespace canopus::web
