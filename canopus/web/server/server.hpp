#pragma once
// The server behind the page of a run: HTTP/1.1 for the page's files, a WebSocket for what happens. It runs on the
// event loop that owns the plant, in its thread. A client chooses what it sees; its commands are handed on with its user.
//
// Each message of the WebSocket is a JSON array of events (docs/events.md): first the state and the latest events, then
// what comes. Clients cannot disturb each other or the plant: each has at most one message under way and bounded memory; one that is
// slow gets the newest state, and a `lost` event in place of the events that it missed. A request has a bounded head and,
// but for the forms of users, no body, has to be whole within a few seconds, and gets one answer.

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
#include "canopus/web/access/authenticator.hpp"
#include "canopus/web/access/user.hpp"
#include "canopus/web/http/page_files.hpp"

namespace canopus::web {

struct WebServerOptions {
  /// When there are so many, the oldest request that is not whole or is answered gives way to a further client, then the oldest
  /// watcher without key and session; if all have one, the further client is refused.
  std::size_t maximum_clients = 64;
  /// Connections of one address without key and session: requests that are not whole or are answered (then the oldest gives way), and
  /// watchers (a further one is refused).
  std::size_t most_requests_of_address = 32;
  std::size_t most_watchers_of_address = 50;
  /// Watchers of one user, from whatever addresses (a further one is refused): others find a place all the same.
  std::size_t most_watchers_of_user = 16;
  /// From the connection to the end of the request's head.
  std::chrono::milliseconds head_timeout{5000};
  /// For an answer or a message that the client does not take.
  std::chrono::milliseconds send_timeout{15000};
  /// A watcher from which nothing comes for so long, not even an answer to a ping, is closed.
  std::chrono::milliseconds silent_timeout{45000};
  /// What a client may do who knows the key; without one any client. Others have the role look.
  WebRole role = WebRole::look;
  std::string key{};
  /// Users with passwords, in place of the key, and limits. Without users the server takes clients of this machine alone.
  WebGateOptions gate{};
  /// WebPlace::origin
  std::string origin{};
  /// WebPlace::files
  std::shared_ptr<const PageFiles> files{};
  /// From one state to the next.
  std::chrono::milliseconds state_interval{250};
  /// A newcomer gets the state that was made so lately, unless an event or a reply came after it.
  std::chrono::milliseconds state_is_new_for{100};
  /// Events that wait for a slow client; of those a newcomer gets.
  std::size_t most_events = 500;
  /// Bytes that wait for all clients together; then the one for which most wait is closed.
  std::size_t most_waiting_bytes = 64U << 20;
  /// A message of a client, and of one that may change something (a command brings a device file along); messages, pings, pongs and
  /// small parts of messages that it may send in a second (frame_count.hpp). What was replied to counts no more if its
  /// client may change something: a program that waits for each reply may be as fast as the replies. The page of who only looks
  /// asks for lines of a trace with each picture of a screen that is scrolled, 60 a second, and says what is looked at.
  std::size_t longest_message = 1024;
  std::size_t longest_command = 2U << 20;
  unsigned most_messages = 100;
  /// Different views that are made with one state, and up to three more; other clients get theirs with the next ones, in turn.
  std::size_t most_views = 8;
};

/// Takes the replies to a command, events as JSON, for the client that sent it; in the loop's thread. The client may have gone.
using WebReply = std::function<void(std::string event)>;

class WebServer {
 public:
  /// The `state` event as JSON, with the plant's time at now; and the `lost` event for so many events.
  struct Use {
    std::function<std::string()> state{};
    std::function<std::string(std::uint64_t)> lost{};
    /// The `messages` event of what came since the last call, or an empty text; false: no client wants them.
    std::function<std::string(bool)> messages{};
    /// The event of a view that a client has asked for, an object of {"views": [...]} as JSON; an empty text: it is none. Asked with an empty
    /// text when no client has views any more.
    std::function<std::string(std::string_view)> view{};
    /// What a client wants to be done, an object as JSON, with the number that its replies have. Without it commands are ignored.
    std::function<void(const WebUser& user, std::string_view command, std::uint32_t id, WebReply reply)>
        command{};
    /// Somebody logged in or out, or failed to: code 0, else why not (docs/web.md).
    std::function<void(const WebUser& user, const std::string& what, int code)> note{};
  };

  /// `context` and `clock` must outlive the server.
  WebServer(boost::asio::io_context& context, link::LoopClock& clock, Use use, WebServerOptions options = {},
            link::ClientReport report = {});
  /// Stops.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Starts to accept. `host` is an address in numbers, or localhost; another one than of this machine alone needs users. Port 0
  /// takes a free one. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  /// "http://127.0.0.1:8080/", with a key "http://127.0.0.1:8080/#key=0123..."
  [[nodiscard]] std::string url() const;
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Connections now.
  [[nodiscard]] std::size_t clients() const noexcept;
  /// An event, a JSON object, for all clients that watch. May be called from inside of the timeline.
  void event(std::string_view json);
  /// Closes the port and all connections.
  void stop() noexcept;

 private:
  struct Parts;                   // web_parts.hpp
  class Connection;               // web_connection.hpp
  std::shared_ptr<Parts> parts_;  // also held by handlers that wait in the context
};

}  // namespace canopus::web
