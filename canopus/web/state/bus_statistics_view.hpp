#pragma once
// What the frames of a bus show of its nodes, by the CAN-IDs of the predefined connection set [CiA 301 7.3.5]: how old the last
// heartbeat is, how long an SDO server takes to answer, how regularly SYNC comes. Counted from the plant's start on, whoever looks.

#include <array>
#include <cstdint>
#include <optional>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/text/json.hpp"

namespace canopus::web {

/// Shortest, longest and mean of several times.
class TimeFigures {
 public:
  void add(can::Duration time) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] can::Duration least() const noexcept { return least_; }
  [[nodiscard]] can::Duration most() const noexcept { return most_; }
  /// 0 without times.
  [[nodiscard]] can::Duration mean() const noexcept;

 private:
  std::uint64_t count_ = 0;
  can::Duration least_{};
  can::Duration most_{};
  can::Duration sum_{};
};

/// `count`, and in seconds `least mean most`.
[[nodiscard]] text::Json time_fields(const TimeFigures& times);

class BusStatisticsView {
 public:
  struct Node {
    std::optional<can::Time> heartbeat{};  ///< end of the last one; boot-up messages are none
    can::Duration period{};                ///< between the last two; 0: there was one at most
    /// As its last boot-up message, heartbeat or guarding answer showed, or an NMT command since; none: it has sent none.
    std::optional<canopen::NmtState> state{};
    std::optional<can::Time> asked{};  ///< end of the SDO request that has no answer yet
    TimeFigures answers{};             ///< from the end of an SDO request to the end of its answer
  };

  void frame_completed(const can::Frame& frame, can::Time end) noexcept;
  /// 1 to 127; of others nothing was seen.
  [[nodiscard]] const Node& node(std::uint8_t node_id) const noexcept { return nodes_[node_id & 0x7FU]; }
  /// From the end of a SYNC to that of the next.
  [[nodiscard]] const TimeFigures& sync() const noexcept { return sync_; }

 private:
  void commanded(std::uint8_t command, std::uint8_t node_id) noexcept;

  std::array<Node, 128> nodes_{};
  std::optional<can::Time> last_sync_{};
  TimeFigures sync_{};
};

}  // namespace canopus::web
