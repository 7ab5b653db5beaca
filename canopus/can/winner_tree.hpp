#pragma once
// The earliest of many deadlines, by a winner tree: behind the matches stand the players, by index; match n is between 2 n and
// 2 n + 1, and match 1 the last one. A new deadline is played up to there, and no branch depends on which wins. A deadline is counted
// from a base that no deadline is before, in a key with its index below; what is further away than a key counts (4.9 hours) is
// distinguished when nothing nearer is left: then the tree is rebuilt from the earliest deadline on.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "canopus/can/time.hpp"

namespace canopus::can {

class WinnerTree {
 public:
  using Index = std::uint32_t;
  static constexpr Index most_players = 1'000'000;

  /// One player more, that waits for nothing. At most most_players.
  Index add();
  void set(Index index, Time deadline) noexcept { set_inline(index, deadline); }
  [[gnu::always_inline]] void set_inline(Index index, Time deadline) noexcept {
    deadlines_[index] = deadline;
    if (deadline < base_) [[unlikely]]
      return rebuild(deadline);
    Key* const winners = winners_.data();
    std::size_t match = capacity_ + index;
    Key winner = key_of(index, deadline);
    winners[match] = winner;
    while (match > 1) {
      const Key other = winners[match ^ 1];
      match /= 2;
      winner = winner < other ? winner : other;
      winners[match] = winner;
    }
    set_winner(winner);
  }
  [[nodiscard]] Time deadline(Index index) const noexcept { return deadlines_[index]; }
  /// never: none.
  [[nodiscard]] Time earliest() const noexcept { return earliest_; }
  /// Whose it is; of equal deadlines the lowest index. Means nothing without one.
  [[nodiscard]] Index winner() const noexcept { return winner_; }

 private:
  using Key = std::uint64_t;
  static constexpr unsigned index_bits = 20;
  static constexpr Key no_deadline = ~Key{0};
  static constexpr std::uint64_t far = no_deadline >> index_bits;

  [[nodiscard]] Key key_of(Index index, Time deadline) const noexcept {
    if (deadline == never) return no_deadline;
    const auto after_base = static_cast<std::uint64_t>(deadline.time_since_epoch().count()) -
                            static_cast<std::uint64_t>(base_.time_since_epoch().count());
    return std::min(after_base, far) << index_bits | index;
  }
  void set_winner(Key key) noexcept {
    if (key >> index_bits == far) [[unlikely]]
      return advance_base(key);
    winner_ = key & ((Key{1} << index_bits) - 1);
    earliest_ = deadlines_[winner_];
  }
  void advance_base(Key key) noexcept;
  void rebuild(Time base) noexcept;

  std::size_t capacity_ = 1;  // room for so many players
  Time base_{};
  std::vector<Key> winners_{no_deadline, no_deadline};  // of each match; behind them the players
  std::vector<Time> deadlines_;
  Time earliest_ = never;
  Index winner_ = 0;
};

}  // namespace canopus::can
