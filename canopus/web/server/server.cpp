#include "canopus/web/server/server.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "canopus/web/server/connection.hpp"
#include "canopus/web/server/server_parts.hpp"

namespace canopus::web {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using MonotonicClock = std::chrono::steady_clock;

void WebServer::Parts::admit(tcp::socket socket) {
  if (!clients.may_connect(socket)) return;
  std::string name = link::name_of_peer(socket);
  const auto now = MonotonicClock::now();
  const auto asks_from_there = [network = network_of(link::address_of_peer(socket))](const Connection& one) {
    return one.place().hold == link::Hold::none && one.network() == network;
  };
  const auto asking =
      std::ranges::count_if(clients.all(), [&](const auto& one) { return asks_from_there(*one); });
  if (std::cmp_greater_equal(asking, options.most_requests_of_address))
    clients.give_way(name, now, asks_from_there);
  if (!clients.make_room(name, now)) return;
  clients.add(std::make_shared<Connection>(*this, std::move(socket), std::move(name)))->start();
}

bool WebServer::Parts::has_room_for_watcher(const Connection& newcomer) const {
  if (newcomer.user() == nullptr && newcomer.knows_key()) return true;
  const auto counts = [&](const auto& one) {
    if (!one->has_place_of_watcher()) return false;
    if (newcomer.user() != nullptr) return one->user() != nullptr && *one->user() == *newcomer.user();
    return one->user() == nullptr && !one->knows_key() && one->network() == newcomer.network();
  };
  const std::size_t most =
      newcomer.user() != nullptr ? options.most_watchers_of_user : options.most_watchers_of_address;
  return std::cmp_less(std::ranges::count_if(clients.all(), counts), most);
}

void WebServer::Parts::limit_waiting() {
  std::size_t all = 0;
  for (const auto& one : clients.all()) all += one->waiting_bytes();
  if (all <= options.most_waiting_bytes) return;
  const auto most =
      *std::ranges::max_element(clients.all(), {}, [](const auto& one) { return one->waiting_bytes(); });
  most->end("does not take the replies to its commands");
}

/// States are made as long as a client watches.
void WebServer::Parts::watch() {
  if (std::exchange(is_watched, true)) return;
  timer.expires_after(options.state_interval);
  timer.async_wait([self = shared_from_this()](const error_code& error) {
    if (error || !self->is_open) return;
    self->is_watched = false;
    self->gate->refresh(MonotonicClock::now());
    const auto watchers = self->clients.all();
    for (const auto& one : watchers) one->end_if_over(MonotonicClock::now());
    if (std::ranges::none_of(self->clients.all(), [](const auto& one) { return one->watches(); })) {
      if (self->use.messages) (void)self->use.messages(false);
      self->show_views();
      return;
    }
    self->watch();
    self->show_state();
  });
}

const SendQueue::Text& WebServer::Parts::newest_state() {
  if (state == nullptr || MonotonicClock::now() - state_made > options.state_is_new_for) {
    state = std::make_shared<const std::string>(use.state());
    state_made = MonotonicClock::now();
  }
  return state;
}

/// One text for all.
void WebServer::Parts::show_state() {
  (void)clock.now();
  if (!is_open) return;  // the run ended on the way there
  state = nullptr;
  const SendQueue::Text text = newest_state();
  for (const auto& connection : clients.all()) {
    if (connection->watches()) connection->set_state(text);
  }
  show_messages();
  show_views();
  flush();
}

void WebServer::Parts::show_messages() {
  if (!use.messages) return;
  const auto wants = [](const auto& one) { return one->wants_messages(); };
  std::string event = use.messages(std::ranges::any_of(clients.all(), wants));
  if (event.empty()) return;
  const auto text = std::make_shared<const std::string>(std::move(event));
  for (const auto& connection : clients.all()) {
    if (wants(connection)) connection->set_messages(text);
  }
}

/// What several look at is made once, and of all that they look at not so much at a time that it would delay the plant.
void WebServer::Parts::show_views() {
  if (!use.view) return;
  std::map<std::string_view, SendQueue::Text> made;
  for (std::size_t turn = 0; turn < clients.size(); ++turn) {
    if (made.size() >= options.most_views) break;
    const auto& connection = clients.all()[++first_viewer % clients.size()];
    if (!connection->watches()) continue;
    for (std::size_t i = 0; i < connection->views().size(); ++i) {
      const std::string& view = connection->views()[i];
      const auto [text, is_new] = made.try_emplace(view);
      if (is_new) text->second = std::make_shared<const std::string>(use.view(view));
      if (!text->second->empty()) connection->set_view(i, text->second);
    }
  }
  if (made.empty() && is_viewed) (void)use.view({});
  is_viewed = !made.empty();
}

void WebServer::Parts::flush() {
  const bool is_due = !to_send.empty();
  to_send.assign(clients.all().begin(), clients.all().end());
  if (!is_due) send_next();
}

void WebServer::Parts::send_next() {
  if (to_send.empty()) return;
  const std::shared_ptr<Connection> next = std::move(to_send.front());
  to_send.pop_front();
  next->send();
  if (to_send.empty()) return;
  asio::post(timer.get_executor(), [self = shared_from_this()] { self->send_next(); });
}

WebServer::WebServer(asio::io_context& context, link::LoopClock& clock, Use use, WebServerOptions options,
                     link::ClientReport report)
    : parts_(std::make_shared<Parts>(context, clock, std::move(use), options, std::move(report))) {}

WebServer::~WebServer() { stop(); }

std::expected<void, std::string> WebServer::listen(const std::string& host, std::uint16_t port) {
  const std::string address = host == "localhost" ? "127.0.0.1" : host;
  const auto parsed = link::parse_internet_address(address);
  if (!parsed) return std::unexpected(fmt::format("{}: {}", host, parsed.error()));
  if (!link::is_loopback(*parsed) && !parts_->gate->has_users()) {
    return std::unexpected(
        fmt::format("{}: the page is for this machine alone unless it has users (canopus web-users); "
                    "expected 127.0.0.1 or ::1 (from another machine: ssh -L)",
                    host));
  }
  auto result = parts_->clients.listen(
      address, port, [parts = parts_](tcp::socket socket) { parts->admit(std::move(socket)); });
  parts_->is_open = result.has_value();
  parts_->place = {.address = address,
                   .port = parts_->clients.port(),
                   .origin = parts_->options.origin,
                   .has_users = parts_->gate->has_users(),
                   .files = parts_->options.files};
  return result;
}

std::string WebServer::url() const {
  if (!parts_->place.origin.empty()) return parts_->place.origin + '/';
  const std::string& address = parts_->place.address;
  const std::string place = address.find(':') == std::string::npos ? address : fmt::format("[{}]", address);
  const std::string& key = parts_->options.key;
  return fmt::format("http://{}:{}/{}", place, port(),
                     key.empty() || parts_->gate->has_users() ? "" : "#key=" + key);
}

std::uint16_t WebServer::port() const noexcept { return parts_->clients.port(); }

std::size_t WebServer::clients() const noexcept { return parts_->clients.size(); }

/// Goes out with the next state: nothing is written inside of the timeline, and a thousand events are one message.
void WebServer::event(std::string_view json) {
  const auto text = std::make_shared<const std::string>(json);
  parts_->latest.add(text);
  parts_->state = nullptr;
  for (const auto& connection : parts_->clients.all()) {
    if (connection->watches()) connection->add_event(text);
  }
}

void WebServer::stop() noexcept {
  parts_->is_open = false;
  error_code ignored;
  parts_->timer.cancel(ignored);
  parts_->to_send.clear();
  parts_->clients.close();
}

}  // namespace canopus::web
