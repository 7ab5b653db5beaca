#include "canopus/eds/standard_objects.hpp"

#include <algorithm>
#include <array>

#include "canopus/eds/draft.hpp"

namespace canopus::eds {
namespace {

using canopen::DataType;
using enum canopen::DataType;

struct Row {
  std::uint16_t index;
  std::string_view name;
  DataType type;          // of sub-index 00H of a VAR, or of 01H.. of an array
  bool has_subs = false;  // sub-index 00H is a count then
};

// [CiA 301 7.5.2, CiA 302-2, CiA 302-3]
constexpr std::array rows{
    Row{0x1000, "Device type", unsigned32},
    Row{0x1001, "Error register", unsigned8},
    Row{0x1002, "Manufacturer status register", unsigned32},
    Row{0x1003, "Pre-defined error field", unsigned32, true},
    Row{0x1005, "COB-ID SYNC message", unsigned32},
    Row{0x1006, "Communication cycle period", unsigned32},
    Row{0x1007, "Synchronous window length", unsigned32},
    Row{0x1008, "Manufacturer device name", visible_string},
    Row{0x1009, "Manufacturer hardware version", visible_string},
    Row{0x100A, "Manufacturer software version", visible_string},
    Row{0x100C, "Guard time", unsigned16},
    Row{0x100D, "Life time factor", unsigned8},
    Row{0x1010, "Store parameters", unsigned32, true},
    Row{0x1011, "Restore default parameters", unsigned32, true},
    Row{0x1012, "COB-ID time stamp object", unsigned32},
    Row{0x1013, "High resolution time stamp", unsigned32},
    Row{0x1014, "COB-ID EMCY", unsigned32},
    Row{0x1015, "Inhibit time EMCY", unsigned16},
    Row{0x1016, "Consumer heartbeat time", unsigned32, true},
    Row{0x1017, "Producer heartbeat time", unsigned16},
    Row{0x1018, "Identity object", unsigned32, true},
    Row{0x1019, "Synchronous counter overflow value", unsigned8},
    Row{0x1020, "Verify configuration", unsigned32, true},
    Row{0x1021, "Store EDS", domain},
    Row{0x1022, "Store format", unsigned8},
    Row{0x1023, "OS command", octet_string, true},
    Row{0x1024, "OS command mode", unsigned8},
    Row{0x1025, "OS debugger interface", octet_string, true},
    Row{0x1026, "OS prompt", unsigned8, true},
    Row{0x1027, "Module list", unsigned16, true},
    Row{0x1028, "Emergency consumer", unsigned32, true},
    Row{0x1029, "Error behaviour", unsigned8, true},
    Row{0x102A, "NMT inhibit time", unsigned16},
    Row{0x1F20, "Store DCF", domain, true},
    Row{0x1F21, "Store DCF format", unsigned8, true},
    Row{0x1F22, "Concise DCF", domain, true},
    Row{0x1F23, "Store EDS of slaves", domain, true},
    Row{0x1F24, "Store EDS format", unsigned8, true},
    Row{0x1F25, "Configuration request", unsigned32, true},
    Row{0x1F26, "Expected configuration date", unsigned32, true},
    Row{0x1F27, "Expected configuration time", unsigned32, true},
    Row{0x1F50, "Program data", domain, true},
    Row{0x1F51, "Program control", unsigned8, true},
    Row{0x1F52, "Verify application software", unsigned32, true},
    Row{0x1F53, "Expected application software date", unsigned32, true},
    Row{0x1F54, "Expected application software time", unsigned32, true},
    Row{0x1F55, "Expected software identification", unsigned32, true},
    Row{0x1F56, "Program software identification", unsigned32, true},
    Row{0x1F57, "Flash status identification", unsigned32, true},
    Row{0x1F80, "NMT startup", unsigned32},
    Row{0x1F81, "NMT slave assignment", unsigned32, true},
    Row{0x1F82, "Request NMT", unsigned8, true},
    Row{0x1F83, "Request node guarding", unsigned8, true},
    Row{0x1F84, "Device type identification", unsigned32, true},
    Row{0x1F85, "Vendor identification", unsigned32, true},
    Row{0x1F86, "Product code", unsigned32, true},
    Row{0x1F87, "Revision number", unsigned32, true},
    Row{0x1F88, "Serial number", unsigned32, true},
    Row{0x1F89, "Boot time", unsigned32},
    Row{0x1F8A, "Restore configuration", unsigned32, true},
    Row{0x1F90, "NMT flying master timing", unsigned16, true},
};

const Row* find_row(std::uint16_t index) noexcept {
  const auto* const row = std::ranges::lower_bound(rows, index, {}, &Row::index);
  return row != rows.end() && row->index == index ? row : nullptr;
}

// Records, whose members have types of their own: 00H, 01H ...
constexpr DataType pdo_communication[] = {unsigned8, unsigned32, unsigned8, unsigned16,
                                          unsigned8, unsigned16, unsigned8};
constexpr DataType sdo_parameter[] = {unsigned8, unsigned32, unsigned32, unsigned8};
constexpr DataType os_command[] = {unsigned8, octet_string, unsigned8, octet_string};  // 1025H, too

std::optional<DataType> member(std::span<const DataType> record, std::uint8_t sub) noexcept {
  return sub < record.size() ? std::optional(record[sub]) : std::nullopt;
}

}  // namespace

std::string_view standard_name(std::uint16_t index) noexcept {
  const Row* const row = find_row(index);
  return row == nullptr ? std::string_view() : row->name;
}

std::optional<DataType> standard_type(std::uint16_t index, std::uint8_t sub) noexcept {
  if (is_communication_record(index)) return member(pdo_communication, sub);
  if (is_mapping_record(index)) return sub == 0 ? unsigned8 : unsigned32;
  if (index >= 0x1200 && index <= 0x12FF) return member(sdo_parameter, sub);
  if (index == 0x1023 || index == 0x1025) return member(os_command, sub);
  if (index >= 0x1FA0 && index <= 0x1FCF) return sub == 0 ? unsigned8 : unsigned32;  // object scanner lists
  if (index >= 0x1FD0 && index <= 0x1FFF)
    return sub == 0 ? unsigned8 : unsigned64;  // object dispatching lists
  const Row* const row = find_row(index);
  if (row == nullptr || (!row->has_subs && sub != 0)) return std::nullopt;
  return row->has_subs && sub == 0 ? unsigned8 : row->type;
}

}  // namespace canopus::eds
