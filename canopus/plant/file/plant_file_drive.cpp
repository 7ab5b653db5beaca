#include "canopus/plant/file/plant_sections.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

DriveSection read_drive(text::TableReader& table) {
  DriveSection drive{.place = table.place()};
  drive.start = table.number("start").value_or(0);
  drive.low_switch = table.number("low_switch");
  drive.high_switch = table.number("high_switch");
  if (drive.low_switch && drive.high_switch && *drive.low_switch >= *drive.high_switch) {
    table.error("low_switch", "expected less than high_switch");
  }
  drive.revolution = table.number("revolution").value_or(drive.revolution);
  if (drive.revolution <= 0) table.error("revolution", "expected more than 0");
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
