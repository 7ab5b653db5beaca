#pragma once

#include <chrono>
#include <functional>

namespace canopus::text {

/// The offset of local time from UTC at a moment, daylight saving time included; by the machine's zone (TZ,
/// /etc/localtime).
[[nodiscard]] std::chrono::seconds zone_offset(std::chrono::sys_seconds moment);

/// The local time at a moment.
[[nodiscard]] inline std::chrono::local_seconds local_time(
    std::chrono::sys_seconds moment,
    const std::function<std::chrono::seconds(std::chrono::sys_seconds)>& offset = zone_offset) {
  return std::chrono::local_seconds(moment.time_since_epoch() + offset(moment));
}

}  // namespace canopus::text
