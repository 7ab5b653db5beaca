#pragma once
// The latest frames of all buses of a run, by number. A number stays that of its frame; the oldest are forgotten.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "canopus/trace/file/trace_record.hpp"

namespace canopus::web {

class TraceStore {
 public:
  static constexpr std::size_t block = 4096;  ///< frames that are forgotten together

  /// `most`: frames that are kept, at least; up to a block more are.
  explicit TraceStore(std::size_t most) : most_(most) {}

  void add(const trace::TraceRecord& record) {
    if (blocks_.empty() || blocks_.back().size() == block) {
      if (end() - begin() >= most_ + block) {
        blocks_.pop_front();
        begin_ += block;
      }
      blocks_.emplace_back().reserve(block);
    }
    blocks_.back().push_back(record);
  }
  /// The oldest that is kept, and the one that comes next.
  [[nodiscard]] std::uint64_t begin() const noexcept { return begin_; }
  [[nodiscard]] std::uint64_t end() const noexcept {
    return blocks_.empty() ? begin_ : begin_ + (blocks_.size() - 1) * block + blocks_.back().size();
  }
  /// Of a number from begin() up to end().
  [[nodiscard]] const trace::TraceRecord& at(std::uint64_t number) const noexcept {
    const std::uint64_t place = number - begin_;
    return blocks_[place / block][place % block];
  }

 private:
  std::size_t most_;
  std::uint64_t begin_ = 0;
  std::deque<std::vector<trace::TraceRecord>> blocks_;
};

}  // namespace canopus::web
