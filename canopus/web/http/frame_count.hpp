#pragma once
// What a WebSocket client sends, counted before it is understood: a ping, or a message in a thousand parts, is work, too.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <boost/asio/associated_allocator.hpp>
#include <boost/asio/associated_executor.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace canopus::web {

/// Frames in a stream of bytes [RFC 6455 5.2]. No socket, no clock.
class WebFrameCount {
 public:
  /// A part of a message with so many bytes is not counted: the length of the message is a bound for those.
  static constexpr std::uint64_t large_part = 1024;

  /// Frames that count, among those whose head ends in these bytes, which follow those before.
  [[nodiscard]] unsigned count(std::span<const std::uint8_t> bytes) {
    unsigned frames = 0;
    while (!bytes.empty()) {
      const std::size_t data = static_cast<std::size_t>(std::min<std::uint64_t>(data_left_, bytes.size()));
      data_left_ -= data;
      bytes = bytes.subspan(data);
      if (bytes.empty()) break;
      head_[head_size_++] = bytes.front();
      bytes = bytes.subspan(1);
      if (head_size_ < whole_head()) continue;
      data_left_ = length();
      const bool continues = (head_[0] & 0x0FU) == 0;
      if (!continues || data_left_ < large_part) ++frames;
      head_size_ = 0;
    }
    return frames;
  }

 private:
  /// Bytes of the length behind the first two.
  [[nodiscard]] std::size_t length_bytes() const noexcept {
    const unsigned written = head_[1] & 0x7FU;
    return written == 127 ? 8 : written == 126 ? 2 : 0;
  }
  [[nodiscard]] std::size_t whole_head() const noexcept {
    if (head_size_ < 2) return 2;
    return 2 + length_bytes() + ((head_[1] & 0x80U) != 0 ? 4 : 0);  // with the mask
  }
  [[nodiscard]] std::uint64_t length() const noexcept {
    if (length_bytes() == 0) return head_[1] & 0x7FU;
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < length_bytes(); ++i) length = length << 8 | head_[2 + i];
    return length;
  }

  std::array<std::uint8_t, 14> head_{};
  std::size_t head_size_ = 0;
  std::uint64_t data_left_ = 0;
};

/// The socket below a WebSocket. What Beast reads by it is counted; with too many frames in a second reading fails.
class WebClientSocket : public boost::asio::ip::tcp::socket {
 public:
  explicit WebClientSocket(boost::asio::ip::tcp::socket socket)
      : boost::asio::ip::tcp::socket(std::move(socket)) {}

  void set_most_frames(unsigned a_second) { most_frames_ = a_second; }
  [[nodiscard]] bool has_sent_too_much() const noexcept { return has_sent_too_much_; }
  /// One frame counts no more in its second: the server has replied to it.
  void discount_frame() noexcept { frames_ -= frames_ > 0 ? 1 : 0; }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    boost::asio::ip::tcp::socket::async_read_some(
        buffers, Counted<std::decay_t<Handler>, Buffers>{*this, buffers, std::forward<Handler>(handler)});
  }

 private:
  template <typename Handler, typename Buffers>
  struct Counted {
    using executor_type =
        boost::asio::associated_executor_t<Handler, boost::asio::ip::tcp::socket::executor_type>;
    using allocator_type = boost::asio::associated_allocator_t<Handler>;
    [[nodiscard]] executor_type get_executor() const noexcept {
      return boost::asio::get_associated_executor(handler, socket.get_executor());
    }
    [[nodiscard]] allocator_type get_allocator() const noexcept {
      return boost::asio::get_associated_allocator(handler);
    }
    void operator()(boost::system::error_code error, std::size_t count) {
      if (socket.has_too_many(buffers, count)) error = boost::asio::error::no_buffer_space;
      handler(error, error ? 0 : count);
    }

    WebClientSocket& socket;
    Buffers buffers;
    Handler handler;
  };

  template <typename Buffers>
  bool has_too_many(const Buffers& buffers, std::size_t count) {
    const auto now = std::chrono::steady_clock::now();
    if (now - second_began_ > std::chrono::seconds(1)) {
      second_began_ = now;
      frames_ = 0;
    }
    for (auto one = boost::asio::buffer_sequence_begin(buffers);
         one != boost::asio::buffer_sequence_end(buffers) && count > 0; ++one) {
      const boost::asio::const_buffer part(*one);
      const std::size_t size = std::min(count, part.size());
      frames_ += counter_.count({static_cast<const std::uint8_t*>(part.data()), size});
      count -= size;
    }
    has_sent_too_much_ = frames_ > most_frames_;
    return has_sent_too_much_;
  }

  WebFrameCount counter_;
  unsigned most_frames_ = std::numeric_limits<unsigned>::max();
  unsigned frames_ = 0;
  bool has_sent_too_much_ = false;
  std::chrono::steady_clock::time_point second_began_{};
};

/// What Beast asks of a socket that is not its own kind.
template <typename Handler>
void async_teardown(boost::beast::role_type role, WebClientSocket& socket, Handler&& handler) {
  boost::beast::websocket::async_teardown(role, static_cast<boost::asio::ip::tcp::socket&>(socket),
                                          std::forward<Handler>(handler));
}
inline void teardown(boost::beast::role_type role, WebClientSocket& socket,
                     boost::system::error_code& error) {
  boost::beast::websocket::teardown(role, static_cast<boost::asio::ip::tcp::socket&>(socket), error);
}

}  // namespace canopus::web
