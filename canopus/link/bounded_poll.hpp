#pragma once
// Runs the ready handlers of an io_context, in bounded portions. A peer that sends without pause always has
// the next handler ready: io_context::poll() would then never return, and neither clock nor signals would be
// read.

#include <chrono>
#include <cstddef>

#include <boost/asio/io_context.hpp>

namespace canopus::link {

/// Handlers of one portion: more than the datagrams and reads that a socket's buffer has room for.
inline constexpr std::size_t most_handlers_at_once = 512;
/// Machine's time of one portion; the handler that is under way at its end is finished.
inline constexpr std::chrono::milliseconds longest_portion{100};

/// Runs handlers that are ready until there are none, the portion is used up, or `is_enough()`.
template <typename IsEnough>
void poll_portion(boost::asio::io_context& io, IsEnough is_enough) {
  const auto end = std::chrono::steady_clock::now() + longest_portion;
  for (std::size_t count = 0; count < most_handlers_at_once && !is_enough(); ++count) {
    if (io.poll_one() == 0 || std::chrono::steady_clock::now() >= end) return;
  }
}

}  // namespace canopus::link
