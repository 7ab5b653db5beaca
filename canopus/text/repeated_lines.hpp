#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "canopus/can/time.hpp"

namespace canopus::text {

/// Counts lines that repeat, in place of printing thousands of them. Of a line that comes again within a second
/// of the last time the first three are printed; the others are one line with their number, when a second
/// without it has passed.
class RepeatedLines {
 public:
  static constexpr unsigned printed_ones = 3;
  static constexpr can::Duration pause = std::chrono::seconds(1);

  /// The line is to be printed; else it is counted.
  [[nodiscard]] bool passes(std::string_view line, can::Time now);
  /// Lines to be printed at `now` for those that were counted: "line1 node 2 (io-block): bus-off (×1300, last
  /// 12.4 s)"; with can::never for all of them, at the end of a run.
  [[nodiscard]] std::vector<std::string> ended(can::Time now);

 private:
  static constexpr std::size_t most_lines = 256;  ///< further ones are printed

  struct Burst {
    can::Time last{};
    std::uint64_t count = 0;
    std::uint64_t number = 0;  ///< in the order of their begin
  };
  void forget(can::Time now);

  std::unordered_map<std::string, Burst> bursts_;
  can::Time look_at_ = can::never;  ///< no earlier end of a burst that has counted lines
  can::Time forget_at_{};
  std::uint64_t begun_ = 0;
};

}  // namespace canopus::text
