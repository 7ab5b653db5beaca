#include "canopus/text/repeated_lines.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace canopus::text {

bool RepeatedLines::passes(std::string_view line, can::Time now) {
  std::string key(line);
  if (bursts_.size() >= most_lines && !bursts_.contains(key)) {
    forget(now);
    if (bursts_.size() >= most_lines) return true;
  }
  const auto [place, is_new] = bursts_.try_emplace(std::move(key));
  Burst& burst = place->second;
  const bool goes_on = !is_new && now - burst.last < pause;
  if (!goes_on && burst.count <= printed_ones) burst = {.number = ++begun_};
  burst.last = now;
  ++burst.count;
  if (burst.count <= printed_ones) return true;
  look_at_ = std::min(look_at_, now + pause);
  return false;
}

std::vector<std::string> RepeatedLines::ended(can::Time now) {
  std::vector<std::string> lines;
  if (now < look_at_) return lines;
  std::vector<std::pair<std::uint64_t, std::string>> counted;
  look_at_ = can::never;
  for (auto place = bursts_.begin(); place != bursts_.end();) {
    const auto& [line, burst] = *place;
    const bool has_ended = now == can::never || now - burst.last >= pause;
    if (has_ended && burst.count > printed_ones) {
      counted.emplace_back(
          burst.number, fmt::format("{} (×{}, last {:.1f} s)", line, burst.count, can::seconds(burst.last)));
    }
    if (!has_ended && burst.count > printed_ones) look_at_ = std::min(look_at_, burst.last + pause);
    place = has_ended ? bursts_.erase(place) : std::next(place);
  }
  std::ranges::sort(counted);
  for (auto& [number, line] : counted) lines.push_back(std::move(line));
  return lines;
}

/// Makes room: lines that were not counted and do not come any more.
void RepeatedLines::forget(can::Time now) {
  if (now < forget_at_) return;
  forget_at_ = now + pause / 4;
  std::erase_if(bursts_, [&](const auto& entry) {
    return entry.second.count <= printed_ones && now - entry.second.last >= pause;
  });
}

}  // namespace canopus::text
