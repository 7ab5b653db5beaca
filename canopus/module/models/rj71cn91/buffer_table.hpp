#pragma once
// Memory map of the RJ71CN91 [RJ71CN91 App. 2], as rows that read like the manual's. Addresses that no row covers are system
// area. Readings are in docs/modules/rj71cn91.md.

#include <array>

#include "canopus/module/q_iqr/words.hpp"

namespace canopus::module::rj71cn91 {

using namespace q_iqr;

// clang-format off
inline constexpr std::array buffer_table = std::to_array<BufferRow>({
    //  first   last  name                                 access                  default  range                    stored       modes        section  stride offline only, bits
    {    20,     20, "Data exchange control",             WordAccess::read_write,      0, any_value,               Stored::no,  all_modes,   "App.2 G20", 1, false, 0x1100},
    {    21,     21, "Function mode",                     WordAccess::read_write,    405, one_of(function_modes),  Stored::yes, all_modes,   "App.2 G21"},
    {    22,     22, "Save/Restore configuration",        WordAccess::read_write,      0, any_value,               Stored::no,  all_modes,   "App.2 G22",   1, false, 0x0003},
    {    24,     24, "Baud rate",                         WordAccess::read_write,    250, one_of(baud_rates),      Stored::yes, canopen_405, "App.2 G24"},
    {    24,     24, "Baud rate",                         WordAccess::read_write,    250, one_of(baud_rates),      Stored::yes, layer2,      "App.2 G24", 1, true},
    {    25,     25, "Communication status",              WordAccess::read_write, 0x0080, any_value,               Stored::no,  all_modes,   "App.2 G25"},
    {    27,     27, "Node ID",                           WordAccess::read_write,    127, between(1, 127),         Stored::yes, canopen_405, "App.2 G27"},
    {    29,     29, "Error status",                      WordAccess::read,            0, any_value,               Stored::no,  all_modes,   "App.2 G29"},
    {    35,     35, "CAN transmission error counter",    WordAccess::read,            0, any_value,               Stored::no,  all_modes,   "App.2 G35"},
    {    36,     36, "CAN reception error counter",       WordAccess::read,            0, any_value,               Stored::no,  all_modes,   "App.2 G36"},
    {    37,     37, "Baud rate display",                 WordAccess::read,         2500, any_value,               Stored::no,  all_modes,   "App.2 G37"},
    {    38,     38, "Sampling point display",            WordAccess::read,          875, any_value,               Stored::no,  all_modes,   "App.2 G38"},
    {    39,     39, "Buffer memory setting error",       WordAccess::read,            0, any_value,               Stored::no,  all_modes,   "App.2 G39"},
    {    50,     50, "Time stamp: producer/consumer",     WordAccess::read_write,      1, between(0, 3),           Stored::no,  canopen_405, "App.2 G50"},
    {    51,     51, "Time stamp: year",                  WordAccess::read_write,   2014, any_value,               Stored::no,  canopen_405, "App.2 G50"},
    {    52,     52, "Time stamp: month",                 WordAccess::read_write,      8, any_value,               Stored::no,  canopen_405, "App.2 G50"},
    {    53,     53, "Time stamp: day",                   WordAccess::read_write,      1, any_value,               Stored::no,  canopen_405, "App.2 G50"},
    {    54,     56, "Time stamp: hour, minute, second",  WordAccess::read_write,      0, any_value,               Stored::no,  canopen_405, "App.2 G50"},
    {    57,     57, "Time stamp: day of week",           WordAccess::read,            5, any_value,               Stored::no,  canopen_405, "App.2 G50"},
    {    58,     58, "Time stamp: interval",              WordAccess::read_write,      0, any_value,               Stored::no,  canopen_405, "App.2 G50"},
    {    59,     59, "Daily correction",                  WordAccess::read_write,      0, between(-60, 60),        Stored::yes, canopen_405, "App.2 G50"},
    {    70,     70, "NMT all nodes start delay",         WordAccess::read_write,    500, any_value,               Stored::yes, canopen_405, "App.2 G70"},
    {    71,     71, "SDO timeout",                       WordAccess::read_write,    500, between(50, 32767),      Stored::yes, canopen_405, "App.2 G71"},
    {   400,    400, "NMT error clear node",              WordAccess::read_write,      0, between(0, 127),         Stored::no,  canopen_405, "App.2 G400"},
    {   401,    527, "NMT error control status",          WordAccess::read,            0, any_value,               Stored::no,  canopen_405, "App.2 G401"},
    {   601,    727, "NMT state",                         WordAccess::read,            0, any_value,               Stored::no,  canopen_405, "App.2 G601"},
    {   750,    750, "EMCY message buffer, clear",        WordAccess::read_write,      0, any_value,               Stored::no,  canopen_405, "App.2 G750"},
    {   751,    859, "EMCY message buffer",               WordAccess::read,            0, any_value,               Stored::no,  canopen_405, "App.2 G750"},
    {  1000,   1066, "Command interface",                 WordAccess::read_write,      0, any_value,               Stored::no,  all_modes,   "App.2 G1000"},
    {  5001,   5042, "Message slot error code",           WordAccess::read_write,      0, between(0, 0),           Stored::no,  layer2,      "App.2 G5001"},
    {  6000,   6164, "Layer 2 message: parameter A",      WordAccess::read_write, 0xFFFF, any_value,               Stored::yes, layer2,      "App.2 G6000",   4, true},
    {  6001,   6165, "Layer 2 message: parameter B",      WordAccess::read_write, 0xFFFF, any_value,               Stored::yes, layer2,      "App.2 G6000",   4, true},
    {  6002,   6166, "Layer 2 message: parameter C",      WordAccess::read_write,      0, any_value,               Stored::yes, layer2,      "App.2 G6000",   4, true},
    {  6003,   6167, "Layer 2 message: parameter D",      WordAccess::read_write,      0, any_value,               Stored::yes, layer2,      "App.2 G6000",   4, true},
    {  8350,   8352, "Layer 2 RTR flags",                 WordAccess::read,            0, any_value,               Stored::no,  layer2,      "App.2 G8350"},
    {  8400,   8401, "Message transmit trigger flags",    WordAccess::read_write,      0, any_value,               Stored::no,  layer2,      "App.2 G8400"},
    {  8402,   8402, "Message transmit trigger flags",    WordAccess::read_write,      0, any_value,               Stored::no,  layer2,      "App.2 G8400",   1, false, 0x03FF},
    {  8450,   8471, "STOP message: CAN-ID low",          WordAccess::read_write, 0xFFFF, any_value,               Stored::yes, layer2,      "App.2 G8450",   7, true},
    {  8451,   8472, "STOP message: CAN-ID high",         WordAccess::read_write, 0xFFFF, any_value,               Stored::yes, layer2,      "App.2 G8450",   7, true},
    {  8452,   8473, "STOP message: DLC",                 WordAccess::read_write,      0, between(0, 8),           Stored::yes, layer2,      "App.2 G8450",   7, true},
    {  8453,   8474, "STOP message: bytes 1, 2",          WordAccess::read_write,      0, any_value,               Stored::yes, layer2,      "App.2 G8450",   7, true},
    {  8454,   8475, "STOP message: bytes 3, 4",          WordAccess::read_write,      0, any_value,               Stored::yes, layer2,      "App.2 G8450",   7, true},
    {  8455,   8476, "STOP message: bytes 5, 6",          WordAccess::read_write,      0, any_value,               Stored::yes, layer2,      "App.2 G8450",   7, true},
    {  8456,   8477, "STOP message: bytes 7, 8",          WordAccess::read_write,      0, any_value,               Stored::yes, layer2,      "App.2 G8450",   7, true},
    { 10000,  11023, "RPDO data",                         WordAccess::read,            0, any_value,               Stored::no,  canopen_405, "App.2 RPDO"},
    { 10000,  10287, "Process data: CAN-ID low",          WordAccess::read_write, 0xFFFF, any_value,               Stored::yes, layer2,      "App.2 G10000",   7, true},
    { 10001,  10288, "Process data: CAN-ID high",         WordAccess::read_write, 0xFFFF, any_value,               Stored::yes, layer2,      "App.2 G10000",   7, true},
    { 10002,  10289, "Process data: RTR, new data, DLC",  WordAccess::read_write,      0, any_value,               Stored::yes, layer2,      "App.2 G10000",   7},
    { 10003,  10290, "Process data: bytes 1, 2",          WordAccess::read_write,      0, any_value,               Stored::no,  layer2,      "App.2 G10000",   7},
    { 10004,  10291, "Process data: bytes 3, 4",          WordAccess::read_write,      0, any_value,               Stored::no,  layer2,      "App.2 G10000",   7},
    { 10005,  10292, "Process data: bytes 5, 6",          WordAccess::read_write,      0, any_value,               Stored::no,  layer2,      "App.2 G10000",   7},
    { 10006,  10293, "Process data: bytes 7, 8",          WordAccess::read_write,      0, any_value,               Stored::no,  layer2,      "App.2 G10000",   7},
    { 13000,  14023, "TPDO data",                         WordAccess::read_write,      0, any_value,               Stored::no,  canopen_405, "App.2 TPDO"},
});
// clang-format on

}  // namespace canopus::module::rj71cn91
