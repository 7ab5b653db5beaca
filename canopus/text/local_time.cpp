#include "canopus/text/local_time.hpp"

#include <ctime>

namespace canopus::text {

std::chrono::seconds zone_offset(std::chrono::sys_seconds moment) {
  const std::time_t seconds = moment.time_since_epoch().count();
  std::tm fields{};
  if (::localtime_r(&seconds, &fields) == nullptr) return {};
  return std::chrono::seconds(fields.tm_gmtoff);
}

}  // namespace canopus::text
