#include <array>

#include "canopus/module/canopen/object_rows.hpp"
#include "canopus/module/models/fx2n_32can/buffer_table.hpp"
#include "canopus/module/models/fx2n_32can/fx2n_32can.hpp"

namespace canopus::module::fx2n_32can {

namespace {

using namespace object_row;

// The manual names the objects [5.3.2, 8]; types, access and defaults are CiA DS-301 V3.0's and DS-302 V2.0's.
// clang-format off
constexpr std::array rows = std::to_array<ObjectRow>({
    // first   last   kind      sub   ..     name                                 type   acc.     default  flags
    {0x1000, 0x1000, variable, 0x00, 0x00, "Device type",                        u32,    ro,    0x00000195, plain},
    {0x1001, 0x1001, variable, 0x00, 0x00, "Error register",                     u8,     ro,             0, plain | tpdo},
    {0x1004, 0x1004, variable, 0x00, 0x00, "Number of PDOs supported",           u32,    ro,    0x001E001E, plain},
    {0x1005, 0x1005, variable, 0x00, 0x00, "COB-ID SYNC",                        u32,    rw,          0x80, stored},
    {0x1006, 0x1006, variable, 0x00, 0x00, "Communication cycle period",         u32,    rw,             0, stored},
    {0x1007, 0x1007, variable, 0x00, 0x00, "Synchronous window length",          u32,    rw,             0, stored},
    {0x1008, 0x1008, variable, 0x00, 0x00, "Device name",                        string, ro,             0, plain, "FX2N-32CAN"},
    {0x1009, 0x1009, variable, 0x00, 0x00, "Hardware version",                   string, ro,             0, plain, "1.00"},
    {0x100A, 0x100A, variable, 0x00, 0x00, "Software version",                   string, ro,             0, plain, "1.00"},
    {0x100B, 0x100B, variable, 0x00, 0x00, "Node-ID",                            u32,    ro,             0, adds_node_id},
    {0x100C, 0x100C, variable, 0x00, 0x00, "Guard time",                         u16,    rw,             0, stored},
    {0x100D, 0x100D, variable, 0x00, 0x00, "Life time factor",                   u8,     rw,             0, stored},
    {0x1010, 0x1010, array,    0x01, 0x01, "Store parameters",                   u32,    rw,             1, plain},
    {0x1011, 0x1011, array,    0x01, 0x01, "Restore default parameters",         u32,    rw,             1, plain},
    {0x1200, 0x1200, sub,      0x01, 0x01, "SDO server: client to server",       u32,    ro,         0x600, adds_node_id},
    {0x1200, 0x1200, sub,      0x02, 0x02, "SDO server: server to client",       u32,    ro,         0x580, adds_node_id},
    {0x1400, 0x141D, sub,      0x01, 0x01, "RPDO communication: COB-ID",         u32,    rw,    0x80000000, stored},
    {0x1400, 0x1400, sub,      0x01, 0x01, "RPDO communication: COB-ID",         u32,    rw,    0x00000200, stored | adds_node_id},
    {0x1401, 0x1401, sub,      0x01, 0x01, "RPDO communication: COB-ID",         u32,    rw,    0x00000300, stored | adds_node_id},
    {0x1400, 0x141D, sub,      0x02, 0x02, "RPDO communication: type",           u8,     rw,          0xFE, stored},
    {0x1600, 0x161D, sub,      0x00, 0x00, "RPDO mapping",                       u8,     rw,             4, stored},
    {0x1600, 0x161D, sub,      0x05, 0x08, "RPDO mapping",                       u32,    rw,             0, stored},
    {0x1800, 0x181D, sub,      0x01, 0x01, "TPDO communication: COB-ID",         u32,    rw,    0x80000000, stored},
    {0x1800, 0x1800, sub,      0x01, 0x01, "TPDO communication: COB-ID",         u32,    rw,    0x00000180, stored | adds_node_id},
    {0x1801, 0x1801, sub,      0x01, 0x01, "TPDO communication: COB-ID",         u32,    rw,    0x00000280, stored | adds_node_id},
    {0x1800, 0x181D, sub,      0x02, 0x02, "TPDO communication: type",           u8,     rw,          0xFE, stored},
    {0x1800, 0x181D, sub,      0x03, 0x03, "TPDO communication: inhibit time",   u16,    rw,             0, stored},
    {0x1A00, 0x1A1D, sub,      0x00, 0x00, "TPDO mapping",                       u8,     rw,             4, stored},
    {0x1A00, 0x1A1D, sub,      0x05, 0x08, "TPDO mapping",                       u32,    rw,             0, stored},
    {0x1F80, 0x1F80, variable, 0x00, 0x00, "NMT start-up",                       u32,    rw,             0, stored},
    {0x1F81, 0x1F81, array,    0x01, 0x7F, "NMT slave assignment",               u32,    rw,             0, stored},
    {0x1F82, 0x1F82, sub,      0x01, 0x7F, "Request NMT",                        u8,     rw,             0, plain},
    {0x1F82, 0x1F82, sub,      0x80, 0x80, "Request NMT, all nodes",             u8,     wo,             0, plain},
    {0x1F83, 0x1F83, sub,      0x01, 0x7F, "Request node guarding",              u8,     rw,             0, plain},
    {0x1F83, 0x1F83, sub,      0x80, 0x80, "Request node guarding, all nodes",   u8,     wo,             0, plain},
});
// clang-format on

}  // namespace

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description = [] {
    canopen::DictionaryBuilder builder;
    add_rows(builder, rows);
    add_default_mappings(builder, exchange_layout.pdos, exchange_layout.variables);
    add_network_variables(builder, exchange_layout.words * 2, exchange_layout.variables);
    return builder.build();
  }();
  return description;
}

}  // namespace canopus::module::fx2n_32can
