#pragma once
// The latencies of a plant on this machine: those of SYNC and of answers, measured by another program, beside
// those of a thread that only sleeps.

#include <chrono>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "canopus/link/bus_address.hpp"
#include "canopus/serve/histogram.hpp"
#include "canopus/serve/real_time_thread.hpp"

namespace canopus::serve {

struct JitterOptions {
  std::optional<link::BusAddress> bus{};  ///< none: a pair of sockets of this process
  std::uint32_t bit_rate = 250'000;       ///< bit/s, of that bus
  std::chrono::nanoseconds period{};      ///< of SYNC and of the sleep, whole milliseconds
  std::chrono::nanoseconds length{};      ///< of each of the two parts
  std::optional<RealTimeThread> real_time{};
};

struct JitterResult {
  Histogram sleep;     ///< how late a thread woke up that did nothing else, against the most punctual time
  Histogram sync;      ///< how late SYNC came, against the most punctual one
  Histogram response;  ///< from an SDO request to its answer, without the bus where it is a pair of sockets
  std::vector<std::string> refused{};  ///< of the real-time scheduling
};

/// Takes twice the length: first the sleep alone, then the plant (node 1, with SYNC and an SDO server). The error is a sentence.
[[nodiscard]] std::expected<JitterResult, std::string> measure_jitter(const JitterOptions& options);

}  // namespace canopus::serve
