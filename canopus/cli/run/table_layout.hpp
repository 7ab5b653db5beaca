#pragma once
// The live table as lines: a function of what there is to show, which part of it, and the terminal's size. No
// terminal in it.
//
//   first plant               4 of 4 operational       12.3 s   late by 0.1 ms    the header stays
//   line1    250 kbit/s   load   4.2 %   0 error frames   peak   8.0 %
//   plc1 U0  X00 X02  Y03   G25 = 33281 (8201H)                                   signals ON, watched words
//   Node  Name           NMT state        Last EMCY  CAN      PDO/s
//      3  encoder        not booted       -          -            0               the body scrolls, trouble first
//         no answer to 1000H, waiting to ask again, for 0.2 s. ...
//      1  ME3CAN1-Q U0   operational      -          -           50
//   … 97 more nodes
//       1.007  line1 node 3 (encoder): failed (M, ...)                            errors and warnings
//   q ends   ? help   MC protocol 127.0.0.1:5007

#include <cstddef>
#include <vector>

#include "canopus/cli/run/table_state.hpp"
#include "canopus/cli/run/table_text.hpp"

namespace canopus::cli {

/// Which part of the table.
struct TableView {
  std::size_t first = 0;  ///< of the body's lines, the first one; more than there are: the last ones
  bool help = false;
};

struct TablePicture {
  std::vector<TableLine> lines{};  ///< at most as many as the terminal has, each of at most its columns
  std::size_t first = 0;           ///< TableView::first as it could be met
  std::size_t last = 0;            ///< its largest value
  std::size_t page = 1;            ///< lines of the body
};

[[nodiscard]] TablePicture lay_out(const TableState& state, TableView view, TableSize size);

}  // namespace canopus::cli
