#pragma once
// Memory map of the ME3CAN1-Q [ME3CAN1-Q Tab. 3-6 and the sections named], as rows that read like the
// manual's. Addresses that no row covers are system area. Misprints of the manual are read as
// docs/modules/me3can1-q.md says.

#include <array>

#include "canopus/module/buffer_memory.hpp"
#include "canopus/module/command_interface.hpp"
#include "canopus/module/data_exchange.hpp"
#include "canopus/module/error_status.hpp"
#include "canopus/module/layer2.hpp"
#include "canopus/module/program_interface.hpp"
#include "canopus/module/time_stamp.hpp"

namespace canopus::module::me3can1_q {

// Function modes (G21).
inline constexpr Modes canopen_405 = 1;
inline constexpr Modes layer2_11 = 2;
inline constexpr Modes layer2_29 = 4;
inline constexpr Modes layer2 = layer2_11 | layer2_29;
inline constexpr Modes all_modes = canopen_405 | layer2;

// Addresses the firmware speaks of.
namespace g {
inline constexpr BufferAddress data_exchange_control = 20;
inline constexpr BufferAddress function_mode = 21;
inline constexpr BufferAddress save_restore = 22;
inline constexpr BufferAddress baud_rate = 24;
inline constexpr BufferAddress communication_status = 25;
inline constexpr BufferAddress node_address = 27;
inline constexpr BufferAddress error_status = 29;
inline constexpr BufferAddress transmit_errors = 35;
inline constexpr BufferAddress receive_errors = 36;
inline constexpr BufferAddress active_baud_rate = 37;
inline constexpr BufferAddress sampling_point = 38;
inline constexpr BufferAddress setting_error = 39;
inline constexpr BufferAddress refused_write = 40;
inline constexpr BufferAddress time_stamp = 50;
inline constexpr BufferAddress daily_correction = 59;
inline constexpr BufferAddress start_all_delay = 70;
inline constexpr BufferAddress sdo_time_out = 71;
inline constexpr BufferAddress error_clear_node = 400;  ///< error control status of node n is 400 + n
inline constexpr BufferAddress nmt_state = 600;         ///< state of node n is 600 + n
inline constexpr BufferAddress emergencies = 750;
inline constexpr BufferAddress command = 1000;
inline constexpr BufferAddress slot_errors = 5001;
inline constexpr BufferAddress slot_parameters = 6000;
inline constexpr BufferAddress rtr_flags = 8350;
inline constexpr BufferAddress trigger_flags = 8400;
inline constexpr BufferAddress stop_messages = 8450;
inline constexpr BufferAddress slot_data = 10000;  ///< in the Layer 2 modes
inline constexpr BufferAddress receive_data = 10000;
inline constexpr BufferAddress transmit_data = 13000;
}  // namespace g

inline constexpr std::array<std::uint16_t, 3> function_modes{405, 11, 29};
inline constexpr std::array<std::uint16_t, 9> baud_rates{10, 20, 50, 100, 125, 250, 500, 800, 1000};
inline constexpr ValueRange no_value = between(1, 0);  // every write is an error

// clang-format off
inline constexpr std::array buffer_table = std::to_array<BufferRow>({
    //  first   last  name                                 access                  default  range                    stored       modes        section  stride offline only, bits
    {    20,     20, "Data exchange control",             WordAccess::read_write,       0, any_value,               Stored::no,  all_modes,   "3.5.1"},
    {    21,     21, "Function mode",                     WordAccess::read_write,     405, one_of(function_modes),  Stored::yes, all_modes,   "3.5.2"},
    {    22,     22, "Save/Restore configuration",        WordAccess::read_write,       0, any_value,               Stored::no,  all_modes,   "3.5.3",   1, false, 0x0003},
    {    24,     24, "Baud rate",                         WordAccess::read_write,     250, one_of(baud_rates),      Stored::yes, all_modes,   "3.5.4"},
    {    25,     25, "Communication status",              WordAccess::read_write,  0x0080, any_value,               Stored::no,  all_modes,   "3.5.5"},
    {    27,     27, "Node address",                      WordAccess::read_write,     127, between(1, 127),         Stored::yes, canopen_405, "3.5.6"},
    {    27,     27, "Node address",                      WordAccess::read_write,     127, no_value,                Stored::no,  layer2,      "3.5.6"},
    {    29,     29, "Error status",                      WordAccess::read_write,       0, any_value,               Stored::no,  all_modes,   "3.5.7"},
    {    35,     35, "CAN transmission error counter",    WordAccess::read,             0, any_value,               Stored::no,  all_modes,   "3.5.8"},
    {    36,     36, "CAN reception error counter",       WordAccess::read,             0, any_value,               Stored::no,  all_modes,   "3.5.9"},
    {    37,     37, "Baud rate display",                 WordAccess::read,          2500, any_value,               Stored::no,  all_modes,   "3.4.1"},
    {    38,     38, "Sampling point display",            WordAccess::read,           875, any_value,               Stored::no,  all_modes,   "3.4.1"},
    {    39,     39, "Buffer memory setting error",       WordAccess::read,             0, any_value,               Stored::no,  all_modes,   "3.5.10"},
    {    40,     40, "Write error while initializing",    WordAccess::read,             0, any_value,               Stored::no,  all_modes,   "3.5.10"},
    {    50,     50, "Time stamp: producer/consumer",     WordAccess::read_write,       1, between(0, 3),           Stored::no,  canopen_405, "3.5.11"},
    {    51,     51, "Time stamp: year",                  WordAccess::read_write,      14, any_value,               Stored::no,  canopen_405, "3.5.11"},
    {    52,     52, "Time stamp: month",                 WordAccess::read_write,       8, any_value,               Stored::no,  canopen_405, "3.5.11"},
    {    53,     53, "Time stamp: day",                   WordAccess::read_write,       1, any_value,               Stored::no,  canopen_405, "3.5.11"},
    {    54,     56, "Time stamp: hour, minute, second",  WordAccess::read_write,       0, any_value,               Stored::no,  canopen_405, "3.5.11"},
    {    57,     57, "Time stamp: day of week",           WordAccess::read,             5, any_value,               Stored::no,  canopen_405, "3.5.11"},
    {    58,     58, "Time stamp: interval",              WordAccess::read_write,       0, any_value,               Stored::no,  canopen_405, "3.5.11"},
    {    59,     59, "Daily correction",                  WordAccess::read_write,       0, between(-60, 60),        Stored::yes, canopen_405, "3.5.11"},
    {    70,     70, "NMT start all nodes delay",         WordAccess::read_write,     500, any_value,               Stored::yes, canopen_405, "3.5.12"},
    {    71,     71, "SDO time-out",                      WordAccess::read_write,     500, between(50, 32767),      Stored::yes, canopen_405, "3.5.13"},
    {   400,    400, "NMT error clear node",              WordAccess::read_write,       0, between(0, 127),         Stored::no,  canopen_405, "3.5.14"},
    {   401,    527, "NMT error control status",          WordAccess::read_write,       0, any_value,               Stored::no,  canopen_405, "3.5.15"},
    {   601,    727, "NMT state",                         WordAccess::read,             0, any_value,               Stored::no,  canopen_405, "3.5.16"},
    {   750,    750, "EMCY message buffer, clear",        WordAccess::read_write,       0, any_value,               Stored::no,  canopen_405, "3.5.17"},
    {   751,    859, "EMCY message buffer",               WordAccess::read,             0, any_value,               Stored::no,  canopen_405, "3.5.17"},
    {  1000,   1066, "Command interface",                 WordAccess::read_write,       0, any_value,               Stored::no,  all_modes,   "3.5.18"},
    {  5001,   5042, "Message slot error code",           WordAccess::read_write,       0, between(0, 0),           Stored::no,  layer2,      "3.6.1"},
    {  6000,   6164, "Layer 2 message: parameter A",      WordAccess::read_write,  0xFFFF, any_value,               Stored::yes, layer2,      "3.6.2",   4, true},
    {  6001,   6165, "Layer 2 message: parameter B",      WordAccess::read_write,  0xFFFF, any_value,               Stored::yes, layer2,      "3.6.2",   4, true},
    {  6002,   6166, "Layer 2 message: parameter C",      WordAccess::read_write,       0, any_value,               Stored::yes, layer2,      "3.6.2",   4, true},
    {  6003,   6167, "Layer 2 message: parameter D",      WordAccess::read_write,       0, any_value,               Stored::yes, layer2,      "3.6.2",   4, true},
    {  8350,   8352, "Layer 2 RTR flags",                 WordAccess::read,             0, any_value,               Stored::no,  layer2,      "3.6.3"},
    {  8400,   8401, "Message transmit trigger flags",    WordAccess::read_write,       0, any_value,               Stored::no,  layer2,      "3.6.4"},
    {  8402,   8402, "Message transmit trigger flags",    WordAccess::read_write,       0, any_value,               Stored::no,  layer2,      "3.6.4",   1, false, 0x03FF},
    {  8450,   8471, "RUN>STOP message: CAN-ID low",      WordAccess::read_write,  0xFFFF, any_value,               Stored::yes, layer2,      "3.6.5",   7, true},
    {  8451,   8472, "RUN>STOP message: CAN-ID high",     WordAccess::read_write,  0xFFFF, any_value,               Stored::yes, layer2,      "3.6.5",   7, true},
    {  8452,   8473, "RUN>STOP message: DLC",             WordAccess::read_write,       0, between(0, 8),           Stored::yes, layer2,      "3.6.5",   7, true},
    {  8453,   8474, "RUN>STOP message: bytes 1, 2",      WordAccess::read_write,       0, any_value,               Stored::yes, layer2,      "3.6.5",   7, true},
    {  8454,   8475, "RUN>STOP message: bytes 3, 4",      WordAccess::read_write,       0, any_value,               Stored::yes, layer2,      "3.6.5",   7, true},
    {  8455,   8476, "RUN>STOP message: bytes 5, 6",      WordAccess::read_write,       0, any_value,               Stored::yes, layer2,      "3.6.5",   7, true},
    {  8456,   8477, "RUN>STOP message: bytes 7, 8",      WordAccess::read_write,       0, any_value,               Stored::yes, layer2,      "3.6.5",   7, true},
    { 10000,  11023, "RPDO data",                         WordAccess::read,             0, any_value,               Stored::no,  canopen_405, "3.5.19"},
    { 10000,  10287, "Process data: CAN-ID low",          WordAccess::read_write,  0xFFFF, any_value,               Stored::yes, layer2,      "3.6.6",   7, true},
    { 10001,  10288, "Process data: CAN-ID high",         WordAccess::read_write,  0xFFFF, any_value,               Stored::yes, layer2,      "3.6.6",   7, true},
    { 10002,  10289, "Process data: RTR, new data, DLC",  WordAccess::read_write,       0, any_value,               Stored::no,  layer2,      "3.6.6",   7},
    { 10003,  10290, "Process data: bytes 1, 2",          WordAccess::read_write,       0, any_value,               Stored::no,  layer2,      "3.6.6",   7},
    { 10004,  10291, "Process data: bytes 3, 4",          WordAccess::read_write,       0, any_value,               Stored::no,  layer2,      "3.6.6",   7},
    { 10005,  10292, "Process data: bytes 5, 6",          WordAccess::read_write,       0, any_value,               Stored::no,  layer2,      "3.6.6",   7},
    { 10006,  10293, "Process data: bytes 7, 8",          WordAccess::read_write,       0, any_value,               Stored::no,  layer2,      "3.6.6",   7},
    { 13000,  14023, "TPDO data",                         WordAccess::read_write,       0, any_value,               Stored::no,  canopen_405, "3.5.19"},
});

/// Commands of the command interface [ME3CAN1-Q 4.4, 5].
inline constexpr std::array command_table = std::to_array<CommandRow>({
    // code   what it does                modes        success  partly failed
    {0x0000, CommandKind::display,       all_modes,   0x0000,  0x0000},
    {0x0002, CommandKind::sdo_write,     canopen_405, 0x0003,  0x000F},
    {0x0004, CommandKind::sdo_read,      canopen_405, 0x0005,  0x000F},
    {0x0006, CommandKind::multi_write,   canopen_405, 0x0007,  0x00F7},
    {0x0008, CommandKind::multi_read,    canopen_405, 0x0009,  0x00F9},
    {0x000A, CommandKind::emergency,     canopen_405, 0x000B,  0x000C},
    {0x000C, CommandKind::send_frame,    layer2,      0x000D,  0xF00C},
    {0xFFFF, CommandKind::clear,         all_modes,   0x0000,  0x0000},
});

// Bits of G29 [ME3CAN1-Q Tab. 3-11].
namespace error_bit {
inline constexpr unsigned hardware = 1;
inline constexpr unsigned bus_off = 3;
inline constexpr unsigned flash = 4;
inline constexpr unsigned refused_write = 5;
inline constexpr unsigned setting = 6;
inline constexpr unsigned queue_overflow = 8;
inline constexpr unsigned error_passive = 14;
inline constexpr unsigned message_slot = 15;
}  // namespace error_bit

inline constexpr ErrorStatusLayout error_layout{
    .status = g::error_status, .setting_address = g::setting_error, .refused_address = g::refused_write,
    .latched = 1U << error_bit::refused_write | 1U << error_bit::setting | 1U << error_bit::queue_overflow |
               1U << error_bit::message_slot,
    .sum = 1U << error_bit::hardware | 1U << error_bit::bus_off | 1U << error_bit::flash |
           1U << error_bit::refused_write | 1U << error_bit::setting | 1U << error_bit::queue_overflow |
           1U << error_bit::message_slot,
    .setting_bit = error_bit::setting, .refused_bit = error_bit::refused_write,
};
// clang-format on

inline constexpr DataExchangeLayout exchange_layout{
    .receive_first = g::receive_data, .transmit_first = g::transmit_data, .words = 1024, .pdos = 256};

/// Writes that the flash memory tolerates [ME3CAN1-Q 4.6].
inline constexpr std::uint32_t flash_endurance = 10'000;

inline constexpr Layer2Layout layer2_layout{.error_codes = g::slot_errors,
                                            .parameters = g::slot_parameters,
                                            .rtr_flags = g::rtr_flags,
                                            .trigger_flags = g::trigger_flags,
                                            .stop_messages = g::stop_messages,
                                            .process_data = g::slot_data};

inline constexpr TimeStampLayout time_stamp_layout{.first = g::time_stamp, .two_digit_year = true};

// Signals: offsets from the head address [ME3CAN1-Q Tab. 3-3].
namespace signal {
inline constexpr unsigned ready = 0x00;
inline constexpr unsigned data_exchange = 0x01;
inline constexpr unsigned restart = 0x02;
inline constexpr unsigned online = 0x03;
inline constexpr unsigned transmit_trigger = 0x04;
inline constexpr unsigned error = 0x0F;
inline constexpr unsigned nmt_error = 0x10;
inline constexpr unsigned emergency = 0x11;
inline constexpr unsigned time_set = 0x12;
inline constexpr unsigned time_read = 0x13;
inline constexpr unsigned command = 0x17;
inline constexpr unsigned save_restore = 0x1F;
}  // namespace signal

/// What a program works with [ME3CAN1-Q 3.3.2, 3.5.5].
inline constexpr ProgramInterface program_interface{
    .exchange = {.kind = ProgramRequest::Kind::signal, .signal = signal::data_exchange},
    .online = {.kind = ProgramRequest::Kind::signal, .signal = signal::online},
    .ready = signal::ready,
    .status = g::communication_status,
    .initializing = 1U << 7,
    .process_data = exchange_layout,
};

}  // namespace canopus::module::me3can1_q
