#pragma once
// Values of a device that were recorded: rows of them, each from its moment on, once or over and over.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::sim {

class Playback {
 public:
  using Value = std::optional<std::uint64_t>;  ///< bit pattern, as wide as its entry; empty: not yet any

  /// The entries that its columns are about, at least one.
  explicit Playback(std::vector<canopen::Entry> entries) : entries_(std::move(entries)) {}
  /// A row as wide as there are entries, later than the one before; an empty value is that of the row before.
  void add(can::Duration time, std::span<const Value> values);
  /// From now on the rows come over and over. The last one lasts as long as the one before it; there must be
  /// two.
  void repeat() noexcept { repeats_ = true; }

  [[nodiscard]] const std::vector<canopen::Entry>& entries() const noexcept { return entries_; }
  [[nodiscard]] std::size_t rows() const noexcept { return times_.size(); }
  /// The values of this moment; empty: the first row is yet to come.
  [[nodiscard]] std::span<const Value> at(can::Time now) const noexcept;
  /// The first moment after this one with another row.
  [[nodiscard]] can::Time next_after(can::Time now) const noexcept;

 private:
  [[nodiscard]] can::Duration cycle() const noexcept;

  std::vector<canopen::Entry> entries_;
  std::vector<can::Duration> times_;  // rising
  std::vector<Value> values_;         // row by row
  bool repeats_ = false;
};

}  // namespace canopus::sim
