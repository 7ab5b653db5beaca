#pragma once
// The parts of the page's server that its clients and the server itself share; for web_server.cpp and web_connection.cpp alone.

#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/link/tcp_clients.hpp"
#include "canopus/web/access/authenticator.hpp"
#include "canopus/web/server/send_queue.hpp"
#include "canopus/web/server/server.hpp"

namespace canopus::web {

struct WebServer::Parts : std::enable_shared_from_this<Parts> {
  Parts(boost::asio::io_context& io, link::LoopClock& the_clock, Use the_use, WebServerOptions the_options,
        link::ClientReport the_report)
      : clock(the_clock),
        use(std::move(the_use)),
        options(the_options),
        gate(
            std::make_shared<Authenticator>(io, options.gate,
                                            Authenticator::Use{.note = use.note,
                                                               .report =
                                                                   [the_report](const std::string& sentence) {
                                                                     if (the_report) the_report(sentence);
                                                                   }})),
        clients(io,
                {.allowed = gate->has_users() ? any_address() : link::AllowList(),
                 .most = the_options.maximum_clients},
                std::move(the_report)),
        latest(options.most_events),
        timer(io) {}

  void admit(boost::asio::ip::tcp::socket socket);
  /// It is not one of too many watchers: of its user, or without key and session of its network.
  [[nodiscard]] bool has_room_for_watcher(const Connection& newcomer) const;
  /// No more waits for all clients together than may.
  void limit_waiting();
  void watch();
  void show_state();
  /// Made anew, unless it was a moment ago and nothing has happened since: fifty pages that are opened at once get one.
  [[nodiscard]] const SendQueue::Text& newest_state();
  void show_messages();
  void show_views();
  /// One client a turn of the loop: a plant with many nodes and watchers has megabytes to send, and may not wait for all of them.
  void flush();
  void send_next();
  [[nodiscard]] static link::AllowList any_address() { return link::AllowList({link::Network{.prefix = 0}}); }

  link::LoopClock& clock;
  Use use;
  WebServerOptions options;
  std::shared_ptr<Authenticator> gate;
  link::TcpClients<Connection> clients;
  WebPlace place;
  WebEventList latest;    // for newcomers
  SendQueue::Text state;  // nullptr: something has happened since
  std::chrono::steady_clock::time_point state_made{};
  boost::asio::steady_timer timer;
  std::deque<std::shared_ptr<Connection>> to_send;  // empty: no turn of send_next() is due
  bool is_watched = false;                          // the timer runs
  bool is_viewed = false;                           // a client has views
  std::size_t first_viewer = 0;                     // of the connections, the one whose views are made next
  bool is_open = false;
};

}  // namespace canopus::web
