#pragma once
// A file descriptor kept in reserve. When the process has none left, a connection can still be taken, to send its
// client so, instead of leaving it to wait without an answer.

#include <boost/asio/ip/tcp.hpp>
#include <fcntl.h>
#include <unistd.h>

namespace canopus::link {

class SpareDescriptor {
 public:
  SpareDescriptor() { reserve(); }
  ~SpareDescriptor() { release(); }
  SpareDescriptor(const SpareDescriptor&) = delete;
  SpareDescriptor& operator=(const SpareDescriptor&) = delete;

  /// Takes the next connection that waits, with the reserve, and hands its socket to `refuse`, which does not keep
  /// it. False when none could be taken; the acceptor must not block.
  template <typename Refuse>
  bool refuse_next(boost::asio::ip::tcp::acceptor& acceptor, Refuse refuse) {
    if (file_ < 0) reserve();
    if (file_ < 0) return false;
    release();
    boost::system::error_code error;
    {
      boost::asio::ip::tcp::socket socket(acceptor.get_executor());
      acceptor.accept(socket, error);
      if (!error) refuse(socket);
    }
    reserve();
    return !error;
  }

 private:
  void reserve() { file_ = ::open("/dev/null", O_RDONLY | O_CLOEXEC); }
  void release() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  int file_ = -1;
};

}  // namespace canopus::link
