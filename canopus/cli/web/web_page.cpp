#include "canopus/cli/web/web_page.hpp"

#include <array>
#include <cstddef>
#include <random>
#include <utility>

#include <fmt/format.h>

namespace canopus::cli {
namespace {

/// Whoever knows it may do what the one may who runs the program: other users of this machine do not.
std::string make_key() {
  std::random_device random;  // the kernel's
  std::string key;
  for (int i = 0; i < 4; ++i) key += fmt::format("{:08x}", random());
  return key;
}

using OwnCommands = std::map<std::string, WebCommands::Own, std::less<>>;

std::string word_of(const nlohmann::json& wish, const char* key) {
  const auto found = wish.find(key);
  return found != wish.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// {"command": "plants"}, {"command": "open", "path": "..."} (no path: the built-in plant), {"command": "new project", "name": "..."}
OwnCommands own_commands(WebStart* start) {
  OwnCommands own;
  if (start == nullptr) return own;
  using Done = WebCommands::Own::Done;
  own["plants"] = {.role = serve::WebRole::look,
                   .run = [start](const nlohmann::json&, const Done& done) { done(start->list()); }};
  own["open"] = {.role = serve::WebRole::configure, .run = [start](const nlohmann::json& wish, Done done) {
                   start->open(word_of(wish, "path"), std::move(done));
                 }};
  own["new project"] = {.role = serve::WebRole::configure,
                        .run = [start](const nlohmann::json& wish, Done done) {
                          start->make_project(word_of(wish, "name"), std::move(done));
                        }};
  return own;
}

}  // namespace

WebPage::WebPage(boost::asio::io_context& io, plant::Plant& plant, link::LoopClock& clock, WebEvents& events,
                 std::vector<WebBus> buses, const std::string& start, link::ClientReport report)
    : events_(events),
      messages_(plant),
      views_(plant, events.boots()),
      start_(start.empty() ? std::nullopt : std::optional<WebStart>(std::in_place, io, start)),
      commands_(io, {.buses = std::move(buses),
                     .own = own_commands(start_ ? &*start_ : nullptr),
                     .now = [&plant] { return plant.timeline().now(); }}),
      server_(
          io, clock,
          {.state = [&plant] { return state_event(plant); },
           .lost = [&events](std::uint64_t count) { return events.lost(count); },
           .messages = [this](bool wanted) { return messages_.look(wanted); },
           .view = [this](std::string_view view) { return views_.look(view); },
           .command = [this](const serve::WebUser& user, std::string_view command, std::uint32_t id,
                             serve::WebReply reply) { commands_.run(user, command, id, std::move(reply)); }},
          {.role = serve::WebRole::configure, .key = make_key()}, std::move(report)) {}

std::expected<void, std::string> WebPage::listen(const text::HostAndPort& place) {
  auto result = server_.listen(place.host, place.port);
  if (result) events_.set_listener([this](std::string_view event) { server_.event(event); });
  return result;
}

void WebPage::close() {
  events_.set_listener([](std::string_view) {});
  server_.stop();
}

}  // namespace canopus::cli
