#pragma once
// The sockets of a server that have something to read at the same time are served together: all read, then all are
// answered, then all reply, with one call of the system for all reads and one for all writes (socket_batch.hpp).
//
// A round is what one turn of the event loop finds. A socket that is alone, or that was the last one served, is served at
// once: whoever asks again and again by himself does not wait for others.

#include <memory>
#include <span>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/link/tcp/socket_batch.hpp"

namespace canopus::link {

class SocketRound : public std::enable_shared_from_this<SocketRound> {
 public:
  /// Who is served, by these three in turn. Any of them may close the sockets of all.
  class User {
   public:
    virtual ~User() = default;
    /// Where it reads to; nothing: it is not served now.
    virtual BatchedRead begin() = 0;
    /// It has read. What it replies at once, which may be nothing; no socket: it is left alone.
    virtual BatchedWrite reply(const WatchedSocket::Transfer& came) = 0;
    /// So much of its reply was sent. The rest is its own matter.
    virtual void go_on(const WatchedSocket::Transfer& sent) = 0;
  };

  /// `context` is the event loop of the sockets.
  explicit SocketRound(boost::asio::io_context& context) : context_(context) {}

  /// With the others that this turn of the loop finds. `alone`: nobody else can be. Once until it is served.
  void join(std::shared_ptr<User> user, bool alone);
  /// Now, and nobody else.
  void serve(const std::shared_ptr<User>& user);

 private:
  void serve_ready();
  void serve_all(std::span<const std::shared_ptr<User>> some);

  boost::asio::io_context& context_;
  std::vector<std::shared_ptr<User>> ready_;
  std::vector<std::shared_ptr<User>> served_;
  const User* served_last_ = nullptr;  // not to be looked into: it may be gone
  SocketBatch batch_;
  std::vector<BatchedRead> reads_;
  std::vector<BatchedWrite> writes_;
  std::vector<User*> users_;  // whose reads these are, and then whose writes
};

}  // namespace canopus::link
