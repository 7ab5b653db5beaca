#pragma once
// A TCP socket that its owner reads and writes himself, and that tells him when there is something to read or room to
// write.
//
// Boost.Asio's own reads ask the system once more after each read that found something, as it tells of news alone. A
// server of short requests need not: a read that does not fill its space has nearly always left nothing behind. Where it
// has (the end of the stream came with the bytes, or urgent data among them), nobody tells of it: is_doubtful(), and the
// owner reads once more after a while.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

namespace canopus::link {

class WatchedSocket {
 public:
  /// Hears of the socket, from the event loop.
  class User {
   public:
    /// There may be something to read.
    virtual void can_read() = 0;
    /// There may be room to write.
    virtual void can_write() = 0;

   protected:
    ~User() = default;
  };
  struct Transfer {
    std::size_t count = 0;  ///< bytes
    int error = 0;          ///< errno; without one, a read of 0 bytes is the end of the stream
    /// There was nothing to read, or no room to write.
    [[nodiscard]] bool has_to_wait() const noexcept;
  };

  /// Takes a connected socket over. `context` is its event loop, `user` outlives what is waited for.
  WatchedSocket(boost::asio::io_context& context, boost::asio::ip::tcp::socket socket, User& user);
  /// close()
  ~WatchedSocket();
  WatchedSocket(const WatchedSocket&) = delete;
  WatchedSocket& operator=(const WatchedSocket&) = delete;

  /// `space` is not empty.
  [[nodiscard]] Transfer read(std::span<std::uint8_t> space) noexcept;
  /// No signal comes of a client that is gone.
  [[nodiscard]] Transfer write(std::span<const std::uint8_t> data) noexcept;

  /// User::can_read() is called once; from the event loop, not inside of this. One wait at a time. `keeper` holds user and
  /// socket until then: neither may be destroyed while something is waited for, also after close().
  void wait_to_read(std::shared_ptr<void> keeper);
  /// The same with User::can_write(), after a write that had to wait.
  void wait_to_write(std::shared_ptr<void> keeper);
  /// Something may be left of which nobody tells.
  [[nodiscard]] bool is_doubtful() const noexcept { return is_doubtful_; }

  /// Negative: it is closed, or the system has no memory to watch it.
  [[nodiscard]] int native_handle() const noexcept;
  /// Ends the connection in both directions. The user hears nothing any more.
  void close() noexcept;

 private:
  friend class SocketBatch;
  /// What read() and write() keep of their result.
  void has_read(const Transfer& result, std::size_t space) noexcept;
  void has_written(const Transfer& result, std::size_t size) noexcept;

  struct Parts;
  std::unique_ptr<Parts> parts_;
  bool is_doubtful_ = false;  // the last read found something
};

}  // namespace canopus::link
