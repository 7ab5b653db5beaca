#include "canopus/can/winner_tree.hpp"

namespace canopus::can {

// A quarter more where it has to grow: a plant of many buses has a tree for each.
WinnerTree::Index WinnerTree::add() {
  const std::size_t count = deadlines_.size() + 1;
  if (deadlines_.capacity() < count) deadlines_.reserve(count + count / 4);
  deadlines_.push_back(never);
  if (capacity_ < deadlines_.capacity()) {
    capacity_ = deadlines_.capacity();
    winners_.assign(2 * capacity_, no_deadline);
    rebuild(base_);
  }
  return static_cast<Index>(count - 1);
}

void WinnerTree::advance_base(Key key) noexcept {
  earliest_ = never;
  if (key != no_deadline) rebuild(std::ranges::min(deadlines_));
}

/// `base`: not after any deadline.
void WinnerTree::rebuild(Time base) noexcept {
  base_ = base;
  for (Index index = 0; index < deadlines_.size(); ++index)
    winners_[capacity_ + index] = key_of(index, deadlines_[index]);
  for (std::size_t match = capacity_ - 1; match > 0; --match)
    winners_[match] = std::min(winners_[2 * match], winners_[2 * match + 1]);
  set_winner(winners_[1]);
}

}  // namespace canopus::can
