#include <cstdint>
#include <limits>

#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

namespace {

/// A position in the range of 6064H.
std::optional<double> read_position(text::TableReader& table, std::string_view key) {
  using Positions = std::numeric_limits<std::int32_t>;
  const auto position = table.number(key);
  if (!position || (*position >= Positions::min() && *position <= Positions::max())) return position;
  table.error(key, "a position is -2147483648 to 2147483647");
  return std::nullopt;
}

}  // namespace

DriveSection read_drive(text::TableReader& table) {
  DriveSection drive{.place = table.place()};
  drive.start = read_position(table, "start").value_or(0);
  drive.low_switch = read_position(table, "low_switch");
  drive.high_switch = read_position(table, "high_switch");
  if (drive.low_switch && drive.high_switch && *drive.low_switch >= *drive.high_switch) {
    table.error("low_switch", "expected less than high_switch");
  }
  drive.revolution = table.number("revolution").value_or(drive.revolution);
  if (drive.revolution < 1 || drive.revolution > std::numeric_limits<std::int32_t>::max()) {
    table.error("revolution", "a revolution is 1 to 2147483647");
    drive.revolution = 1;
  }
  table.tables("fault", "device.drive.fault", [&](text::TableReader& inner) {
    DriveSection::Fault fault;
    fault.at = inner.parsed("at", text::parse_duration, true).value_or(can::Duration{});
    fault.code = static_cast<std::uint16_t>(
        inner.integer("code", 1, 0xFFFF, "an error code is 0x0001 to 0xFFFF", true).value_or(0));
    drive.faults.push_back(fault);
  });
  return drive;
}

}  // namespace canopus::plant
