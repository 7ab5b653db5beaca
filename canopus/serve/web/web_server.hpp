#pragma once
// The server behind the page of a run: HTTP/1.1 for the page's files, a WebSocket for what happens. It runs on the
// event loop that owns the plant, in its thread. It only shows: a client chooses what it
// sees, and nothing that it sends changes the plant.
//
// Each message of the WebSocket is a JSON array of events (docs/events.md): first the state and the latest events, then
// what comes. Clients cannot disturb each other or the plant: each has at most one message under way and bounded memory; one that is
// slow gets the newest state, and a `lost` event in place of the events that it missed. A request has a bounded head and
// no body, has to be whole within a few seconds, and gets one answer.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>

#include "canopus/link/loop_clock.hpp"
#include "canopus/link/peer.hpp"

namespace canopus::serve {

struct WebServerOptions {
  /// Further clients are refused.
  std::size_t maximum_clients = 64;
  /// From the connection to the end of the request's head.
  std::chrono::milliseconds head_timeout{5000};
  /// For an answer or a message that the client does not take.
  std::chrono::milliseconds send_timeout{15000};
  /// A watcher from which nothing comes for so long, not even an answer to a ping, is closed.
  std::chrono::milliseconds silent_timeout{45000};
  /// From one state to the next.
  std::chrono::milliseconds state_interval{250};
  /// Events that wait for a slow client; of those a newcomer gets.
  std::size_t most_events = 500;
  /// A message of a client; what it may send in a second.
  std::size_t longest_message = 1024;
  unsigned most_messages = 20;
  /// Different views that are made with one state, and up to three more; other clients get theirs with the next ones, in turn.
  std::size_t most_views = 8;
};

class WebServer {
 public:
  /// The `state` event as JSON, with the plant's time at now; and the `lost` event for so many events.
  struct Use {
    std::function<std::string()> state{};
    std::function<std::string(std::uint64_t)> lost{};
    /// The `messages` event of what came since the last call, or an empty text; false: nobody wants them.
    std::function<std::string(bool)> messages{};
    /// The event of what somebody looks at, an object of {"views": [...]} as JSON; an empty text: it is none. Asked with an empty
    /// text when nobody looks any more.
    std::function<std::string(std::string_view)> view{};
  };

  /// `context` and `clock` must outlive the server.
  WebServer(boost::asio::io_context& context, link::LoopClock& clock, Use use, WebServerOptions options = {},
            link::ClientReport report = {});
  /// Stops.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Starts to accept. `host` is a loopback address in numbers, or localhost; port 0 takes a free one. The error is a
  /// sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  /// "http://127.0.0.1:8080/"
  [[nodiscard]] std::string url() const;
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Connections now.
  [[nodiscard]] std::size_t clients() const noexcept;
  /// An event, a JSON object, for everybody who watches. May be called from inside of the timeline.
  void event(std::string_view json);
  /// Closes the port and all connections.
  void stop() noexcept;

 private:
  struct Parts;
  class Connection;
  std::shared_ptr<Parts> parts_;  // also held by handlers that wait in the context
};

}  // namespace canopus::serve
