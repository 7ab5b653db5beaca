#pragma once
// Memory map of the ME3CAN1-Q [ME3CAN1-Q Tab. 3-6 and the sections named], as rows that read like the
// manual's. Addresses that no row covers are system area. Misprints of the manual are read as
// docs/modules/me3can1-q.md says.

#include <array>

#include "canopus/module/q_iqr/words.hpp"

namespace canopus::module::me3can1_q {

using namespace q_iqr;

inline constexpr BufferAddress refused_write = 40;
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

// clang-format on

}  // namespace canopus::module::me3can1_q
