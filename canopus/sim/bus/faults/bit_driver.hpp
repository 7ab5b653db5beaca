#pragma once
// The bit driver: raw levels put on the wire of a simulated bus at exact times, whatever the nodes do (a lower tester,
// as ISO 16845-1 has it). FaultKind::drive of fault.hpp hands its sequences over; only the sources of the bus include
// the rest.
//
//   '0' 'd'  dominant
//   '1' 'r'  released: recessive unless a node is dominant
//   'R'      recessive whatever the nodes drive
//   blanks, '_' and line ends separate; "1*11" is a level eleven times

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus_error.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"

namespace canopus::sim {

enum class DrivenLevel : std::uint8_t { released, dominant, recessive };

/// Levels of one driver at most.
inline constexpr std::size_t max_driven_levels = 100'000;

/// The levels of a text as above. The error says what was found at which character, from 1.
[[nodiscard]] std::expected<std::vector<DrivenLevel>, std::string> parse_levels(std::string_view text);

/// The number of a frame's bit (SOF = 0, stuff bits counted) where this field begins; none: it has no such field.
/// Intermission is the last field of a frame in this sense.
[[nodiscard]] std::optional<unsigned> field_begin(const can::Frame& frame, can::FrameField field);

/// The sequences that are on the wire, or will be.
class BitDriver {
 public:
  /// `bit`: time of one level, longer than 0. A sequence without levels does nothing.
  void add(can::Time start, can::Duration bit, const std::vector<DrivenLevel>& levels);
  /// Brings all to `now`. True: what they do to the wire together has changed.
  [[nodiscard]] bool run(can::Time now);
  /// When something changes next.
  [[nodiscard]] can::Time next() const noexcept { return next_; }
  /// Of several, dominant goes before forced recessive.
  [[nodiscard]] DrivenLevel level() const noexcept { return level_; }
  /// Some sequence is between its first and its last level.
  [[nodiscard]] bool is_busy() const noexcept { return is_busy_; }

 private:
  struct Sequence {
    can::Time start;
    can::Duration bit;
    std::vector<DrivenLevel> levels;
    [[nodiscard]] can::Time end() const noexcept {
      return start + bit * static_cast<std::int64_t>(levels.size());
    }
  };
  std::vector<Sequence> sequences_;
  can::Time next_ = can::never;
  DrivenLevel level_ = DrivenLevel::released;
  bool is_busy_ = false;
};

}  // namespace canopus::sim
