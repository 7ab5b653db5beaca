#include <array>

#include "canopus/module/canopen/object_rows.hpp"
#include "canopus/module/q_iqr/canopen_options.hpp"
#include "canopus/module/q_iqr/words.hpp"

namespace canopus::module::q_iqr {

namespace {

using namespace object_row;

// clang-format off
constexpr std::array rows = std::to_array<ObjectRow>({
    // first   last   kind      sub   ..     name                                 type   acc.     default  flags
    // There for RPDO mapping alone: an SDO access ends as if there were nothing [4.5].
    {0x0002, 0x0008, variable, 0x00, 0x00, "Data type",                          domain, rw,             0, plain},
    {0x1000, 0x1000, variable, 0x00, 0x00, "Device type",                        u32,    ro,    0x00000195, plain},
    {0x1001, 0x1001, variable, 0x00, 0x00, "Error register",                     u8,     ro,             0, plain},
    {0x1003, 0x1003, sub,      0x00, 0x00, "Pre-defined error field",            u8,     rw,             0, plain},
    {0x1003, 0x1003, sub,      0x01, 0x0F, "Pre-defined error field",            u32,    ro,             0, plain},
    {0x1005, 0x1005, variable, 0x00, 0x00, "COB-ID SYNC",                        u32,    rw,          0x80, stored},
    {0x1006, 0x1006, variable, 0x00, 0x00, "Communication cycle period",         u32,    rw,             0, stored},
    {0x100C, 0x100C, variable, 0x00, 0x00, "Guard time",                         u16,    rw,             0, stored},
    {0x100D, 0x100D, variable, 0x00, 0x00, "Life time factor",                   u8,     rw,             0, stored},
    {0x1010, 0x1010, array,    0x01, 0x01, "Store parameters",                   u32,    rw,             1, plain},
    {0x1011, 0x1011, array,    0x01, 0x01, "Restore default parameters",         u32,    rw,             1, plain},
    {0x1012, 0x1012, variable, 0x00, 0x00, "COB-ID TIME",                        u32,    rw,    0x80000100, stored},
    {0x1014, 0x1014, variable, 0x00, 0x00, "COB-ID EMCY",                        u32,    ro,          0x80, adds_node_id},
    {0x1015, 0x1015, variable, 0x00, 0x00, "Inhibit time EMCY",                  u16,    rw,             0, stored},
    {0x1016, 0x1016, array,    0x01, 0x7F, "Consumer heartbeat time",            u32,    rw,             0, stored},
    {0x1017, 0x1017, variable, 0x00, 0x00, "Producer heartbeat time",            u16,    rw,             0, stored},
    {0x1020, 0x1020, array,    0x01, 0x02, "Verify configuration",               u32,    rw,             0, stored},
    {0x1028, 0x1028, sub,      0x01, 0x7F, "Emergency consumer",                 u32,    rw,          0x80, stored | adds_sub_index},
    {0x1029, 0x1029, array,    0x01, 0x01, "Error behavior",                     u8,     rw,             0, stored},
    {0x102A, 0x102A, variable, 0x00, 0x00, "NMT inhibit time",                   u16,    ro,             0, plain},
    {0x1F22, 0x1F22, array,    0x01, 0x7F, "Concise DCF",                        domain, rw,             0, plain},
    {0x1F25, 0x1F25, array,    0x01, 0x80, "Configuration request",              u32,    wo,             0, plain},
    {0x1F26, 0x1F26, array,    0x01, 0x7F, "Expected configuration date",        u32,    rw,             0, stored},
    {0x1F27, 0x1F27, array,    0x01, 0x7F, "Expected configuration time",        u32,    rw,             0, stored},
    {0x1F80, 0x1F80, variable, 0x00, 0x00, "NMT start-up",                       u32,    rw,             0, stored},
    {0x1F81, 0x1F81, array,    0x01, 0x7F, "NMT slave assignment",               u32,    rw,             0, stored},
    {0x1F82, 0x1F82, sub,      0x01, 0x7F, "Request NMT",                        u8,     rw,             0, plain},
    {0x1F82, 0x1F82, sub,      0x80, 0x80, "Request NMT, all nodes",             u8,     wo,             0, plain},
    {0x1F83, 0x1F83, sub,      0x01, 0x7F, "Request node guarding",              u8,     rw,             0, plain},
    {0x1F83, 0x1F83, sub,      0x80, 0x80, "Request node guarding, all nodes",   u8,     wo,             0, plain},
    {0x1F84, 0x1F84, array,    0x01, 0x7F, "Device type identification",         u32,    rw,             0, stored},
    {0x1F85, 0x1F85, array,    0x01, 0x7F, "Vendor identification",              u32,    rw,             0, stored},
    {0x1F86, 0x1F86, array,    0x01, 0x7F, "Product code",                       u32,    rw,             0, stored},
    {0x1F87, 0x1F87, array,    0x01, 0x7F, "Revision number",                    u32,    rw,             0, stored},
    {0x1F88, 0x1F88, array,    0x01, 0x7F, "Serial number",                      u32,    rw,             0, stored},
    {0x1F89, 0x1F89, variable, 0x00, 0x00, "Boot time",                          u32,    rw,             0, stored},
    {0x1F90, 0x1F90, sub,      0x01, 0x01, "NMT master time-out",                u16,    rw,           100, stored},
    {0x1F90, 0x1F90, sub,      0x02, 0x02, "NMT master negotiation time delay",  u16,    rw,           500, stored},
    {0x1F90, 0x1F90, sub,      0x03, 0x03, "NMT master priority",                u16,    rw,             1, stored},
    {0x1F90, 0x1F90, sub,      0x04, 0x04, "Priority time slot",                 u16,    rw,          1500, stored},
    {0x1F90, 0x1F90, sub,      0x05, 0x05, "CANopen device time slot",           u16,    rw,            10, stored},
    {0x1F90, 0x1F90, sub,      0x06, 0x06, "Multiple NMT master detect cycle",   u16,    rw,          4000, stored},
});

// Of the first PDO; the others have the same.
constexpr std::array pdo_rows = std::to_array<ObjectRow>({
    {0x1400, 0x1400, sub,      0x01, 0x01, "RPDO communication: COB-ID",         u32,    rw,    0x80000000, stored},
    {0x1400, 0x1400, sub,      0x02, 0x02, "RPDO communication: type",           u8,     rw,          0xFE, stored},
    {0x1600, 0x1600, sub,      0x00, 0x00, "RPDO mapping",                       u8,     rw,             4, stored},
    {0x1600, 0x1600, sub,      0x01, 0x08, "RPDO mapping",                       u32,    rw,             0, stored},
    {0x1800, 0x1800, sub,      0x01, 0x01, "TPDO communication: COB-ID",         u32,    rw,    0xC0000000, stored},
    {0x1800, 0x1800, sub,      0x02, 0x02, "TPDO communication: type",           u8,     rw,          0xFE, stored},
    {0x1800, 0x1800, sub,      0x03, 0x03, "TPDO communication: inhibit time",   u16,    rw,             0, stored},
    {0x1800, 0x1800, sub,      0x05, 0x05, "TPDO communication: event timer",    u16,    rw,             0, stored},
    {0x1A00, 0x1A00, sub,      0x00, 0x00, "TPDO mapping",                       u8,     rw,             4, stored},
    {0x1A00, 0x1A00, sub,      0x01, 0x08, "TPDO mapping",                       u32,    rw,             0, stored},
});
// Where RPDOs have them [FX3U-CAN 5.6.5].
constexpr std::array rpdo_timer_rows = std::to_array<ObjectRow>({
    {0x1400, 0x1400, sub,      0x03, 0x03, "RPDO communication: inhibit time",   u16,    rw,             0, stored},
    {0x1400, 0x1400, sub,      0x05, 0x05, "RPDO communication: event timer",    u16,    rw,             0, stored},
});

// PDOs 1 to 4 use the pre-defined connection set [ME3CAN1-Q Tab. 4-7, 4-9].
constexpr std::array default_pdos = std::to_array<ObjectRow>({
    {0x1400, 0x1400, sub, 0x01, 0x01, "RPDO communication: COB-ID", u32, rw, 0x00000200, stored | adds_node_id},
    {0x1401, 0x1401, sub, 0x01, 0x01, "RPDO communication: COB-ID", u32, rw, 0x00000300, stored | adds_node_id},
    {0x1402, 0x1402, sub, 0x01, 0x01, "RPDO communication: COB-ID", u32, rw, 0x00000400, stored | adds_node_id},
    {0x1403, 0x1403, sub, 0x01, 0x01, "RPDO communication: COB-ID", u32, rw, 0x00000500, stored | adds_node_id},
    {0x1800, 0x1800, sub, 0x01, 0x01, "TPDO communication: COB-ID", u32, rw, 0x40000180, stored | adds_node_id},
    {0x1801, 0x1801, sub, 0x01, 0x01, "TPDO communication: COB-ID", u32, rw, 0x40000280, stored | adds_node_id},
    {0x1802, 0x1802, sub, 0x01, 0x01, "TPDO communication: COB-ID", u32, rw, 0x40000380, stored | adds_node_id},
    {0x1803, 0x1803, sub, 0x01, 0x01, "TPDO communication: COB-ID", u32, rw, 0x40000480, stored | adds_node_id},
});
// clang-format on

void add_pdo_rows(canopen::DictionaryBuilder& builder, std::span<const ObjectRow> of_first, unsigned pdos) {
  for (ObjectRow row : of_first) {
    row.last = static_cast<std::uint16_t>(row.first + pdos - 1);
    add_rows(builder, {&row, 1});
  }
}

}  // namespace

std::shared_ptr<const canopen::DictionaryDescription> make_dictionary(const Identity& identity,
                                                                      const DictionaryShape& shape) {
  // clang-format off
  const std::array own_rows = std::to_array<ObjectRow>({
      {0x1008, 0x1008, variable, 0x00, 0x00, "Device name",               string, ro, 0,                 plain, identity.device_name},
      {0x1009, 0x1009, variable, 0x00, 0x00, "Hardware version",          string, ro, 0,                 plain, identity.hardware_version},
      {0x100A, 0x100A, variable, 0x00, 0x00, "Software version",          string, ro, 0,                 plain, identity.software_version},
      {0x1018, 0x1018, sub,      0x01, 0x01, "Identity: vendor-ID",       u32,    ro, identity.vendor,   plain},
      {0x1018, 0x1018, sub,      0x02, 0x02, "Identity: product code",    u32,    ro, identity.product,  plain},
      {0x1018, 0x1018, sub,      0x03, 0x03, "Identity: revision number", u32,    ro, identity.revision, plain},
  });
  // clang-format on
  canopen::DictionaryBuilder builder;
  add_rows(builder, own_rows);
  const DataExchangeLayout& exchange = shape.exchange;
  add_rows(builder, rows);
  add_pdo_rows(builder, pdo_rows, exchange.pdos);
  if (shape.rpdo_timers) add_pdo_rows(builder, rpdo_timer_rows, exchange.pdos);
  if (shape.predefined_pdos) add_rows(builder, default_pdos);
  // [ME3CAN1-Q Tab. 4-8, 4-10; RJ71CN91 App. 3; FX3U-CAN Tab. 5.2, 5.4]
  add_default_mappings(builder, exchange.pdos, exchange.variables);
  add_network_variables(builder, exchange.words * 2, exchange.variables);
  add_rows(builder, shape.more);
  return builder.build();
}

}  // namespace canopus::module::q_iqr
