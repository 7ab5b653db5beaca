#pragma once
// The rows of spec/me3can1-q/bfm.csv.

#include <functional>
#include <set>

#include "canopus/module/models/me3can1_q/buffer_table.hpp"

#include "scenarios/me3can1_q/scenario.hpp"
#include "support/spec_table.hpp"

namespace canopus::scenario::table_rows {

using Address = module::BufferAddress;

struct Row : SpecRow {
  std::vector<Address> addresses;  ///< of the field, in each record
  bool is_record = false;  ///< a row that only says where records lie; its fields have rows of their own
  unsigned shift = 0;
  std::uint16_t mask = 0xFFFF;
  std::vector<std::uint16_t> modes;

  [[nodiscard]] bool in(std::uint16_t mode) const {
    return std::find(modes.begin(), modes.end(), mode) != modes.end();
  }
  [[nodiscard]] bool whole_word() const { return mask == 0xFFFF; }
  /// The field in a word.
  [[nodiscard]] std::uint16_t of(std::uint16_t word) const {
    return static_cast<std::uint16_t>((word & mask) >> shift);
  }
  [[nodiscard]] std::string access() const { return (*this)["access_plc"]; }
};

inline std::vector<Row> bfm() {
  std::vector<Row> rows;
  for (const SpecRow& spec : spec_rows("me3can1-q", "bfm.csv")) {
    Row row{spec, {}, false, 0, 0xFFFF, {}};
    const unsigned first = spec.number("first"), last = spec.number("last");
    const unsigned stride = spec.number("stride"), count = spec.number("count");
    row.is_record = stride > 1 && last - first + 1 == stride * count;
    const unsigned step = row.is_record ? 1 : stride;
    for (unsigned address = first; address <= last; address += step) row.addresses.push_back(address);
    EXPECT_EQ(row.addresses.size(), row.is_record ? stride * count : count) << row.place;
    if (const std::string& bits = spec["bits"]; !bits.empty()) {
      const auto dash = bits.find('-');
      row.shift = static_cast<unsigned>(std::stoul(bits));
      const auto high = dash == std::string::npos ? row.shift : std::stoul(bits.substr(dash + 1));
      row.mask = static_cast<std::uint16_t>(((2U << (high - row.shift)) - 1U) << row.shift);
    }
    const std::string& modes = spec["modes"];
    if (modes == "all" || modes == "405") row.modes.push_back(405);
    if (modes == "all" || modes == "L2") row.modes.insert(row.modes.end(), {11, 29});
    EXPECT_FALSE(row.modes.empty()) << row.place;
    rows.push_back(std::move(row));
  }
  return rows;
}

inline void start(IntelligentScenario& s, std::uint16_t mode) {
  if (mode == 405) {
    s.power_on();
  } else {
    s.power_on_layer2(mode);
  }
}

}  // namespace canopus::scenario::table_rows
