#pragma once
// The part of the live table that scrolls: every node, those in trouble first, each with what is wrong.

#include <cstddef>
#include <memory>

#include "canopus/cli/run/table_state.hpp"
#include "canopus/cli/run/table_text.hpp"

namespace canopus::cli {

/// A plant may have thousands of nodes: only the lines that are asked for are made.
class TableBody {
 public:
  /// `state` must outlive it. `room`: number of available lines. The faults of nodes are shown in full if the
  /// faulty nodes take no more than two thirds of it, else in one line each.
  TableBody(const TableState& state, std::size_t columns, std::size_t room);
  ~TableBody();
  TableBody(const TableBody&) = delete;
  TableBody& operator=(const TableBody&) = delete;

  [[nodiscard]] TableLine titles() const;
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] TableLine line(std::size_t number) const;
  /// The number of nodes that begin in these lines, `end` excluded.
  [[nodiscard]] std::size_t nodes(std::size_t first, std::size_t end) const;
  /// Puts a line at its end that belongs to no node.
  void append(TableLine line);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The number of the plant's nodes in operation: "3 of 4 operational".
[[nodiscard]] std::size_t in_operation(const TableState& state);

}  // namespace canopus::cli
