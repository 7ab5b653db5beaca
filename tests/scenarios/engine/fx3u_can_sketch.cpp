#include "scenarios/engine/fx3u_can_sketch.hpp"

#include "canopus/module/areas/object_rows.hpp"

namespace canopus::scenario {

using namespace module;
using canopen::Access;
using canopen::DataType;

namespace {

// Function modes (#21). 417 is not sketched.
constexpr Modes mode_405 = 1;
constexpr Modes layer2_11 = 2;
constexpr Modes layer2_29 = 4;
constexpr Modes layer2 = layer2_11 | layer2_29;
constexpr Modes all_modes = mode_405 | layer2;
constexpr std::array<std::uint16_t, 3> function_modes{405, 11, 29};
constexpr std::array<std::uint16_t, 9> baud_rates{10, 20, 50, 100, 125, 250, 500, 800, 1000};
constexpr std::array mode_rows = std::to_array<FunctionModeRow>({
    {405, mode_405, FunctionModeRow::Kind::canopen},
    {11, layer2_11, FunctionModeRow::Kind::layer2_base},
    {29, layer2_29, FunctionModeRow::Kind::layer2_extended},
});

// The first 30 of its 80 PDOs each way: 120 words, one index of each network variable.
constexpr std::uint16_t pdos = 30;
constexpr BufferAddress words = 4 * pdos;
constexpr DataExchangeLayout process_data{
    .receive_first = 10000, .transmit_first = 11000, .words = words, .pdos = pdos};
constexpr std::array windows = std::to_array<ProcessDataWindow>({
    {0, 19, 0, mode_405},
    {100, 199, 20, mode_405},
});

constexpr auto rw = WordAccess::read_write;
constexpr auto ro = WordAccess::read;
constexpr auto wo = WordAccess::write;
constexpr auto yes = Stored::yes;
constexpr auto no = Stored::no;
// clang-format off
constexpr std::array buffer_rows = std::to_array<BufferRow>({
    // first   last  name                                access default range                   stored modes      section  stride offline, bits
    {     0,     19, "RPDO data",                        ro,        0, any_value,               no,  mode_405,  "6.1"},
    {     0,     19, "TPDO data",                        wo,        0, any_value,               no,  mode_405,  "6.1"},
    {    20,     20, "Data exchange control",            rw,        0, any_value,               no,  all_modes, "6.4"},
    {    21,     21, "Function mode",                    rw,      405, one_of(function_modes),  yes, all_modes, "6.5"},
    {    22,     22, "Save/restore configuration",       rw,        0, any_value,               no,  all_modes, "6.6",   1, false, 0x0003},
    {    24,     24, "Baud rate",                        rw,      250, one_of(baud_rates),      yes, all_modes, "6.7"},
    {    25,     25, "Communication status",             rw,        0, any_value,               no,  all_modes, "6.8"},
    {    27,     27, "Node address",                     rw,      127, between(1, 127),         yes, mode_405,  "6.10"},
    {    29,     29, "Error status",                     rw,        0, any_value,               no,  all_modes, "6.11"},
    {    30,     30, "Module ID code",                   ro,     7170, any_value,               no,  all_modes, "6.12"},
    {    35,     35, "CAN transmission error counter",   ro,        0, any_value,               no,  all_modes, "6.13"},
    {    36,     36, "CAN reception error counter",      ro,        0, any_value,               no,  all_modes, "6.14"},
    {    37,     37, "Baud rate display",                ro,     2500, any_value,               no,  all_modes, "6.15"},
    {    38,     38, "Sampling point display",           ro,      875, any_value,               no,  all_modes, "6.16"},
    {    39,     39, "BFM setting error display",        ro,        0, any_value,               no,  all_modes, "6.17"},
    {    40,     40, "Write error display",              ro,        0, any_value,               no,  all_modes, "6.18"},
    {    50,     50, "Time stamp: producer/consumer",    rw,        1, between(0, 3),           no,  mode_405,  "6.19"},
    {    51,     51, "Time stamp: year",                 rw,       12, any_value,               no,  mode_405,  "6.19"},
    {    52,     52, "Time stamp: month",                rw,        3, any_value,               no,  mode_405,  "6.19"},
    {    53,     53, "Time stamp: day",                  rw,        1, any_value,               no,  mode_405,  "6.19"},
    {    54,     56, "Time stamp: hour, minute, second", rw,        0, any_value,               no,  mode_405,  "6.19"},
    {    57,     57, "Time stamp: day of week",          ro,        4, any_value,               no,  mode_405,  "6.19"},
    {    58,     58, "Time stamp: interval",             rw,        0, any_value,               no,  mode_405,  "6.19"},
    {    59,     59, "Daily correction",                 rw,        0, between(-60, 60),        yes, mode_405,  "6.19"},
    {    70,     70, "NMT start all nodes delay",        rw,      500, any_value,               yes, mode_405,  "6.20"},
    {    71,     71, "SDO time-out",                     rw,      500, between(50, 32767),      yes, mode_405,  "6.21"},
    {   100,    199, "RPDO data",                        ro,        0, any_value,               no,  mode_405,  "6.1"},
    {   100,    199, "TPDO data",                        wo,        0, any_value,               no,  mode_405,  "6.1"},
    {   100,    387, "Message: CAN-ID low",              rw,   0xFFFF, any_value,               yes, layer2,    "9.1",   7},
    {   101,    388, "Message: CAN-ID high",             rw,   0xFFFF, any_value,               yes, layer2,    "9.1",   7},
    {   102,    389, "Message: RTR, new data, DLC",      rw,        0, any_value,               yes, layer2,    "9.1",   7},
    {   103,    390, "Message: bytes 1, 2",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   104,    391, "Message: bytes 3, 4",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   105,    392, "Message: bytes 5, 6",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   106,    393, "Message: bytes 7, 8",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   401,    442, "Message: error code",              rw,        0, between(0, 0),           no,  layer2,    "9.2"},
    {   601,    727, "NMT state",                        ro,        0, any_value,               no,  mode_405,  "6.22"},
    {   750,    750, "EMCY buffer, clear",               rw,        0, any_value,               no,  mode_405,  "6.23"},
    {   751,    859, "EMCY buffer",                      ro,        0, any_value,               no,  mode_405,  "6.23"},
    {   900,    963, "NMT error control status",         ro,        0, any_value,               no,  mode_405,  "6.24"},
    {  1000,   1066, "Command interface",                rw,        0, any_value,               no,  all_modes, "10.1"},
    {  1100,   1264, "Message configuration: A",         rw,   0xFFFF, any_value,               yes, layer2,    "9.3",   4, true},
    {  1101,   1265, "Message configuration: B",         rw,   0xFFFF, any_value,               yes, layer2,    "9.3",   4, true},
    {  1102,   1266, "Message configuration: C",         rw,        0, any_value,               yes, layer2,    "9.3",   4, true},
    {  1103,   1267, "Message configuration: D",         rw,        0, any_value,               yes, layer2,    "9.3",   4, true},
    {  1270,   1272, "RTR flags",                        ro,        0, any_value,               no,  layer2,    "9.4"},
    {  1280,   1282, "Message transmit trigger flags",   rw,        0, any_value,               no,  layer2,    "9.5"},
    {  1900,   1927, "RUN>STOP messages",                rw,   0xFFFF, any_value,               yes, layer2,    "9.6",   1, true},
    { 10000,  10119, "RPDO data",                        ro,        0, any_value,               no,  mode_405,  "6.1"},
    { 11000,  11119, "TPDO data",                        rw,        0, any_value,               no,  mode_405,  "6.1"},
});

/// Requests by bits: #20, #22, #25, and what else asks by being written, or read.
constexpr std::array request_words = std::to_array<RequestWordRow>({
    {  20, RequestUse::data_exchange,    1U << 0 | 1U << 8 | 1U << 12},
    {  22, RequestUse::save_restore,     1U << 0 | 1U << 1},
    {  25, RequestUse::restart,          1U << 0},
    {  25, RequestUse::online,           1U << 4, layer2},
    {  29, RequestUse::nmt_error,        1U << 10, mode_405},
    {  51, RequestUse::read_clock,       {}, mode_405},
    {  56, RequestUse::set_clock,        {}, mode_405},
    {1000, RequestUse::command},
    {1280, RequestUse::transmit_trigger, {}, layer2},
    {1281, RequestUse::transmit_trigger, {}, layer2},
    {1282, RequestUse::transmit_trigger, {}, layer2},
});

constexpr std::array error_rows = std::to_array<ErrorRow>({
    // error                     bit  latched  makes bit 0
    {ModuleError::hardware,        1, false,   true},
    {ModuleError::bus_off,         3, false,   true},
    {ModuleError::flash,           4, false,   true},
    {ModuleError::refused_write,   5, true,    true},
    {ModuleError::invalid_value,   6, true,    true},
    {ModuleError::queue_overflow,  8, true,    true},
    {ModuleError::node_failure,   10, true,    true},
    {ModuleError::error_passive,  14, false,   false},
    {ModuleError::message_slot,   15, true,    true},
});

constexpr std::array commands = std::to_array<CommandRow>({
    {0x0000, CommandKind::display,     all_modes, 0x0000, 0x0000},
    {0x0002, CommandKind::sdo_write,   mode_405,  0x0003, 0x000F},
    {0x0004, CommandKind::sdo_read,    mode_405,  0x0005, 0x000F},
    {0x0006, CommandKind::multi_write, mode_405,  0x0007, 0x00F7},
    {0x0008, CommandKind::multi_read,  mode_405,  0x0009, 0x00F9},
    {0x000A, CommandKind::emergency,   mode_405,  0x000B, 0x000C},
    {0x000C, CommandKind::send_frame,  layer2,    0x000D, 0xF00C},
    {0xFFFF, CommandKind::clear,       all_modes, 0x0000, 0x0000},
});

// FROM/TO is not sketched.
constexpr std::array leds = std::to_array<LedRow>({
    {"RUN",   LedUse::network_state},
    {"Tx/Rx", LedUse::traffic},
    {"POWER", LedUse::supply},
});

constexpr auto u8 = DataType::unsigned8;
constexpr auto u16 = DataType::unsigned16;
constexpr auto u32 = DataType::unsigned32;
using enum ObjectRow::Kind;
using enum ObjectRow::Flag;
constexpr std::array objects = std::to_array<ObjectRow>({
    {0x1000, 0x1000, variable, 0, 0,   "Device type",          u32, Access::read_only,  405,        plain},
    {0x1001, 0x1001, variable, 0, 0,   "Error register",       u8,  Access::read_only,  0,          plain},
    {0x1010, 0x1010, array,    1, 1,   "Store parameters",     u32, Access::read_write, 1,          plain},
    {0x1011, 0x1011, array,    1, 1,   "Restore parameters",   u32, Access::read_write, 1,          plain},
    {0x1012, 0x1012, variable, 0, 0,   "COB-ID TIME",          u32, Access::read_write, 0x80000100, stored},
    {0x1014, 0x1014, variable, 0, 0,   "COB-ID EMCY",          u32, Access::read_only,  0x80,       adds_node_id},
    {0x1016, 0x1016, array,    1, 127, "Consumer heartbeat",   u32, Access::read_write, 0,          stored},
    {0x1017, 0x1017, variable, 0, 0,   "Producer heartbeat",   u16, Access::read_write, 0,          stored},
    {0x1018, 0x1018, sub,      1, 1,   "Vendor-ID",            u32, Access::read_only,  0x71,       plain},
    {0x1018, 0x1018, sub,      2, 2,   "Product code",         u32, Access::read_only,  7170,       plain},
    {0x1018, 0x1018, sub,      3, 3,   "Revision number",      u32, Access::read_only,  0x00010000, plain},
    {0x1028, 0x1028, sub,      1, 127, "Emergency consumer",   u32, Access::read_write, 0x80,       stored | adds_sub_index},
    {0x1029, 0x1029, array,    1, 1,   "Error behaviour",      u8,  Access::read_write, 0,          stored},
    {0x1400, 0x141D, sub,      1, 1,   "RPDO: COB-ID",         u32, Access::read_write, 0x80000000, stored},
    {0x1400, 0x141D, sub,      2, 2,   "RPDO: type",           u8,  Access::read_write, 0xFE,       stored},
    {0x1600, 0x161D, sub,      0, 0,   "RPDO mapping",         u8,  Access::read_write, 4,          stored},
    {0x1600, 0x161D, sub,      1, 8,   "RPDO mapping",         u32, Access::read_write, 0,          stored},
    {0x1800, 0x181D, sub,      1, 1,   "TPDO: COB-ID",         u32, Access::read_write, 0xC0000000, stored},
    {0x1800, 0x181D, sub,      2, 2,   "TPDO: type",           u8,  Access::read_write, 0xFE,       stored},
    {0x1800, 0x181D, sub,      3, 3,   "TPDO: inhibit time",   u16, Access::read_write, 0,          stored},
    {0x1800, 0x181D, sub,      5, 5,   "TPDO: event timer",    u16, Access::read_write, 0,          stored},
    {0x1A00, 0x1A1D, sub,      0, 0,   "TPDO mapping",         u8,  Access::read_write, 4,          stored},
    {0x1A00, 0x1A1D, sub,      1, 8,   "TPDO mapping",         u32, Access::read_write, 0,          stored},
    {0x1F80, 0x1F80, variable, 0, 0,   "NMT start-up",         u32, Access::read_write, 0,          stored},
});
// PDO 1 is on.
constexpr std::array first_pdos = std::to_array<ObjectRow>({
    {0x1400, 0x1400, sub, 1, 1, "RPDO: COB-ID", u32, Access::read_write, 0x00000200, stored | adds_node_id},
    {0x1800, 0x1800, sub, 1, 1, "TPDO: COB-ID", u32, Access::read_write, 0x40000180, stored | adds_node_id},
});
// clang-format on

std::shared_ptr<const canopen::DictionaryDescription> dictionary() {
  canopen::DictionaryBuilder builder;
  add_rows(builder, objects);
  add_rows(builder, first_pdos);
  add_default_mappings(builder, pdos);
  add_network_variables(builder, 2 * words);
  return builder.build();
}

constexpr DataSheet sheet{.model = "FX3U-CAN", .points = 8, .flash_writes = 10'000};

// The text of an EMCY is read as the manual's table labels it: the first letter is the fifth byte.
constexpr EmergencyRow emergency(std::uint16_t code, std::uint8_t digit) {
  return {code, 0x81, {digit, '0', '0', 'X', 'F'}};
}

}  // namespace

constinit const ModuleModel fx3u_can_sketch{
    .data_sheet = &sheet,
    .word_prefix = "#",
    .buffer_memory_size = 32768,
    .buffer_memory = buffer_rows,
    .process_data_windows = windows,
    .function_modes = mode_rows,
    .request_port = requests_by_words,
    .request_words = request_words,
    .leds = leds,
    .emergencies = {.cpu_error = emergency(0xFF00, '1'),
                    .cpu_stopped = emergency(0xFF00, '2'),
                    .restart = emergency(0x6200, '4'),
                    .queue_overflow = EmergencyRow{0x8110, 0x11},
                    .error_passive = EmergencyRow{0x8120, 0x11}},
    .settings = {.function_mode = 21,
                 .baud_rate = 24,
                 .node_address = 27,
                 .save_restore = 22,
                 .save = 1U << 0,
                 .restore = 1U << 1},
    .status = StatusWordsLayout{.communication_status = 25,
                                .bits = {.operational = 1U << 0,
                                         .layer2_online = 1U << 0,
                                         .warning_level = 1U << 1,
                                         .nmt_reset_seen = 1U << 6,
                                         .initialization = 1U << 7,
                                         .pre_operational_state = 1U << 8,
                                         .operational_state = 1U << 9,
                                         .lss_active = 1U << 10,
                                         .start_up_failed = 1U << 11,
                                         .time_seen = 1U << 12,
                                         .slave_start_up = 1U << 14,
                                         .nmt_master = 1U << 15},
                                .transmit_errors = 35,
                                .receive_errors = 36,
                                .active_bit_rate = 37},
    .error_status = ErrorStatusLayout{.status = 29,
                                      .invalid_address = 39,
                                      .refused_address = 40,
                                      .errors = error_rows,
                                      .general_error_bit = 0},
    .exchange_control = ExchangeControlLayout{.address = 20,
                                              .process_data = 1U << 0 | 1U << 8,
                                              .emergencies = 1U << 0 | 1U << 12,
                                              .running = 1U << 0 | 1U << 8},
    .emergency_buffer = EmergencyBufferLayout{.first = 750, .stack = 11, .ring = 11},
    .nmt_status = NmtStatusLayout{.error_control = 900, .error_control_nodes_per_word = 2, .state = 601},
    .network_settings = NetworkSettingsLayout{.start_all_delay = 70, .sdo_time_out = 71},
    .time_stamp = TimeStampLayout{.first = 50, .two_digit_year = true},
    .command = CommandLayout{.first = 1000, .commands = commands},
    .layer2 = Layer2Layout{.error_codes = 401,
                           .parameters = 1100,
                           .rtr_flags = 1270,
                           .trigger_flags = 1280,
                           .stop_messages = 1900,
                           .process_data = 100},
    .program_interface = {.exchange = {.kind = ProgramRequest::Kind::bits, .word = 20, .bits = 1U << 0},
                          .online = {.kind = ProgramRequest::Kind::bits, .word = 25, .bits = 1U << 4},
                          .status = 25,
                          .initializing = 1U << 7,
                          .process_data = process_data},
    .object_dictionary = dictionary,
    .node_options = [] { return canopen::NodeOptions{.send_tpdos_on_start = false}; },
    .master_options = [] { return manager::MasterOptions{}; },
    .layer2_deletes_objects = true,
};

}  // namespace canopus::scenario
