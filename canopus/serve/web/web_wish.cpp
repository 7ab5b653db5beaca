#include "canopus/serve/web/web_wish.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace canopus::serve {
namespace {

using Json = nlohmann::json;

std::string written(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::optional<WebWish> read_command(const Json& wish) {
  const auto command = wish.find("do");
  const auto id = wish.find("id");
  if (command == wish.end() || id == wish.end() || !command->is_object()) return std::nullopt;
  if (!id->is_number_unsigned() || id->get<std::uint64_t>() > UINT32_MAX) return std::nullopt;
  return WebWish{.command = WebWish::Command{written(*command), id->get<std::uint32_t>()}};
}

}  // namespace

std::optional<WebWish> read_wish(std::string_view text) {
  const Json wish = Json::parse(text, nullptr, false);
  if (!wish.is_object()) return std::nullopt;
  if (wish.size() == 2) return read_command(wish);
  if (wish.size() != 1) return std::nullopt;
  const auto& value = *wish.begin();
  if (wish.contains("messages") && value.is_boolean()) return WebWish{.messages = value.get<bool>()};
  if (!wish.contains("views") || !value.is_array() || value.size() > WebWish::most_views) return std::nullopt;
  if (!std::ranges::all_of(value, [](const Json& view) { return view.is_object(); })) return std::nullopt;
  std::vector<std::string> views;
  for (const Json& view : value) views.push_back(written(view));
  return WebWish{.views = std::move(views)};
}

}  // namespace canopus::serve
