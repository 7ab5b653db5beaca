#pragma once
// The parts of a device file beside its objects, as device_file.cpp reads and reviews them: the sections that describe the file and the
// device as a whole (device_sections.cpp), modules of modular devices (modules.cpp), and PDOs (pdo_review.cpp).

#include "canopus/eds/device_file.hpp"
#include "canopus/eds/draft.hpp"
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
/// What matters for communication and has no counterpart in a DeviceFile: losses.
void report_unread(const IniFile& file, Problems& problems);
/// Notes sections that this reader does not use.
void note_unknown_sections(const IniFile& file, Problems& problems);

/// Modular devices: bus couplers whose objects depend on the modules plugged into them [CiA 306].
/// Reads [SupportedModules] and [MxModuleInfo] into the device, and from a DCF [ConnectedModules]; the
/// objects of the connected modules are added to the draft.
void read_modules(const IniFile& file, Draft& draft, DeviceFile& device, Problems& problems);

/// Adds the PDOs that NrOfRXPDO and NrOfTXPDO announce and CompactPDO describes but no section does [CiA
/// 306].
void generate_compact_pdos(Draft& draft, const DeviceInfo& device, unsigned line, Problems& problems);

/// COB-IDs of the pre-defined connection set that lack their $NODEID would be the same in every node: adds
/// it.
void repair_cob_ids(Draft& draft, Problems& problems);

/// Checks default mappings: objects that exist, lengths, 64 bits; objects that are mapped by default are made
/// mappable.
void review_mappings(Draft& draft, std::uint32_t dummy_usage, Problems& problems);

}  // namespace canopus::eds
