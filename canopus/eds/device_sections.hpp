#pragma once
// The sections that describe the file and the device as a whole.

#include "canopus/eds/device_file.hpp"
#include "canopus/eds/ini.hpp"

namespace canopus::eds {

void read_file_info(const IniFile& file, FileInfo& info, Problems& problems);
/// Returns the line of NrOfRXPDO, NrOfTXPDO or the section: where problems with their number belong.
struct DeviceInfoLines {
  unsigned section = 1;
  unsigned rpdos = 1;
  unsigned tpdos = 1;
};
DeviceInfoLines read_device_info(const IniFile& file, DeviceInfo& info, Problems& problems);
[[nodiscard]] std::optional<Commissioning> read_commissioning(const IniFile& file, Problems& problems);
/// Bit n: data type n is allowed as a dummy.
[[nodiscard]] std::uint32_t read_dummy_usage(const IniFile& file, Problems& problems);
[[nodiscard]] std::vector<std::string> read_comments(const IniFile& file);
/// Notes sections that this reader does not use.
void note_unknown_sections(const IniFile& file, Problems& problems);

}  // namespace canopus::eds
