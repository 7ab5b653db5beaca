#pragma once
// Limits the reports of a peer's mistakes to one a second, with the number of suppressed ones. No I/O, no
// clock.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace canopus::link {

class ComplaintLimiter {
 public:
  /// Since any moment; never goes back.
  using Time = std::chrono::nanoseconds;
  static constexpr Time pause = std::chrono::seconds(1);  ///< from one complaint to the next
  static constexpr std::size_t longest = 200;             ///< bytes of a complaint; the rest is cut off

  /// The text to report at once, if any.
  [[nodiscard]] std::optional<std::string> complain(std::string_view text, Time now);
  /// When tick() has a text; none: nothing waits.
  [[nodiscard]] std::optional<Time> deadline() const noexcept;
  /// The waiting text once it is due: the last complaint, and "N more like it" if there were others before
  /// it.
  [[nodiscard]] std::optional<std::string> tick(Time now);
  /// The same regardless of the time: no complaint comes after it.
  [[nodiscard]] std::optional<std::string> finish();

 private:
  std::optional<Time> quiet_until_;  // none: no report yet
  std::string last_;                 // of those that wait
  std::uint64_t waiting_ = 0;
};

/// The beginning of a text of the other side, with ? for what is no printable ASCII.
[[nodiscard]] std::string printable_complaint(std::string_view text);

}  // namespace canopus::link
