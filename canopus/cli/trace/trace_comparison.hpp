#pragma once
// Two traces side by side. Frames are the same if channel, identifier, length and data are; where they are
// not, the next position where both match again is searched in a window, so memory does not grow with the
// traces.

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "canopus/can/time.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::cli {

struct ComparedRecord {
  trace::TraceRecord record{};
  std::string channel{};
  can::Duration time{};  ///< that is compared
};

enum class Difference : std::uint8_t { only_in_a, only_in_b, other_order, other_time };

struct ComparisonCounts {
  std::uint64_t same = 0, only_in_a = 0, only_in_b = 0, other_order = 0, other_time = 0;
  can::Duration largest{};  ///< difference of times, of frames that both have
  [[nodiscard]] bool are_same() const noexcept {
    return only_in_a == 0 && only_in_b == 0 && other_order == 0 && other_time == 0;
  }
};

class TraceComparison {
 public:
  /// Frames on each side that are searched for a match.
  static constexpr std::size_t window = 400;
  /// The number of consecutive frames that must match.
  static constexpr std::size_t run = 3;

  using Source = std::function<std::optional<ComparedRecord>()>;
  /// `b` is of the other trace; nothing where there is none: for only_in_a, `a` where for only_in_b.
  using Report = std::function<void(Difference, const ComparedRecord* a, const ComparedRecord* b)>;
  struct Options {
    can::Duration tolerance{};
    bool channels = true;  ///< are compared
  };

  TraceComparison(Source a, Source b, Options options, Report report)
      : a_{std::move(a), {}, false},
        b_{std::move(b), {}, false},
        options_(options),
        report_(std::move(report)) {}
  ComparisonCounts compare();

 private:
  struct Side {
    Source source;
    std::deque<ComparedRecord> ahead;
    bool ended = false;
    bool fill(std::size_t size);
  };
  [[nodiscard]] bool alike(const ComparedRecord& a, const ComparedRecord& b) const;
  [[nodiscard]] bool continue_alike(std::size_t from_a, std::size_t from_b) const;
  void pair(const ComparedRecord& a, const ComparedRecord& b);
  void compare_windows(std::size_t of_a, std::size_t of_b);

  Side a_, b_;
  Options options_;
  Report report_;
  ComparisonCounts counts_{};
};

}  // namespace canopus::cli
