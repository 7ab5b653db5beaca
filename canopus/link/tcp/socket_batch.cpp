#include "canopus/link/tcp/socket_batch.hpp"

#include <algorithm>
#include <cerrno>
#include <new>

#include <liburing.h>
#include <sys/socket.h>

namespace canopus::link {

namespace {

constexpr unsigned ring_size = 32;
constexpr int not_done = -1;  // no errno is negative

// As nothing waits, the kernel does each of these at once, or says that it cannot.

void prepare(io_uring_sqe& entry, const BatchedRead& read) noexcept {
  ::io_uring_prep_recv(&entry, read.socket->native_handle(), read.bytes.data(), read.bytes.size(),
                       MSG_DONTWAIT);
}

void prepare(io_uring_sqe& entry, const BatchedWrite& write) noexcept {
  ::io_uring_prep_send(&entry, write.socket->native_handle(), write.bytes.data(), write.bytes.size(),
                       MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace

class SocketBatch::Ring {
 public:
  Ring() noexcept : is_open_(::io_uring_queue_init(ring_size, &ring_, 0) == 0) {}
  ~Ring() {
    if (is_open_) ::io_uring_queue_exit(&ring_);
  }
  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;

  [[nodiscard]] bool is_open() const noexcept { return is_open_; }

  /// False: the ring is of no use any more. Those that were done have their result all the same.
  template <typename Transfer>
  bool run(std::span<Transfer> transfers) noexcept {
    while (!transfers.empty()) {
      const auto some = transfers.first(std::min<std::size_t>(transfers.size(), ring_size));
      if (!run_some(some)) return false;
      transfers = transfers.subspan(some.size());
    }
    return true;
  }

 private:
  template <typename Transfer>
  bool run_some(std::span<Transfer> transfers) noexcept {
    for (Transfer& transfer : transfers) {
      io_uring_sqe& entry = *::io_uring_get_sqe(&ring_);
      prepare(entry, transfer);
      ::io_uring_sqe_set_data(&entry, &transfer);
    }
    for (auto left = static_cast<unsigned>(transfers.size()); left > 0;) {
      const int submitted = ::io_uring_submit_and_wait(&ring_, left);
      for (io_uring_cqe* done = nullptr; ::io_uring_peek_cqe(&ring_, &done) == 0; --left) {
        auto& transfer = *static_cast<Transfer*>(::io_uring_cqe_get_data(done));
        if (done->res < 0)
          transfer.result = {.error = -done->res};
        else
          transfer.result = {.count = static_cast<std::size_t>(done->res)};
        ::io_uring_cqe_seen(&ring_, done);
      }
      if (submitted < 0 && submitted != -EINTR) return false;
    }
    return true;
  }

  io_uring ring_{};
  bool is_open_;
};

SocketBatch::SocketBatch(Way way) : way_(way) {}
SocketBatch::~SocketBatch() = default;

template <typename Transfer>
void SocketBatch::try_together(std::span<Transfer> transfers) noexcept {
  for (Transfer& transfer : transfers) transfer.result = {.error = not_done};
  if (transfers.size() < 2 || way_ == Way::one_by_one) return;
  if (ring_ == nullptr) ring_.reset(new (std::nothrow) Ring);
  if (ring_ != nullptr && ring_->is_open() && ring_->run(transfers)) return;
  way_ = Way::one_by_one;
  ring_.reset();
}

template <typename Byte>
void SocketBatch::run(std::span<BatchedTransfer<Byte>> transfers, Alone<Byte> alone, Told told) noexcept {
  try_together(transfers);
  for (auto& [socket, bytes, result] : transfers) {
    if (result.error == not_done || result.error == EINTR)
      result = (socket->*alone)(bytes);
    else
      (socket->*told)(result, bytes.size());
  }
}

void SocketBatch::read(std::span<BatchedRead> reads) noexcept {
  run(reads, &WatchedSocket::read, &WatchedSocket::has_read);
}

void SocketBatch::write(std::span<BatchedWrite> writes) noexcept {
  run(writes, &WatchedSocket::write, &WatchedSocket::has_written);
}

}  // namespace canopus::link
