#include "scenarios/engine/other_models.hpp"

#include "canopus/module/canopen/object_rows.hpp"
#include "canopus/module/engine/signal_port.hpp"

namespace canopus::scenario::other_models {

using namespace module;
using canopen::Access;
using canopen::DataType;

namespace {

constexpr Modes canopen_mode = 4;
constexpr Modes layer2_mode = 1;
constexpr std::array<std::uint16_t, 2> mode_values{9, 7};
constexpr std::array function_modes = std::to_array<FunctionModeRow>({
    {9, canopen_mode, FunctionModeRow::Kind::canopen},
    {7, layer2_mode, FunctionModeRow::Kind::layer2_extended},
});

constexpr auto rw = WordAccess::read_write;
constexpr auto ro = WordAccess::read;
// clang-format off
constexpr std::array buffer_rows = std::to_array<BufferRow>({
    { 120,  120, "data exchange control", rw,    0},
    { 121,  121, "function mode",         rw,    9, one_of(mode_values), Stored::yes},
    { 122,  122, "save, restore",         rw,    0},
    { 124,  124, "baud rate",             rw,  500, between(1, 1000), Stored::yes},
    { 125,  125, "communication status",  rw,    0},
    { 127,  127, "node address",          rw,    3, between(1, 127), Stored::yes},
    { 129,  129, "error status",          rw,    0},
    { 135,  137, "counters, baud rate",   ro,    0},
    { 139,  140, "setting error, refused",ro,    0},
    { 150,  150, "time: role",            rw,    1, between(0, 3)},
    { 151,  151, "time: year",            rw, 2014},
    { 152,  153, "time: month, day",      rw,    1},
    { 154,  156, "time",                  rw,    0},
    { 157,  157, "time: day of week",     ro,    3},
    { 158,  158, "time: interval",        rw,    0},
    { 159,  159, "time: correction",      rw,    0, between(-60, 60), Stored::yes},
    { 170,  170, "start all delay",       rw,  500},
    { 171,  171, "SDO time-out",          rw,  500, between(50, 32767)},
    { 500,  500, "error clear node",      rw,    0, between(0, 127)},
    { 501,  627, "error control status",  ro,    0},
    { 801,  927, "NMT state",             ro,    0},
    { 950,  969, "emergencies",           rw,    0},
    {1100, 1166, "command",               rw,    0},
    {2000, 2293, "slots",                 rw, 0xFFFF, any_value, Stored::yes, layer2_mode},
    {2300, 2341, "slot errors",           rw,    0,   any_value, Stored::no,  layer2_mode},
    {2400, 2567, "slot parameters",       rw, 0xFFFF, any_value, Stored::yes, layer2_mode},
    {2600, 2605, "RTR, trigger flags",    rw,    0,   any_value, Stored::no,  layer2_mode},
    {2700, 2727, "stop messages",         rw, 0xFFFF, any_value, Stored::yes, layer2_mode},
    {3000, 3007, "received",              ro,    0,   any_value, Stored::no,  canopen_mode},
    {4000, 4007, "to send",               rw,    0,   any_value, Stored::no,  canopen_mode},
});
constexpr std::array signals = std::to_array<SignalRow>({
    {0x1C, RequestUse::ready},
    {0x1B, RequestUse::data_exchange},
    {0x1A, RequestUse::restart},
    {0x19, RequestUse::error},
    {0x18, RequestUse::nmt_error,        canopen_mode},
    {0x17, RequestUse::emergency,        canopen_mode},
    {0x16, RequestUse::set_clock,        canopen_mode},
    {0x15, RequestUse::read_clock,       canopen_mode},
    {0x14, RequestUse::command},
    {0x13, RequestUse::save_restore},
    {0x12, RequestUse::online,           layer2_mode},
    {0x11, RequestUse::transmit_trigger, layer2_mode},
});
constexpr std::array error_rows = std::to_array<ErrorRow>({
    {ModuleError::error_passive,   0, false, false},
    {ModuleError::message_slot,    2, false, false},
    {ModuleError::queue_overflow,  9, true,  true},
    {ModuleError::refused_write,  10, true,  false},
    {ModuleError::invalid_value,  11, true,  true},
    {ModuleError::hardware,       12, false, true},
    {ModuleError::bus_off,        13, false, false},
    {ModuleError::flash,          14, false, false},
});
constexpr std::array commands = std::to_array<CommandRow>({
    {0x4001, CommandKind::sdo_read,  canopen_mode, 0x4002, 0x400F},
    {0x4003, CommandKind::sdo_write, canopen_mode, 0x4004, 0x400F},
});
constexpr std::array leds = std::to_array<LedRow>({
    {"FAULT", LedUse::error},
    {"NET",   LedUse::network_state},
});
constexpr auto u8 = DataType::unsigned8;
constexpr auto u16 = DataType::unsigned16;
constexpr auto u32 = DataType::unsigned32;
using enum ObjectRow::Kind;
using enum ObjectRow::Flag;
constexpr std::array objects = std::to_array<ObjectRow>({
    {0x1000, 0x1000, variable, 0, 0, "Device type",        u32, Access::read_only,  0x195, plain},
    {0x1001, 0x1001, variable, 0, 0, "Error register",     u8,  Access::read_only,  0, plain},
    {0x1010, 0x1010, array,    1, 1, "Store",              u32, Access::read_write, 1, plain},
    {0x1011, 0x1011, array,    1, 1, "Restore",            u32, Access::read_write, 1, plain},
    {0x1012, 0x1012, variable, 0, 0, "COB-ID TIME",        u32, Access::read_write, 0x80000100, stored},
    {0x1014, 0x1014, variable, 0, 0, "COB-ID EMCY",        u32, Access::read_only,  0x80, adds_node_id},
    {0x1017, 0x1017, variable, 0, 0, "Heartbeat",          u16, Access::read_write, 0, stored},
    {0x1018, 0x1018, sub,      1, 3, "Identity",           u32, Access::read_only,  0, plain},
    {0x1028, 0x1028, sub,      1, 127, "Emergency consumer", u32, Access::read_write, 0x80, stored | adds_sub_index},
    {0x1029, 0x1029, array,    1, 1, "Error behaviour",    u8,  Access::read_write, 0, stored},
    {0x1400, 0x1401, sub,      1, 1, "RPDO: COB-ID",       u32, Access::read_write, 0x200, stored | adds_node_id},
    {0x1400, 0x1401, sub,      2, 2, "RPDO: type",         u8,  Access::read_write, 0xFE, stored},
    {0x1600, 0x1601, sub,      0, 0, "RPDO mapping",       u8,  Access::read_write, 1, stored},
    {0x1600, 0x1601, sub,      1, 8, "RPDO mapping",       u32, Access::read_write, 0xA5800210, stored},
    {0x1800, 0x1801, sub,      1, 1, "TPDO: COB-ID",       u32, Access::read_write, 0x40000180, stored | adds_node_id},
    {0x1800, 0x1801, sub,      2, 2, "TPDO: type",         u8,  Access::read_write, 0xFE, stored},
    {0x1800, 0x1801, sub,      3, 3, "TPDO: inhibit time", u16, Access::read_write, 0, stored},
    {0x1800, 0x1801, sub,      5, 5, "TPDO: event timer",  u16, Access::read_write, 0, stored},
    {0x1A00, 0x1A01, sub,      0, 0, "TPDO mapping",       u8,  Access::read_write, 1, stored},
    {0x1A00, 0x1A01, sub,      1, 8, "TPDO mapping",       u32, Access::read_write, 0xA1000210, stored},
    {0x1F80, 0x1F80, variable, 0, 0, "NMT start-up",       u32, Access::read_write, 0, stored},
});
// PDO 2 is off.
constexpr std::array second_pdos = std::to_array<ObjectRow>({
    {0x1401, 0x1401, sub, 1, 1, "RPDO: COB-ID", u32, Access::read_write, 0x80000000, stored},
    {0x1801, 0x1801, sub, 1, 1, "TPDO: COB-ID", u32, Access::read_write, 0xC0000000, stored},
});
// clang-format on

std::shared_ptr<const canopen::DictionaryDescription> dictionary() {
  canopen::DictionaryBuilder builder;
  add_rows(builder, objects);
  add_rows(builder, second_pdos);
  add_network_variables(builder, 16);
  return builder.build();
}

constexpr DataSheet sheet{
    .model = "ELSEWHERE", .series = "X", .points = 32, .word_prefix = "W", .flash_writes = 3};

}  // namespace

constinit const ModuleModel elsewhere{
    .data_sheet = &sheet,
    .buffer_memory_size = 5000,
    .buffer_memory = buffer_rows,
    .function_modes = function_modes,
    .request_port = requests_by_signals,
    .signals = signals,
    .leds = leds,
    .emergencies = {.cpu_error = {0xFF01, 0x80, {'X', '1'}},
                    .cpu_stopped = {0xFF02, 0x82, {'X', '2'}},
                    .restart = {0x6201, 0x04, {'X', '4'}},
                    .queue_overflow = {0x8111, 0x12},
                    .error_passive = {0x8121, 0x13},
                    .node_lost = {0x8E00, 0x14}},
    .settings = {.function_mode = 121,
                 .baud_rate = 124,
                 .node_address = 127,
                 .save_restore = 122,
                 .save = 1U << 0,
                 .restore = 1U << 1},
    // No bit for a seen NMT reset.
    .status = StatusWordsLayout{.communication_status = 125,
                                .bits = {.operational = 1U << 15,
                                         .warning_level = 1U << 14,
                                         .initialization = 1U << 13,
                                         .pre_operational_state = 1U << 12,
                                         .operational_state = 1U << 11,
                                         .lss_active = 1U << 10,
                                         .time_seen = 1U << 9,
                                         .slave_start_up = 1U << 8,
                                         .nmt_master = 1U << 7},
                                .transmit_errors = 135,
                                .receive_errors = 136,
                                .active_bit_rate = 137},
    .error_status =
        ErrorStatusLayout{
            .status = 129, .invalid_address = 139, .refused_address = 140, .errors = error_rows},
    .exchange_control =
        ExchangeControlLayout{
            .address = 120, .process_data = 1U << 1, .emergencies = 1U << 2, .running = 0x0101},
    .emergency_buffer = EmergencyBufferLayout{.first = 950, .stack = 3, .ring = 1},
    .nmt_status = NmtStatusLayout{.error_control = 501, .state = 801, .clear_node = 500},
    .network_settings = NetworkSettingsLayout{.start_all_delay = 170, .sdo_time_out = 171},
    .time_stamp = TimeStampLayout{.first = 150},
    .command = CommandLayout{.first = 1100, .commands = commands},
    .layer2 = Layer2Layout{.error_codes = 2300,
                           .parameters = 2400,
                           .rtr_flags = 2600,
                           .trigger_flags = 2603,
                           .stop_messages = 2700,
                           .process_data = 2000},
    .program_interface =
        {.process_data = {.receive_first = 3000, .transmit_first = 4000, .words = 8, .pdos = 2}},
    .object_dictionary = dictionary,
    .node_options = [] { return canopen::NodeOptions{.send_tpdos_on_start = false}; },
    .master_options = [] { return manager::MasterOptions{}; },
};

}  // namespace canopus::scenario::other_models
