#pragma once
// Reads or writes many sockets by one call of the system: by io_uring, where the kernel has it and lets us. Elsewhere, and
// where it is one socket alone, one after the other.
//
// A call costs a server of short requests a part of what it does at all; and a server that goes to the kernel and back for
// each reply lets the client that it has just woken come in between.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "canopus/link/tcp/watched_socket.hpp"

namespace canopus::link {

template <typename Byte>
struct BatchedTransfer {
  WatchedSocket* socket = nullptr;
  std::span<Byte> bytes{};  ///< not empty
  WatchedSocket::Transfer result{};
};
/// WatchedSocket::read() in a batch.
using BatchedRead = BatchedTransfer<std::uint8_t>;
/// WatchedSocket::write() in a batch.
using BatchedWrite = BatchedTransfer<const std::uint8_t>;

class SocketBatch {
 public:
  enum class Way : std::uint8_t {
    together,  ///< where the system lets us
    one_by_one,
  };
  /// Asks the system for nothing yet.
  explicit SocketBatch(Way way = Way::together);
  ~SocketBatch();
  SocketBatch(const SocketBatch&) = delete;
  SocketBatch& operator=(const SocketBatch&) = delete;

  /// Of open sockets, each of them once. Nothing waits.
  void read(std::span<BatchedRead> reads) noexcept;
  void write(std::span<BatchedWrite> writes) noexcept;
  /// What the last batch of more than one was done by.
  [[nodiscard]] Way way() const noexcept { return way_; }

 private:
  class Ring;
  template <typename Byte>
  using Alone = WatchedSocket::Transfer (WatchedSocket::*)(std::span<Byte>);
  using Told = void (WatchedSocket::*)(const WatchedSocket::Transfer& result, std::size_t size);
  template <typename Transfer>
  void try_together(std::span<Transfer> transfers) noexcept;
  template <typename Byte>
  void run(std::span<BatchedTransfer<Byte>> transfers, Alone<Byte> alone, Told told) noexcept;

  Way way_;
  std::unique_ptr<Ring> ring_;
};

}  // namespace canopus::link
