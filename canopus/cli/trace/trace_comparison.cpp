#include "canopus/cli/trace/trace_comparison.hpp"

#include <algorithm>
#include <vector>

namespace canopus::cli {

bool TraceComparison::Side::fill(std::size_t size) {
  while (!ended && ahead.size() < size) {
    auto record = source();
    ended = !record;
    if (record) ahead.push_back(std::move(*record));
  }
  return ahead.size() >= size;
}

bool TraceComparison::alike(const ComparedRecord& a, const ComparedRecord& b) const {
  return a.record.frame == b.record.frame && a.record.error_frame == b.record.error_frame &&
         (!options_.channels || a.channel == b.channel);
}

bool TraceComparison::continue_alike(std::size_t from_a, std::size_t from_b) const {
  for (std::size_t i = 0; i < run; ++i) {
    const bool end_a = from_a + i >= a_.ahead.size();
    const bool end_b = from_b + i >= b_.ahead.size();
    // at the end of both traces fewer are enough
    if (end_a || end_b) return i > 0 && end_a && end_b && a_.ended && b_.ended;
    if (!alike(a_.ahead[from_a + i], b_.ahead[from_b + i])) return false;
  }
  return true;
}

void TraceComparison::pair(const ComparedRecord& a, const ComparedRecord& b) {
  const can::Duration apart = a.time > b.time ? a.time - b.time : b.time - a.time;
  counts_.largest = std::max(counts_.largest, apart);
  if (apart <= options_.tolerance) {
    ++counts_.same;
    return;
  }
  ++counts_.other_time;
  report_(Difference::other_time, &a, &b);
}

/// The first frames of both windows, which do not match one by one.
void TraceComparison::compare_windows(std::size_t of_a, std::size_t of_b) {
  std::vector<bool> found(of_b);
  for (std::size_t i = 0; i < of_a; ++i) {
    const ComparedRecord& a = a_.ahead[i];
    std::size_t j = 0;
    while (j < of_b && (found[j] || !alike(a, b_.ahead[j]))) ++j;
    if (j < of_b) {
      found[j] = true;
      ++counts_.other_order;
      report_(Difference::other_order, &a, &b_.ahead[j]);
    } else {
      ++counts_.only_in_a;
      report_(Difference::only_in_a, &a, nullptr);
    }
  }
  for (std::size_t j = 0; j < of_b; ++j) {
    if (found[j]) continue;
    ++counts_.only_in_b;
    report_(Difference::only_in_b, nullptr, &b_.ahead[j]);
  }
  a_.ahead.erase(a_.ahead.begin(), a_.ahead.begin() + static_cast<std::ptrdiff_t>(of_a));
  b_.ahead.erase(b_.ahead.begin(), b_.ahead.begin() + static_cast<std::ptrdiff_t>(of_b));
}

ComparisonCounts TraceComparison::compare() {
  while (true) {
    const bool more_a = a_.fill(1);
    const bool more_b = b_.fill(1);
    if (!more_a && !more_b) return counts_;
    if (more_a && more_b && alike(a_.ahead.front(), b_.ahead.front())) {
      pair(a_.ahead.front(), b_.ahead.front());
      a_.ahead.pop_front();
      b_.ahead.pop_front();
      continue;
    }
    (void)a_.fill(window + run);
    (void)b_.fill(window + run);
    const std::size_t most_a = std::min(window, a_.ahead.size());
    const std::size_t most_b = std::min(window, b_.ahead.size());
    // the fewest frames without a match
    bool found = false;
    for (std::size_t sum = 1; sum <= most_a + most_b && !found; ++sum) {
      for (std::size_t of_a = sum > most_b ? sum - most_b : 0; of_a <= std::min(sum, most_a); ++of_a) {
        if (!continue_alike(of_a, sum - of_a)) continue;
        compare_windows(of_a, sum - of_a);
        found = true;
        break;
      }
    }
    if (!found) compare_windows(most_a, most_b);
  }
}

}  // namespace canopus::cli
