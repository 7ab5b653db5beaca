#include "canopus/web/http/form.hpp"

#include <algorithm>
#include <cstdint>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/words.hpp"

namespace canopus::web {
namespace {

std::optional<std::string> decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const auto byte = ascii::byte_of_hex(text.substr(i + 1, 2));
    if (!byte) return std::nullopt;
    result += static_cast<char>(*byte);
    i += 2;
  }
  return result;
}

}  // namespace

std::optional<WebForm> read_form(std::string_view body) {
  WebForm form;
  while (!body.empty()) {
    const std::string_view field = body.substr(0, body.find('&'));
    body.remove_prefix(std::min(field.size() + 1, body.size()));
    const std::size_t sign = std::min(field.find('='), field.size());
    auto name = decoded(field.substr(0, sign));
    auto value = decoded(field.substr(std::min(sign + 1, field.size())));
    if (!name || !value || form.size() == most_form_fields) return std::nullopt;
    if (!form.emplace(std::move(*name), std::move(*value)).second) return std::nullopt;
  }
  return form;
}

std::optional<std::string_view> cookie_of(std::string_view field, std::string_view name) noexcept {
  std::optional<std::string_view> found;
  while (!field.empty()) {
    const std::string_view part = field.substr(0, field.find(';'));
    field.remove_prefix(std::min(part.size() + 1, field.size()));
    const std::string_view pair = ascii::trim(part);
    const std::size_t sign = pair.find('=');
    if (sign == std::string_view::npos || pair.substr(0, sign) != name) continue;
    if (found) return std::nullopt;
    found = pair.substr(sign + 1);
  }
  return found;
}

}  // namespace canopus::web
