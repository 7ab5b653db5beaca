#include "canopus/sim/lift/units.hpp"

#include <algorithm>
#include <span>

#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/eds/writer.hpp"

namespace canopus::sim::lift {

namespace {

using canopen::Access;
using canopen::DataType;
using canopen::DictionaryBuilder;
using canopen::EntrySpec;
using canopen::ObjectCode;

constexpr auto u8 = DataType::unsigned8;
constexpr auto u16 = DataType::unsigned16;
constexpr auto u32 = DataType::unsigned32;
constexpr auto u48 = DataType::unsigned48;
constexpr auto i8 = DataType::integer8;
constexpr auto i16 = DataType::integer16;
constexpr auto i32 = DataType::integer32;

/// An object of lift 1; subs 0: a variable.
struct Object {
  std::uint16_t index = 0;
  std::uint8_t subs = 0;
  const char* name = "";
  const char* sub_name = "";
  DataType type = u16;
  bool received = false;  // from the controller; others are sent
  std::uint32_t value = 0;
};
/// A PDO of lift 1. Mapping entries below 62000000H are common to all lifts.
struct Pdo {
  std::uint16_t communication = 0;
  std::uint32_t cob_id = 0;
  std::vector<std::uint32_t> mapping{};
  std::uint16_t inhibit = 0;  // 100 us
  bool adds_node_id = false;
};
struct Kind {
  const char* file = "";
  const char* product = "";
  const char* name = "";
  std::uint32_t product_code = 0;
  std::vector<Object> objects{};
  std::vector<Pdo> pdos{};
};

constexpr std::uint32_t filler_object = 0x67FE0008;
constexpr std::uint16_t each_20_ms = 200;

// clang-format off
Kind panel(const char* file, const char* product, const char* name, std::uint32_t code) {
  return {file, product, name, code,
          {{0x6010, 0, "Virtual input mapping",  "", u48, false, 0},
           {0x6011, 0, "Virtual output mapping", "", u48, true,  0}},
          {{0x1881, 0x480, {0x60100030}, 0, true},
           {0x1500, 0x400, {0x60110030}}}};
}

Kind kind_of(const Unit& unit) {
  const auto door = static_cast<std::uint32_t>(unit.door);
  const std::uint32_t sub = (door + 1) << 8U;
  const auto pdo_of_door = static_cast<std::uint16_t>(0x190A + 2 * door);
  switch (unit.kind) {
    case UnitKind::hall_panel: return panel("hall-panel", "Canopus hall panel", "floor", 0x41701);
    case UnitKind::car_panel: return panel("car-panel", "Canopus car panel", "car panel", 0x41702);
    case UnitKind::car_drive_unit:
      return {"car-drive-unit", "Canopus car drive unit", "drive", 0x41703,
              {{0x6400, 0, "Control word",               "", u16, true,  0},
               {0x6401, 0, "Status word",                "", u16, false, 0},
               {0x6403, 0, "Modes of operation",         "", i8,  true,  0},
               {0x6404, 0, "Modes of operation display", "", i8,  false, 0},
               {0x6406, 0, "Control effort",             "", i32, false, 0},
               {0x6407, 0, "Position actual value",      "", i32, false, 0},
               {0x6420, 0, "Target position",            "", i32, true,  0},
               {0x6423, 0, "Profile velocity",           "", u32, true,  0},
               {0x6430, 0, "Target velocity",            "", i32, true,  0},
               {0x6433, 0, "Velocity actual value",      "", i32, false, 0},
               {0x67FE, 0, "Filler",                     "", u8,  false, 0}},
              {{0x1502, 0x182, {0x64000010, 0x64030008, filler_object, 0x64300020}},
               {0x1504, 0x180, {0x64200020, 0x64230020}},
               {0x1903, 0x183, {0x64010010, 0x64040008, filler_object, 0x64330020}, each_20_ms},
               {0x1905, 0x181, {0x64060020}, 5 * each_20_ms}}};
    case UnitKind::car_position_unit:
      return {"car-position-unit", "Canopus car position unit", "position", 0x41704,
              {{0x6383, 1, "Position value",         "Position unit 1", u32, false, 0xFFFFFFFF},
               {0x6390, 1, "Speed value car",        "Position unit 1", i16, false, 0},
               {0x6391, 1, "Acceleration value car", "Position unit 1", i16, false, 0}},
              {{0x1906, 0x18C, {0x63830120}, each_20_ms}}};
    case UnitKind::load_unit:
      return {"load-unit", "Canopus load measuring unit", "load", 0x41705,
              {{0x6480, 2, "Load value",       "Absolute load; SI unit",      u16, false, 0},
               {0x6482, 2, "Load signalling",  "Load signal; load interrupt", u8,  false, 0}},
              {{0x1901, 0x188, {0x64820108, 0x64800110}, each_20_ms}}};
    case UnitKind::car_door_unit: break;
  }
  return {"car-door-unit", "Canopus car door unit", "door", 0x41706,
          {{0x6300, 4, "Door control word",     "Door", u16, true,  0xFFFF},
           {0x6301, 4, "Door status word",      "Door", u16, false, 0xFFFF},
           {0x6302, 4, "Door position",         "Door", u16, false, 0xFFFF},
           {0x6310, 4, "Light barrier status",  "Door", u8,  false, 0xFF}},
          {{0x1508, 0x200, {0x63000110, 0x63000210, 0x63000310, 0x63000410}},
           {pdo_of_door, 0x201 + door, {0x63010010 | sub, 0x63020010 | sub}, each_20_ms},
           {static_cast<std::uint16_t>(pdo_of_door + 1), 0x205 + door, {0x63100008 | sub}}}};
}
// clang-format on

EntrySpec spec(const char* name, DataType type, Access access, std::uint64_t value, unsigned bytes) {
  return {.name = name, .type = type, .access = access, .value = can::little_endian(value, bytes)};
}

unsigned bytes_of(DataType type) {
  if (type == u8 || type == i8) return 1;
  if (type == u16 || type == i16) return 2;
  return type == u48 ? 6 : 4;
}

void add_communication(DictionaryBuilder& objects, const Unit& unit, const Kind& kind) {
  constexpr auto ro = Access::read_only;
  constexpr auto rw = Access::read_write;
  objects.variable(0x1000, spec("Device type", u32, ro, 0x1A1, 4));
  objects.variable(0x1001, spec("Error register", u8, ro, 0, 1));
  objects.uniform(0x1003, ObjectCode::array, "Pre-defined error field", 8,
                  spec("Standard error field", u32, ro, 0, 4));
  objects.sub(0x1003, 0, spec("Number of errors", u8, rw, 0, 1));
  EntrySpec emergency = spec("COB-ID EMCY", u32, rw, 0x80, 4);
  emergency.adds_node_id = true;
  objects.variable(0x1014, emergency);
  objects.variable(0x1017, spec("Producer heartbeat time", u16, rw, 1000, 2));
  objects.object(0x1018, ObjectCode::record, "Identity object");
  objects.sub(0x1018, 1, spec("Vendor-ID", u32, ro, 0, 4));
  objects.sub(0x1018, 2, spec("Product code", u32, ro, kind.product_code, 4));
  objects.sub(0x1018, 3, spec("Revision number", u32, ro, 0x00010000, 4));
  objects.sub(0x1018, 4, spec("Serial number", u32, ro, 1, 4));
  objects.variable(0x6001, spec("Lift number", u8, Access::read_only, unit.lifts, 1));
}

void add_pdo(DictionaryBuilder& objects, const Pdo& pdo, unsigned lift) {
  const bool transmits = pdo.communication >= 0x1800;
  const bool is_of_lift = pdo.mapping.front() >= 0x62000000;
  const auto communication = static_cast<std::uint16_t>(pdo.communication + (is_of_lift ? 0x10 * lift : 0));
  const auto index = static_cast<std::uint16_t>(communication + 0x200);
  objects.object(communication, ObjectCode::record,
                 transmits ? "TPDO communication parameter" : "RPDO communication parameter");
  EntrySpec cob_id = spec("COB-ID", u32, Access::read_write, pdo.cob_id + (is_of_lift ? 0x10 * lift : 0), 4);
  if (transmits) cob_id.value[3] = 0x40;  // no RTR
  cob_id.adds_node_id = pdo.adds_node_id;
  objects.sub(communication, 1, cob_id);
  objects.sub(communication, 2, spec("Transmission type", u8, Access::read_write, 0xFF, 1));
  if (transmits) objects.sub(communication, 3, spec("Inhibit time", u16, Access::read_write, pdo.inhibit, 2));
  objects.object(index, ObjectCode::record, transmits ? "TPDO mapping parameter" : "RPDO mapping parameter");
  objects.sub(index, 0, spec("Number of mapped objects", u8, Access::constant, pdo.mapping.size(), 1));
  std::uint8_t sub = 0;
  for (const std::uint32_t entry : pdo.mapping) {
    const bool shifts = entry >= 0x62000000 && entry != filler_object;
    objects.sub(index, ++sub,
                spec("Mapped object", u32, Access::constant, entry + (shifts ? 0x08000000U * lift : 0U), 4));
  }
}

std::shared_ptr<eds::DeviceFile> make(const Unit& unit) {
  const Kind kind = kind_of(unit);
  DictionaryBuilder objects;
  add_communication(objects, unit, kind);
  for (const Object& object : kind.objects) {
    const bool is_of_lift = object.index >= 0x6200 && object.index != 0x67FE;
    const auto index = static_cast<std::uint16_t>(object.index + (is_of_lift ? 0x0800 * unit.lift : 0));
    EntrySpec entry =
        spec(object.subs == 0 ? object.name : object.sub_name, object.type,
             object.received ? Access::read_write : Access::read_only, object.value, bytes_of(object.type));
    const bool is_filler = object.index == (filler_object >> 16U);
    entry.rpdo_mappable = object.received || is_filler;
    entry.tpdo_mappable = !object.received;
    if (is_filler) entry.access = Access::read_write;
    if (object.subs == 0) {
      objects.variable(index, entry);
    } else {
      objects.uniform(index, ObjectCode::array, object.name, object.subs, entry);
    }
  }
  for (const Pdo& pdo : kind.pdos) add_pdo(objects, pdo, unit.lift);
  auto file = std::make_shared<eds::DeviceFile>();
  file->file.file_name = std::string(kind.file) + ".eds";
  file->file.version = file->file.revision = 1;
  file->file.eds_version = "4.0";
  file->file.description = std::string(kind.product) + ", CiA 417, simulated: no such device is for sale";
  file->file.creation_time = file->file.modification_time = "09:00AM";
  file->file.creation_date = file->file.modification_date = "11-22-2026";
  file->file.created_by = file->file.modified_by = "Canopus";
  file->device.vendor_name = "Canopus";
  file->device.product_name = kind.product;
  file->device.order_code = "-";
  file->device.vendor_number = 0;
  file->device.product_number = kind.product_code;
  file->device.revision_number = 0x00010000;
  file->device.bit_rates = {10'000, 20'000, 50'000, 125'000, 250'000, 500'000, 800'000, 1'000'000};
  file->device.simple_boot_up_slave = true;
  for (const Pdo& pdo : kind.pdos) ++(pdo.communication >= 0x1800 ? file->device.tpdos : file->device.rpdos);
  file->dictionary = objects.build();
  return file;
}

}  // namespace

std::vector<Unit> units_of(const std::vector<std::uint8_t>& lifts,
                           const std::vector<std::uint8_t>& floor_doors) {
  std::vector<Unit> units;
  unsigned all = 0;
  for (const std::uint8_t number : lifts) all |= 1U << (number - 1U);
  std::uint8_t doors = 0;
  for (std::size_t floor = 0; floor < floor_doors.size(); ++floor) {
    doors = std::max<std::uint8_t>(doors, floor_doors[floor]);
    units.push_back({.kind = UnitKind::hall_panel,
                     .lifts = static_cast<std::uint8_t>(all),
                     .floor = static_cast<std::uint8_t>(floor + 1),
                     .door = floor_doors[floor]});
  }
  const auto of_car = [&](UnitKind kind, std::size_t car, std::uint8_t door = 0) {
    const auto lift = static_cast<std::uint8_t>(lifts[car] - 1U);
    units.push_back({.kind = kind,
                     .lifts = static_cast<std::uint8_t>(1U << lift),
                     .lift = lift,
                     .car = static_cast<std::uint8_t>(car),
                     .door = door});
  };
  for (std::size_t car = 0; car < lifts.size(); ++car) of_car(UnitKind::car_panel, car);
  for (std::size_t car = 0; car < lifts.size(); ++car) {
    of_car(UnitKind::car_drive_unit, car);
    of_car(UnitKind::car_position_unit, car);
    of_car(UnitKind::load_unit, car);
    for (std::uint8_t door = 0; door <= doors; ++door) of_car(UnitKind::car_door_unit, car, door);
  }
  return units;
}

std::string name(const Unit& unit) {
  std::string text = "lift ";
  bool first = true;
  for (unsigned lift = 0; lift < most_lifts; ++lift) {
    if ((unit.lifts >> lift & 1U) == 0) continue;
    text += (first ? "" : "+") + std::to_string(lift + 1);
    first = false;
  }
  text += ' ';
  text += kind_of(unit).name;
  if (unit.kind == UnitKind::hall_panel) text += ' ' + std::to_string(unit.floor);
  if (unit.kind == UnitKind::car_door_unit) text += ' ' + std::to_string(unit.door + 1);
  return text;
}

std::shared_ptr<const eds::DeviceFile> device_file(const Unit& unit) { return make(unit); }

std::string eds_text(const Unit& unit) {
  const auto file = make(unit);
  return eds::write_device_file(file->file, file->device, *file->dictionary);
}

}  // namespace canopus::sim::lift
