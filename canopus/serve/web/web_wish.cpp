#include "canopus/serve/web/web_wish.hpp"

#include <nlohmann/json.hpp>

namespace canopus::serve {

std::optional<bool> wants_messages(std::string_view text) {
  const auto wish = nlohmann::json::parse(text, nullptr, false);
  if (!wish.is_object() || wish.size() != 1) return std::nullopt;
  const auto found = wish.find("messages");
  if (found == wish.end() || !found->is_boolean()) return std::nullopt;
  return found->get<bool>();
}

}  // namespace canopus::serve
