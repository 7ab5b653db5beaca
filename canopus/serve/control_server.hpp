#pragma once
// The control server of a plant: a TCP server that answers lines of JSON (device_control.hpp, docs/control.md).
// It runs on the event loop that owns the plant, in its thread.
//
// Clients cannot disturb each other or the plant: lines have a greatest length, requests of a client that
// does not read its answers are not processed, and its connection is closed after a while; an idle client is
// closed when all connections are in use. A connection that its client did not end is reported.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "canopus/link/allow_list.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/link/peer.hpp"

namespace canopus::serve {

struct ControlServerOptions {
  link::AllowList allowed{};  ///< clients that may connect
  /// A further client takes the place of the one from which nothing has come for the longest time, and which
  /// waits for no answer; when that is shorter than `gives_way_after`, it is closed at once.
  std::size_t maximum_clients = 16;
  std::chrono::milliseconds gives_way_after{10000};
  /// Longest request without its line feed. A longer one is answered with an error and ends the connection.
  std::size_t longest_line = 4096;
  /// From the beginning of a request to its line feed.
  std::chrono::milliseconds half_line_timeout{5000};
  /// From an answer that the client does not take to the end of its connection.
  std::chrono::milliseconds send_timeout{30000};
  /// Most bytes of further lines that are read while a client waits for an answer.
  std::size_t most_waiting = 65536;
};

class ControlServer {
 public:
  /// Takes the answer to a line, with its line feed, once: at once or later, on the loop's thread.
  using Reply = std::function<void(std::string answer)>;
  /// Called when the client has left before its answer came. Empty: there is nothing to call off.
  using CallOff = std::function<void()>;
  using Answer = std::function<CallOff(std::string_view line, Reply reply)>;

  /// `context` and `clock` must outlive the server. `answer` is called with the plant's time at now. Further
  /// lines of the client wait until the reply has come.
  ControlServer(boost::asio::io_context& context, link::LoopClock& clock, Answer answer,
                ControlServerOptions options = {}, link::ClientReport report = {});
  /// Stops.
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// Starts to accept. `host` is an address or a name; port 0 takes a free one. The error is a sentence.
  [[nodiscard]] std::expected<void, std::string> listen(const std::string& host, std::uint16_t port);
  /// The port it listens on, 0 before listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Clients connected now.
  [[nodiscard]] std::size_t clients() const noexcept;
  /// Closes the port and all connections.
  void stop() noexcept;

 private:
  struct Parts;
  class Connection;
  std::shared_ptr<Parts> parts_;  // also held by handlers that wait in the context
};

}  // namespace canopus::serve
