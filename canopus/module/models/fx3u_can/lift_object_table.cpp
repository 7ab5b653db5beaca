// The object dictionary in CANopen 417 mode [FX3U-CAN 5.6, 5.10]. Objects of lift n lie 0800H x (n - 1) above those of
// lift 1, its PDOs 10H x (n - 1), their CAN-IDs 10H x (n - 1).

#include <array>
#include <vector>

#include "canopus/module/lift/lift.hpp"
#include "canopus/module/models/fx3u_can/buffer_table.hpp"
#include "canopus/module/models/fx3u_can/object_table.hpp"
#include "canopus/module/q_iqr/canopen_options.hpp"

namespace canopus::module::fx3u_can {

namespace {

using canopen::Access;
using canopen::DataType;
using namespace object_row;

// clang-format off
constexpr std::array common_rows = std::to_array<ObjectRow>({
    // first   last  kind      sub   ..    name                                 type acc.        default  flags
    {0x1000, 0x1000, variable, 0x00, 0x00, "Device type",                       u32, ro,           0x1A1, plain},
    {0x1017, 0x1017, variable, 0x00, 0x00, "Producer heartbeat time",           u16, rw,            1000, stored},
    {0x1400, 0x1400, sub,      0x01, 0x01, "RPDO communication: COB-ID",        u32, rw,      0x80000000, stored},
    {0x1400, 0x1400, sub,      0x02, 0x02, "RPDO communication: type",          u8,  rw,            0xFF, stored},
    {0x1800, 0x1800, sub,      0x01, 0x01, "TPDO communication: COB-ID",        u32, rw,      0xC0000000, stored},
    {0x1800, 0x1800, sub,      0x02, 0x02, "TPDO communication: type",          u8,  rw,            0xFF, stored},
    {0x1801, 0x1801, sub,      0x01, 0x01, "MPDO transmit: COB-ID",             u32, rw,      0x40000500, stored | adds_node_id},
    {0x1801, 0x1801, sub,      0x02, 0x02, "MPDO transmit: type",               u8,  ro,            0xFF, plain},
    {0x1A01, 0x1A01, sub,      0x00, 0x00, "MPDO transmit mapping",             u8,  ro,            0xFF, plain},
    {0x6000, 0x6000, sub,      0x01, 0x01, "Virtual device: call controller",   u16, ro,          0x0100, plain},
    {0x6000, 0x6000, sub,      0x02, 0x02, "Virtual device: car door controller", u16, ro,        0x0400, plain},
    {0x6000, 0x6000, sub,      0x03, 0x03, "Virtual device: car drive controller", u16, ro,       0x0800, plain},
    {0x6001, 0x6001, variable, 0x00, 0x00, "Lift number",                       u8,  rw,               1, stored},
    {0x6008, 0x6008, variable, 0x00, 0x00, "Specification version",             u16, ro,          0x2021, plain},
    {0x6010, 0x6010, variable, 0x00, 0x00, "Virtual input mapping",             u48, rw,               0, rpdo},
    {0x6011, 0x6011, variable, 0x00, 0x00, "Virtual output mapping",            u48, ro,               0, tpdo},
    // A byte that fills a PDO; an SDO access ends as if there were nothing.
    {0x67FE, 0x67FE, variable, 0x00, 0x00, "Filler",                            u8,  rw,               0, tpdo},
});

// Of lift 1.
constexpr std::array lift_rows = std::to_array<ObjectRow>({
    {0x6300, 0x6300, array,    0x01, 0x04, "Door control word",                 u16, ro,          0xFFFF, tpdo},
    {0x6301, 0x6301, array,    0x01, 0x04, "Door status word",                  u16, rw,          0xFFFF, rpdo},
    {0x6302, 0x6302, array,    0x01, 0x04, "Door position",                     u16, rw,          0xFFFF, rpdo},
    {0x6310, 0x6310, array,    0x01, 0x04, "Light barrier status",              u8,  rw,            0xFF, rpdo},
    {0x6383, 0x6383, array,    0x01, 0x04, "Position value",                    u32, rw,      0xFFFFFFFF, rpdo},
    {0x6390, 0x6390, array,    0x01, 0x04, "Speed value car",                   i16, rw,               0, rpdo},
    {0x6391, 0x6391, array,    0x01, 0x04, "Acceleration value car",            i16, rw,               0, rpdo},
    {0x6400, 0x6400, variable, 0x00, 0x00, "Control word",                      u16, ro,               0, tpdo},
    {0x6401, 0x6401, variable, 0x00, 0x00, "Status word",                       u16, rw,               0, rpdo},
    {0x6403, 0x6403, variable, 0x00, 0x00, "Modes of operation",                i8,  ro,               0, tpdo},
    {0x6404, 0x6404, variable, 0x00, 0x00, "Modes of operation display",        i8,  rw,               0, rpdo},
    {0x6406, 0x6406, variable, 0x00, 0x00, "Control effort",                    i32, rw,               0, rpdo},
    {0x6407, 0x6407, variable, 0x00, 0x00, "Position actual value",             u32, rw,      0xFFFFFFFF, rpdo},
    {0x6420, 0x6420, variable, 0x00, 0x00, "Target position",                   i32, ro,               0, tpdo},
    {0x6423, 0x6423, variable, 0x00, 0x00, "Profile velocity",                  u32, ro,               0, tpdo},
    {0x6430, 0x6430, variable, 0x00, 0x00, "Target velocity",                   i32, ro,               0, tpdo},
    {0x6433, 0x6433, variable, 0x00, 0x00, "Velocity actual value",             i32, rw,               0, rpdo},
    {0x6480, 0x6480, sub,      0x01, 0x01, "Load value: absolute load",         u16, rw,          0xFFFF, rpdo},
    {0x6480, 0x6480, sub,      0x02, 0x02, "Load value: SI unit",               u16, rw,               2, rpdo},
    {0x6482, 0x6482, sub,      0x01, 0x01, "Load signalling: load signal",      u8,  rw,               0, rpdo},
    {0x6482, 0x6482, sub,      0x02, 0x02, "Load signalling: interrupt",        u8,  rw,               0, rpdo},
});

/// A PDO of lift 1 and what it maps.
struct LiftPdo {
  std::uint16_t communication = 0;
  std::uint32_t cob_id = 0;
  std::array<std::uint32_t, 4> mapping{};
};
// Tables 5.6 to 5.10. Those of lifts 2, 4, 6 and 8 are misprinted for TPDOs: they are as those of lift 1.
constexpr std::array lift_pdos = std::to_array<LiftPdo>({
    {0x1501, 0x00000188, {0x64820108, 0x64800110}},
    {0x1503, 0x00000183, {0x64010010, 0x64040008, 0x00050008, 0x64330020}},
    {0x1505, 0x00000181, {0x64060020}},
    {0x1506, 0x0000018C, {0x63830120}},
    {0x1507, 0x0000018D, {0x63830220}},
    {0x150A, 0x00000201, {0x63010110, 0x63020110}},
    {0x150B, 0x00000205, {0x63100108}},
    {0x150C, 0x00000202, {0x63010210, 0x63020210}},
    {0x150D, 0x00000206, {0x63100208}},
    {0x150E, 0x00000203, {0x63010310, 0x63020310}},
    {0x150F, 0x00000207, {0x63100308}},
    {0x1580, 0x0000018E, {0x63830320}},
    {0x1581, 0x0000018F, {0x63830420}},
    {0x1902, 0xC0000182, {0x64000010, 0x64030008, 0x67FE0008, 0x64300020}},
    {0x1904, 0xC0000180, {0x64200020, 0x64230020}},
    {0x1908, 0xC0000200, {0x63000110, 0x63000210, 0x63000310, 0x63000410}},
});
// clang-format on

constexpr std::uint32_t filler = 0x67FE0008;
constexpr std::uint32_t first_lift_object = 0x62000000;

ObjectRow of(std::uint16_t index, unsigned sub_index, std::string_view name, DataType type, Access access,
             std::uint64_t value, unsigned flags) {
  const auto number = static_cast<std::uint8_t>(sub_index);
  return {index, index, sub, number, number, name, type, access, value, flags};
}

/// A PDO whose mapping cannot be changed.
void add_pdo(std::vector<ObjectRow>& rows, std::uint16_t communication, std::uint32_t cob_id,
             std::span<const std::uint32_t> mapping) {
  rows.push_back(of(communication, 1, "PDO communication: COB-ID", u32, rw, cob_id, stored));
  rows.push_back(of(communication, 2, "PDO communication: type", u8, rw, 0xFF, stored));
  rows.push_back(of(communication, 3, "PDO communication: inhibit time", u16, rw, 0, stored));
  rows.push_back(of(communication, 5, "PDO communication: event timer", u16, rw, 0, stored));
  const auto index = static_cast<std::uint16_t>(communication + 0x0200);
  for (unsigned entry = 1; entry <= mapping.size(); ++entry)
    rows.push_back(of(index, entry, "PDO mapping", u32, ro, mapping[entry - 1], plain));
}

std::vector<ObjectRow> make_rows() {
  std::vector<ObjectRow> rows(common_rows.begin(), common_rows.end());
  // Destination MPDOs of every node.
  for (std::uint16_t node = 1; node <= 127; ++node) {
    const auto index = static_cast<std::uint16_t>(0x1400 + node);
    rows.push_back(of(index, 1, "MPDO receive: COB-ID", u32, rw, 0x500U + node, stored));
    rows.push_back(of(index, 2, "MPDO receive: type", u8, ro, 0xFF, plain));
    rows.push_back(
        of(static_cast<std::uint16_t>(index + 0x0200), 0, "MPDO receive mapping", u8, ro, 0xFF, plain));
  }
  // Table 5.7 maps virtual inputs to 6011H, the virtual output.
  constexpr std::array<std::uint32_t, 1> input{0x60100030}, output{0x60110030};
  constexpr std::uint16_t panels = 64;
  for (std::uint16_t panel = 1; panel <= panels; ++panel)
    add_pdo(rows, static_cast<std::uint16_t>(0x1480 + panel), 0x480U + panel, input);
  add_pdo(rows, 0x1900, 0x40000400, output);
  for (unsigned lift = 0; lift < most_lifts; ++lift) {
    for (ObjectRow row : lift_rows) {
      row.first = row.last = static_cast<std::uint16_t>(row.first + 0x0800 * lift);
      rows.push_back(row);
    }
    for (const LiftPdo& pdo : lift_pdos) {
      std::vector<std::uint32_t> mapping;
      for (const std::uint32_t entry : pdo.mapping) {
        const bool is_common = entry < first_lift_object || entry == filler;
        if (entry != 0) mapping.push_back(is_common ? entry : entry + 0x0800'0000 * lift);
      }
      add_pdo(rows, static_cast<std::uint16_t>(pdo.communication + 0x10 * lift), pdo.cob_id + 0x10 * lift,
              mapping);
    }
  }
  return rows;
}

}  // namespace

std::shared_ptr<const canopen::DictionaryDescription> lift_dictionary() {
  static const auto description = [] {
    DataExchangeLayout exchange = exchange_layout;
    exchange.words = 4;
    exchange.pdos = 1;
    const std::vector<ObjectRow> rows = make_rows();
    return q_iqr::make_dictionary(
        identity, {.exchange = exchange, .rpdo_timers = true, .predefined_pdos = false, .more = rows});
  }();
  return description;
}

}  // namespace canopus::module::fx3u_can
