#include "canopus/serve/web/web_wish.hpp"

#include <algorithm>

#include "canopus/text/json.hpp"

namespace canopus::serve {
namespace {

using Json = text::Json;

std::optional<WebWish> read_command(const Json& wish) {
  const auto command = wish.find("do");
  const auto id = wish.find("id");
  if (command == wish.end() || id == wish.end() || !command->is_object()) return std::nullopt;
  if (!id->is_number_unsigned() || id->get<std::uint64_t>() > UINT32_MAX) return std::nullopt;
  return WebWish{.command = WebWish::Command{command->dump(), id->get<std::uint32_t>()}};
}

}  // namespace

std::optional<WebWish> read_wish(std::string_view text) {
  auto parsed = text::parse_json(text);
  if (!parsed || !parsed->is_object()) return std::nullopt;
  parsed->sort_members();  // as the audit log has them, in whatever order they come
  const Json& wish = *parsed;
  if (wish.size() == 2) return read_command(wish);
  if (wish.size() != 1) return std::nullopt;
  const auto& value = *wish.begin();
  if (wish.contains("messages") && value.is_boolean()) return WebWish{.messages = value.get<bool>()};
  if (!wish.contains("views") || !value.is_array() || value.size() > WebWish::most_views) return std::nullopt;
  if (!std::ranges::all_of(value, [](const Json& view) { return view.is_object(); })) return std::nullopt;
  std::vector<std::string> views;
  for (const Json& view : value) {
    views.push_back(view.dump());
    if (views.back().size() > WebWish::longest_view) return std::nullopt;
  }
  return WebWish{.views = std::move(views)};
}

}  // namespace canopus::serve
