#include "canopus/module/models/as_fcopm/object_table.hpp"

#include <array>

#include "canopus/manager/boot/start_up_bits.hpp"
#include "canopus/module/canopen/object_rows.hpp"
#include "canopus/module/models/as_fcopm/register_table.hpp"

namespace canopus::module::as_fcopm {

namespace {

using canopen::DataType;
using namespace object_row;

// clang-format off
/// Both roles [10.7].
constexpr std::array common_rows = std::to_array<ObjectRow>({
    // first   last   kind      sub   ..     name                          type   acc. default     flags
    {0x1000, 0x1000, variable, 0x00, 0x00, "Device type",                 u32,    ro, 0x00000000, plain},
    {0x1001, 0x1001, variable, 0x00, 0x00, "Error register",              u8,     ro, 0,          plain},
    {0x1005, 0x1005, variable, 0x00, 0x00, "COB-ID SYNC",                 u32,    rw, 0x00000080, plain},
    {0x1008, 0x1008, variable, 0x00, 0x00, "Manufacturer device name",    string, ro, 0,          plain, "AS300 Series PLC"},
    {0x1017, 0x1017, variable, 0x00, 0x00, "Producer heartbeat time",     u16,    rw, 0,          plain},
    {0x1018, 0x1018, sub,      0x01, 0x01, "Identity: Vendor-ID",         u32,    ro, 0x000001DD, plain},
    {0x1018, 0x1018, sub,      0x02, 0x02, "Identity: Product code",      u32,    ro, 0x00000055, plain},
    {0x1018, 0x1018, sub,      0x03, 0x03, "Identity: Revision number",   u32,    ro, 0x00010002, plain},
});

constexpr std::array slave_rows = std::to_array<ObjectRow>({
    {0x1014, 0x1014, variable, 0x00, 0x00, "COB-ID EMCY",                 u32,    ro, 0x00000080, adds_node_id},
    {0x1016, 0x1016, sub,      0x01, 0x01, "Consumer heartbeat time",     u32,    rw, 0,          plain},
    {0x1200, 0x1200, sub,      0x01, 0x01, "SDO server: client to server", u32,   ro, 0x600,      adds_node_id},
    {0x1200, 0x1200, sub,      0x02, 0x02, "SDO server: server to client", u32,   ro, 0x580,      adds_node_id},
    {0x1400, 0x1407, sub,      0x01, 0x01, "RxPDO: COB-ID",               u32,    rw, 0x80000000, plain},
    {0x1400, 0x1400, sub,      0x01, 0x01, "RxPDO: COB-ID",               u32,    rw, 0x00000200, adds_node_id},
    {0x1400, 0x1407, sub,      0x02, 0x02, "RxPDO: transmission type",    u8,     rw, 0xFF,       plain},
    {0x1400, 0x1407, sub,      0x03, 0x03, "RxPDO: inhibit time",         u16,    rw, 0,          plain},
    {0x1600, 0x1607, sub,      0x00, 0x00, "RxPDO: mapped objects",       u8,     rw, 0,          plain},
    {0x1600, 0x1607, sub,      0x01, 0x04, "RxPDO: mapped object",        u32,    rw, 0,          plain},
    {0x1600, 0x1600, sub,      0x00, 0x00, "RxPDO: mapped objects",       u8,     rw, 4,          plain},
    {0x1600, 0x1600, sub,      0x01, 0x01, "RxPDO: mapped object",        u32,    rw, 0x20000110, plain},
    {0x1600, 0x1600, sub,      0x02, 0x02, "RxPDO: mapped object",        u32,    rw, 0x20000210, plain},
    {0x1600, 0x1600, sub,      0x03, 0x03, "RxPDO: mapped object",        u32,    rw, 0x20000310, plain},
    {0x1600, 0x1600, sub,      0x04, 0x04, "RxPDO: mapped object",        u32,    rw, 0x20000410, plain},
    {0x1800, 0x1807, sub,      0x01, 0x01, "TxPDO: COB-ID",               u32,    rw, 0x80000000, plain},
    {0x1800, 0x1800, sub,      0x01, 0x01, "TxPDO: COB-ID",               u32,    rw, 0x00000180, adds_node_id},
    {0x1800, 0x1807, sub,      0x02, 0x02, "TxPDO: transmission type",    u8,     rw, 0xFF,       plain},
    {0x1800, 0x1807, sub,      0x03, 0x03, "TxPDO: inhibit time",         u16,    rw, 50,         plain},
    {0x1800, 0x1807, sub,      0x05, 0x05, "TxPDO: event timer",          u16,    rw, 100,        plain},
    {0x1A00, 0x1A07, sub,      0x00, 0x00, "TxPDO: mapped objects",       u8,     rw, 0,          plain},
    {0x1A00, 0x1A07, sub,      0x01, 0x04, "TxPDO: mapped object",        u32,    rw, 0,          plain},
    {0x1A00, 0x1A00, sub,      0x00, 0x00, "TxPDO: mapped objects",       u8,     rw, 4,          plain},
    {0x1A00, 0x1A00, sub,      0x01, 0x01, "TxPDO: mapped object",        u32,    rw, 0x20010110, plain},
    {0x1A00, 0x1A00, sub,      0x02, 0x02, "TxPDO: mapped object",        u32,    rw, 0x20010210, plain},
    {0x1A00, 0x1A00, sub,      0x03, 0x03, "TxPDO: mapped object",        u32,    rw, 0x20010310, plain},
    {0x1A00, 0x1A00, sub,      0x04, 0x04, "TxPDO: mapped object",        u32,    rw, 0x20010410, plain},
    {0x2000, 0x2000, array,    0x01, 0x20, "Input words D24032 on",       u16,    rw, 0,          rpdo},
    {0x2001, 0x2001, array,    0x01, 0x20, "Output words D25032 on",      u16,    ro, 0,          tpdo},
});
// clang-format on

class MasterObjects {
 public:
  std::shared_ptr<const canopen::DictionaryDescription> build(const Configuration& configuration,
                                                              const Layout& layout) {
    add_rows(builder_, common_rows);
    namespace assignment = manager::assignment_bit;
    value(0x1005, configuration.cycle_period != 0 ? 0x40000080U : 0x80U, u32);
    value(0x1006, configuration.cycle_period * 1000U, u32);
    value(0x1017, configuration.master_heartbeat, u16);
    values(0x1016, 127, u32, "Consumer heartbeat time");
    values(0x1028, 127, u32, "Emergency consumer");
    for (std::uint8_t node = 1; node < 128; ++node) entry(0x1028, node, 0x80U + node, u32);
    value(0x1F80, manager::start_up_bit::nmt_master, u32);
    values(0x1F81, 127, u32, "NMT slave assignment");
    values(0x1F82, 128, u8, "Request NMT");
    values(0x1F83, 128, u8, "Request guarding");
    for (std::uint16_t index = 0x1F84; index <= 0x1F88; ++index) values(index, 127, u32, "Expected identity");
    for (const SlaveSetting& slave : configuration.slaves) {
      const std::uint8_t node = slave.node_id;
      if (node == configuration.node_id) continue;
      entry(0x1F81, node, assignment::slave | assignment::boot_slave, u32);
      entry(0x1F84, node, slave.device_type.value_or(0), u32);
      entry(0x1F85, node, slave.vendor.value_or(0), u32);
      entry(0x1F86, node, slave.product.value_or(0), u32);
      entry(0x1F87, node, slave.revision.value_or(0), u32);
      const std::uint32_t watch = std::uint32_t{node} << 16 | slave.heartbeat_time_out;
      if (slave.heartbeat != 0) entry(0x1016, node, watch, u32);
    }
    std::uint16_t number = 0;
    for (const PdoPlace& place : layout.received) {
      // Data are valid in the master at once, whatever type the slave sends by.
      pdo(0x1400, number, place, 0xFF);
      map(0x1600, received_bytes_index, number++, place.bytes, true);
    }
    number = 0;
    for (const PdoPlace& place : layout.sent) {
      const std::uint8_t type = place.pdo->type;
      pdo(0x1800, number, place, type >= 1 && type <= 240 ? type : std::uint8_t{0xFF});
      map(0x1A00, sent_bytes_index, number++, place.bytes, false);
    }
    return builder_.build();
  }

