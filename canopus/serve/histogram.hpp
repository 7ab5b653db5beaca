#pragma once
// Durations in classes, to judge latencies.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace canopus::serve {

class Histogram {
 public:
  using Duration = std::chrono::nanoseconds;
  /// Upper ends of the classes; the last class has none.
  static constexpr std::array<Duration, 14> ends = {
      std::chrono::microseconds(5),   std::chrono::microseconds(10),  std::chrono::microseconds(20),
      std::chrono::microseconds(50),  std::chrono::microseconds(100), std::chrono::microseconds(200),
      std::chrono::microseconds(500), std::chrono::milliseconds(1),   std::chrono::milliseconds(2),
      std::chrono::milliseconds(5),   std::chrono::milliseconds(10),  std::chrono::milliseconds(20),
      std::chrono::milliseconds(50),  std::chrono::milliseconds(100)};

  void add(Duration duration) { all_.push_back(duration); }
  [[nodiscard]] std::size_t count() const noexcept { return all_.size(); }
  /// The count in the class of that number, 0..ends.size().
  [[nodiscard]] std::size_t in_class(std::size_t number) const {
    return static_cast<std::size_t>(std::ranges::count_if(all_, [number](Duration duration) {
      return static_cast<std::size_t>(std::ranges::upper_bound(ends, duration) - ends.begin()) == number;
    }));
  }
  /// Against the smallest of all.
  [[nodiscard]] Histogram relative() const {
    Histogram result;
    const Duration least = quantile(0);
    for (const Duration duration : all_) result.add(duration - least);
    return result;
  }
  /// The smallest duration that at least `per_mille` of all are not above; 1000 is the largest of all. Zero when there is none.
  [[nodiscard]] Duration quantile(unsigned per_mille) const {
    if (all_.empty()) return {};
    std::vector<Duration> sorted = all_;
    std::ranges::sort(sorted);
    const std::size_t rank = (sorted.size() * std::min(per_mille, 1000U) + 999) / 1000;
    return sorted[std::max<std::size_t>(rank, 1) - 1];
  }
  [[nodiscard]] Duration mean() const {
    Duration sum{};
    for (const Duration duration : all_) sum += duration;
    return all_.empty() ? sum : sum / static_cast<std::int64_t>(all_.size());
  }

 private:
  std::vector<Duration> all_;
};

/// The delay of each event of a periodic series, relative to the most punctual one; the n-th moment is that
/// of the n-th period. A lost event makes all later ones a period late.
[[nodiscard]] inline Histogram lateness(std::span<const std::chrono::nanoseconds> moments,
                                        std::chrono::nanoseconds period) {
  std::vector<std::chrono::nanoseconds> offsets;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    offsets.push_back(moments[i] - moments[0] - static_cast<std::int64_t>(i) * period);
  }
  Histogram histogram;
  const auto earliest = offsets.empty() ? std::chrono::nanoseconds{} : std::ranges::min(offsets);
  for (const auto offset : offsets) histogram.add(offset - earliest);
  return histogram;
}

}  // namespace canopus::serve
