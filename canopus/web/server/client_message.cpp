#include "canopus/web/server/client_message.hpp"

#include <algorithm>

#include "canopus/text/json.hpp"

namespace canopus::web {
namespace {

using Json = text::Json;

std::optional<ClientMessage> read_command(const Json& wish) {
  const auto command = wish.find("do");
  const auto id = wish.find("id");
  if (command == wish.end() || id == wish.end() || !command->is_object()) return std::nullopt;
  if (!id->is_number_unsigned() || id->get<std::uint64_t>() > UINT32_MAX) return std::nullopt;
  return ClientMessage{.command = ClientMessage::Command{command->dump(), id->get<std::uint32_t>()}};
}

}  // namespace

std::optional<ClientMessage> parse_client_message(std::string_view text) {
  auto parsed = text::parse_json(text);
  if (!parsed || !parsed->is_object()) return std::nullopt;
  parsed->sort_members();  // as the audit log has them, in whatever order they come
  const Json& wish = *parsed;
  if (wish.size() == 2) return read_command(wish);
  if (wish.size() != 1) return std::nullopt;
  const auto& value = *wish.begin();
  if (wish.contains("messages") && value.is_boolean()) return ClientMessage{.messages = value.get<bool>()};
  if (!wish.contains("views") || !value.is_array() || value.size() > ClientMessage::most_views)
    return std::nullopt;
  if (!std::ranges::all_of(value, [](const Json& view) { return view.is_object(); })) return std::nullopt;
  std::vector<std::string> views;
  for (const Json& view : value) {
    views.push_back(view.dump());
    if (views.back().size() > ClientMessage::longest_view) return std::nullopt;
  }
  return ClientMessage{.views = std::move(views)};
}

}  // namespace canopus::web