 private:
  static canopen::EntrySpec spec(std::uint32_t number, DataType type) {
    return {.type = type, .access = rw, .value = canopen::little_endian(number, canopen::byte_length(type))};
  }
  void value(std::uint16_t index, std::uint32_t number, DataType type) {
    builder_.variable(index, spec(number, type));
  }
  void values(std::uint16_t index, std::uint8_t count, DataType type, const char* name) {
    builder_.object(index, canopen::ObjectCode::array, name);
    for (std::uint8_t sub = 1; sub <= count; ++sub) builder_.sub(index, sub, spec(0, type));
  }
  void entry(std::uint16_t index, std::uint8_t sub, std::uint32_t number, DataType type) {
    builder_.sub(index, sub, spec(number, type));
  }
  void pdo(std::uint16_t first, std::uint16_t number, const PdoPlace& place, std::uint8_t type) {
    const auto index = static_cast<std::uint16_t>(first + number);
    builder_.object(index, canopen::ObjectCode::record, "PDO communication");
    const std::uint32_t no_remote_frame = first == 0x1800 ? 0x40000000U : 0U;
    builder_.sub(index, 1, spec(no_remote_frame | place.cob_id, u32));
    builder_.sub(index, 2, spec(type, u8));
  }
  void map(std::uint16_t first, std::uint16_t first_object, std::uint16_t number, unsigned bytes,
           bool receive) {
    const auto index = static_cast<std::uint16_t>(first + number);
    const auto object = static_cast<std::uint16_t>(first_object + number);
    canopen::EntrySpec byte = spec(0, u8);
    byte.rpdo_mappable = receive;
    byte.tpdo_mappable = !receive;
    builder_.uniform(object, canopen::ObjectCode::array, "PDO bytes", 8, byte);
    builder_.object(index, canopen::ObjectCode::record, "PDO mapping");
    builder_.sub(index, 0, spec(bytes, u8));
    for (unsigned sub = 1; sub <= bytes; ++sub) {
      const std::uint32_t mapped = std::uint32_t{object} << 16 | sub << 8 | 8U;
      builder_.sub(index, static_cast<std::uint8_t>(sub), spec(mapped, u32));
    }
  }

  canopen::DictionaryBuilder builder_;
};

}  // namespace

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description = [] {
    canopen::DictionaryBuilder builder;
    add_rows(builder, common_rows);
    add_rows(builder, slave_rows);
    // Sub-index 04H is not there [10.7].
    for (std::uint16_t index = 0x1800; index <= 0x1807; ++index)
      builder.sub(index, 0, {.name = "Number of valid subindex", .type = u8, .access = ro, .value = {5}});
    return builder.build();
  }();
  return description;
}

std::shared_ptr<const canopen::DictionaryDescription> master_dictionary(const Configuration& configuration,
                                                                        const Layout& layout) {
  return MasterObjects().build(configuration, layout);
}

}  // namespace canopus::module::as_fcopm
