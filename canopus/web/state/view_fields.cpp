#include "canopus/web/state/view_fields.hpp"

#include <algorithm>
#include <cstdint>

#include "canopus/text/printable.hpp"

namespace canopus::web {
namespace {

constexpr char lower_letter(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::size_t view_number(const text::Json& wish, const char* key, std::size_t most) {
  const auto found = wish.find(key);
  if (found == wish.end() || !found->is_number_unsigned()) return 0;
  return static_cast<std::size_t>(std::min<std::uint64_t>(found->get<std::uint64_t>(), most));
}

std::string view_text(const text::Json& wish, const char* key) {
  const auto found = wish.find(key);
  if (found == wish.end() || !found->is_string()) return {};
  std::string text = found->get<std::string>();
  std::ranges::transform(text, text.begin(), lower_letter);
  return text;
}

bool has_words(std::string_view text, std::string_view lower_words) noexcept {
  return lower_words.empty() || !std::ranges::search(text, lower_words, {}, lower_letter).empty();
}

std::string view_event(const text::Json& event) { return text::printable_json(event.dump()); }

}  // namespace canopus::web
