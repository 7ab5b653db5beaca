#pragma once
// What the reader of a trace leaves out, counted by kind, and the frames that the recorder itself has lost.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace canopus::trace {

enum class LeftOutKind : std::uint8_t {
  can_fd,
  can_xl,
  too_long,      ///< more than 8 bytes, in a format that does not say of which kind the frame is
  send_request,  ///< that a frame was handed to the controller; the frame itself follows
  other_bus,     ///< LIN, FlexRay, Ethernet
  status,        ///< of the controller: state, error counters
  statistics,
  comment,
  other,
};

struct LeftOutName {
  LeftOutKind kind;
  std::string_view key;  ///< in JSON
  std::string_view one, many;
  bool is_frame;  ///< a frame that was on a bus
};
/// In the order of LeftOutKind.
inline constexpr std::array left_out_names{
    LeftOutName{LeftOutKind::can_fd, "can_fd", "CAN FD frame", "CAN FD frames", true},
    LeftOutName{LeftOutKind::can_xl, "can_xl", "CAN XL frame", "CAN XL frames", true},
    LeftOutName{LeftOutKind::too_long, "too_long", "frame of more than 8 bytes",
                "frames of more than 8 bytes", true},
    LeftOutName{LeftOutKind::send_request, "send_request", "request to send", "requests to send", false},
    LeftOutName{LeftOutKind::other_bus, "other_bus", "record of another bus", "records of other buses", true},
    LeftOutName{LeftOutKind::status, "status", "status", "statuses", false},
    LeftOutName{LeftOutKind::statistics, "statistics", "statistic", "statistics", false},
    LeftOutName{LeftOutKind::comment, "comment", "comment", "comments", false},
    LeftOutName{LeftOutKind::other, "other", "other record", "other records", false}};

class LeftOut {
 public:
  void add(LeftOutKind kind) noexcept { ++counts_[static_cast<std::size_t>(kind)]; }
  /// Frames that the recorder says it has lost.
  void add_lost(std::uint64_t frames) noexcept;

  [[nodiscard]] std::uint64_t of(LeftOutKind kind) const noexcept {
    return counts_[static_cast<std::size_t>(kind)];
  }
  /// Records of all kinds.
  [[nodiscard]] std::uint64_t total() const noexcept;
  /// Those of them that were frames on a bus.
  [[nodiscard]] std::uint64_t frames() const noexcept;
  /// Frames that are not in the file because the recorder lost them.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
  /// "4 CAN FD frames, 1 comment"; empty: nothing was left out.
  [[nodiscard]] std::string text() const;

 private:
  std::array<std::uint64_t, left_out_names.size()> counts_{};
  std::uint64_t lost_ = 0;
};

}  // namespace canopus::trace
