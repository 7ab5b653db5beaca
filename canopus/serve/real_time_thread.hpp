#pragma once
// System settings for a real-time thread.

#include <optional>
#include <string>
#include <vector>

namespace canopus::serve {

struct RealTimeThread {
  /// Priority of SCHED_FIFO, 1..99: above everything that is not itself in real time, below the kernel's own threads (50)
  /// that bring the frames.
  int priority = 40;
  std::optional<unsigned> processor{};  ///< the only one it runs on
};

/// Asks for SCHED_FIFO, memory that is not paged out, and a processor, for the calling thread (memory: the
/// process). Refused requests are returned as sentences with the remedy; the thread continues without them.
[[nodiscard]] std::vector<std::string> request_real_time(const RealTimeThread& wanted);

}  // namespace canopus::serve
