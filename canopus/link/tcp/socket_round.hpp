#pragma once
// The sockets of a server that have something to read at the same time are served together: all read, then all are
// answered, then all reply, with one call of the system for all reads and one for all writes (socket_batch.hpp).
//
// A round is what one turn of the event loop finds. A socket that is alone, or that was the last one served, does better
// without one: whoever asks again and again by himself does not wait for others.

#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/link/tcp/socket_batch.hpp"

namespace canopus::link {

class SocketRound : public std::enable_shared_from_this<SocketRound> {
 public:
  /// Who is served, by these four in turn. Any of them may close the sockets of all.
  class User {
   public:
    virtual ~User() = default;
    /// Where it reads to; nothing: it is not served now.
    virtual BatchedRead begin() = 0;
    /// It has read. All hear of theirs before anybody replies. False: it is left alone.
    virtual bool hear(const WatchedSocket::Transfer& came) = 0;
    /// What it replies at once, which may be nothing; no socket: it is left alone.
    virtual BatchedWrite reply() = 0;
    /// So much of its reply was sent. The rest is its own matter.
    virtual void go_on(const WatchedSocket::Transfer& sent) = 0;
  };

  /// `context` is the event loop of the sockets.
  explicit SocketRound(boost::asio::io_context& context) : context_(context) {}

  /// Whether this one, which has something to read, is to read and reply by itself now, without a round: nobody is to be
  /// served, and nobody else can be (`alone`), or it was the last one.
  [[nodiscard]] bool goes_alone(const User& user, bool alone) noexcept {
    if (!ready_.empty() || !(alone || served_last_ == &user)) return false;
    served_last_ = &user;
    return true;
  }
  /// It is served with the others that this turn of the loop finds. Once until then.
  void join(std::shared_ptr<User> user);

 private:
  void serve_ready();

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
