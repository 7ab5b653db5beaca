#include "canopus/serve/web/web_wish.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace canopus::serve {

std::optional<WebWish> read_wish(std::string_view text) {
  using Json = nlohmann::json;
  const Json wish = Json::parse(text, nullptr, false);
  if (!wish.is_object() || wish.size() != 1) return std::nullopt;
  const auto& value = *wish.begin();
  if (wish.contains("messages") && value.is_boolean()) return WebWish{.messages = value.get<bool>()};
  if (!wish.contains("views") || !value.is_array() || value.size() > WebWish::most_views) return std::nullopt;
  if (!std::ranges::all_of(value, [](const Json& view) { return view.is_object(); })) return std::nullopt;
  std::vector<std::string> views;
  for (const Json& view : value) views.push_back(view.dump(-1, ' ', false, Json::error_handler_t::replace));
  return WebWish{.views = std::move(views)};
}

}  // namespace canopus::serve
