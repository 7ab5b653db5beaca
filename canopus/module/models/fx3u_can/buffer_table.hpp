#pragma once
// The FX3U-CAN's buffer memory [FX3U-CAN 6.1, 8.1, 9]. One number is two words where FROM and TO mean different ones.

#include <array>

#include "canopus/module/interface/program_interface.hpp"
#include "canopus/module/memory/buffer_memory.hpp"
#include "canopus/module/q_iqr/words.hpp"

namespace canopus::module::fx3u_can {

// Function modes (BFM #21).
inline constexpr Modes mode_405 = 1;
inline constexpr Modes layer2_11 = 2;
inline constexpr Modes layer2_29 = 4;
inline constexpr Modes mode_417 = 8;
inline constexpr Modes canopen_modes = mode_405 | mode_417;
inline constexpr Modes layer2 = layer2_11 | layer2_29;
inline constexpr Modes all_modes = canopen_modes | layer2;
inline constexpr std::array<std::uint16_t, 4> function_modes{405, 11, 29, 417};
inline constexpr ValueRange no_value = between(1, 0);  // every write is an error
using q_iqr::baud_rates;

// 240 bytes, 120 words or 160 double words of the network variables are one index [FX3U-CAN 5.9].
inline constexpr DataExchangeLayout exchange_layout{
    .receive_first = 10000, .transmit_first = 11000, .words = 320, .pdos = 80, .variables = {240, 120, 160}};

namespace buffer_words {
constexpr auto rw = WordAccess::read_write;
constexpr auto ro = WordAccess::read;
constexpr auto wo = WordAccess::write;
constexpr auto yes = Stored::yes;
constexpr auto no = Stored::no;
// clang-format off
inline constexpr std::array table = std::to_array<BufferRow>({
    // first   last  name                                access default range                   stored modes      section  stride offline, bits
    {     0,     19, "RPDO data",                        ro,        0, any_value,               no,  mode_405,  "6.1"},
    {     0,     19, "TPDO data",                        wo,        0, any_value,               no,  mode_405,  "6.1"},
    {     0,      3, "RPDO1 data",                       ro,        0, any_value,               no,  mode_417,  "6.3"},
    {     0,      3, "TPDO1 data",                       wo,        0, any_value,               no,  mode_417,  "6.3"},
    {    20,     20, "Data exchange control",            rw,        0, any_value,               no,  all_modes, "6.4"},
    {    21,     21, "Function mode",                    rw,      405, one_of(function_modes),  yes, all_modes, "6.5",   1, true},
    {    22,     22, "Save/restore configuration",       rw,        0, any_value,               no,  all_modes, "6.6",   1, true,  0x0003},
    {    24,     24, "Baud rate",                        rw,      250, one_of(baud_rates),      yes, all_modes, "6.7",   1, true},
    {    25,     25, "Communication status",             rw,   0x0080, any_value,               no,  all_modes, "6.8"},
    {    26,     26, "FROM/TO watchdog",                 rw,       20, between(0, 6553),        yes, all_modes, "6.9"},
    {    27,     27, "Node address",                     rw,      127, between(1, 127),         yes, canopen_modes, "6.10"},
    {    27,     27, "Node address",                     rw,      127, no_value,                no,  layer2,    "6.10"},
    {    29,     29, "Error status",                     rw,        0, any_value,               no,  all_modes, "6.11"},
    {    30,     30, "Module ID code",                   ro,     7170, any_value,               no,  all_modes, "6.12"},
    {    35,     35, "CAN transmission error counter",   ro,        0, any_value,               no,  all_modes, "6.13"},
    {    36,     36, "CAN reception error counter",      ro,        0, any_value,               no,  all_modes, "6.14"},
    {    37,     37, "Baud rate display",                ro,     2500, any_value,               no,  all_modes, "6.15"},
    {    38,     38, "Sampling point display",           ro,      875, any_value,               no,  all_modes, "6.16"},
    {    39,     39, "BFM setting error display",        ro,        0, any_value,               no,  all_modes, "6.17"},
    {    40,     40, "Write error display",              ro,        0, any_value,               no,  all_modes, "6.18"},
    {    50,     50, "Time stamp: producer/consumer",    rw,        1, between(0, 3),           no,  canopen_modes, "6.19"},
    {    51,     51, "Time stamp: year",                 rw,       12, any_value,               no,  canopen_modes, "6.19"},
    {    52,     52, "Time stamp: month",                rw,        3, any_value,               no,  canopen_modes, "6.19"},
    {    53,     53, "Time stamp: day",                  rw,        1, any_value,               no,  canopen_modes, "6.19"},
    {    54,     56, "Time stamp: hour, minute, second", rw,        0, any_value,               no,  canopen_modes, "6.19"},
    {    57,     57, "Time stamp: day of week",          ro,        4, any_value,               no,  canopen_modes, "6.19"},
    {    58,     58, "Time stamp: interval",             rw,        0, between(0, 1440),        no,  canopen_modes, "6.19"},
    {    59,     59, "Daily correction",                 rw,        0, between(-60, 60),        yes, canopen_modes, "6.19"},
    {    70,     70, "NMT start all nodes delay",        rw,      500, any_value,               yes, canopen_modes, "6.20"},
    {    71,     71, "SDO time-out",                     rw,      500, between(50, 32767),      yes, canopen_modes, "6.21"},
    {   100,    399, "RPDO data",                        ro,        0, any_value,               no,  mode_405,  "6.1"},
    {   100,    399, "TPDO data",                        wo,        0, any_value,               no,  mode_405,  "6.1"},
    {   100,    387, "Message: CAN-ID low",              rw,   0xFFFF, any_value,               yes, layer2,    "9.1",   7, true},
    {   101,    388, "Message: CAN-ID high",             rw,   0xFFFF, any_value,               yes, layer2,    "9.1",   7, true},
    {   102,    389, "Message: RTR, new data, DLC",      rw,        0, any_value,               yes, layer2,    "9.1",   7},
    {   103,    390, "Message: bytes 1, 2",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   104,    391, "Message: bytes 3, 4",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   105,    392, "Message: bytes 5, 6",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   106,    393, "Message: bytes 7, 8",              rw,        0, any_value,               no,  layer2,    "9.1",   7},
    {   401,    442, "Message: error code",              rw,        0, between(0, 0),           no,  layer2,    "9.2"},
    {   601,    727, "NMT state",                        ro,        0, any_value,               no,  canopen_modes, "6.22"},
    {   750,    750, "EMCY buffer, clear",               rw,        0, any_value,               no,  canopen_modes, "6.23"},
    {   751,    859, "EMCY buffer",                      ro,        0, any_value,               no,  canopen_modes, "6.23"},
    {   900,    963, "NMT error control status",         rw,        0, any_value,               no,  canopen_modes, "6.24"},
    {  1000,   1066, "Command interface",                rw,        0, any_value,               no,  all_modes, "10.1"},
    {  1100,   1264, "Message configuration: A",         rw,   0xFFFF, any_value,               yes, layer2,    "9.3",   4, true},
    {  1101,   1265, "Message configuration: B",         rw,   0xFFFF, any_value,               yes, layer2,    "9.3",   4, true},
    {  1102,   1266, "Message configuration: C",         rw,        0, any_value,               yes, layer2,    "9.3",   4, true},
    {  1103,   1267, "Message configuration: D",         rw,        0, any_value,               yes, layer2,    "9.3",   4, true},
    {  1270,   1272, "RTR flags",                        ro,        0, any_value,               no,  layer2,    "9.4"},
    {  1280,   1281, "Message transmit trigger flags",   rw,        0, any_value,               no,  layer2,    "9.5"},
    {  1282,   1282, "Message transmit trigger flags",   rw,        0, any_value,               no,  layer2,    "9.5",   1, false, 0x03FF},
    {  1900,   1921, "RUN>STOP message: CAN-ID low",     rw,   0xFFFF, any_value,               yes, layer2,    "9.6",   7, true},
    {  1901,   1922, "RUN>STOP message: CAN-ID high",    rw,   0xFFFF, any_value,               yes, layer2,    "9.6",   7, true},
    {  1902,   1923, "RUN>STOP message: DLC",            rw,        0, between(0, 8),           yes, layer2,    "9.6",   7, true},
    {  1903,   1924, "RUN>STOP message: bytes 1, 2",     rw,        0, any_value,               yes, layer2,    "9.6",   7, true},
    {  1904,   1925, "RUN>STOP message: bytes 3, 4",     rw,        0, any_value,               yes, layer2,    "9.6",   7, true},
    {  1905,   1926, "RUN>STOP message: bytes 5, 6",     rw,        0, any_value,               yes, layer2,    "9.6",   7, true},
    {  1906,   1927, "RUN>STOP message: bytes 7, 8",     rw,        0, any_value,               yes, layer2,    "9.6",   7, true},
    {  3000,   3000, "Lift number",                      rw,        1, between(0, 255),         no,  mode_417,  "8.2"},
    {  3001,   3003, "Virtual input mapping",            ro,        0, any_value,               no,  mode_417,  "8.3.1"},
    {  3004,   3004, "Virtual inputs that wait",         ro,        0, any_value,               no,  mode_417,  "8.3.1"},
    {  3050,   3081, "Door status word",                 ro,   0xFFFF, any_value,               no,  mode_417,  "8.4.2"},
    {  3082,   3113, "Door position",                    ro,   0xFFFF, any_value,               no,  mode_417,  "8.5"},
    {  3114,   3145, "Light barrier status",             ro,   0x00FF, any_value,               no,  mode_417,  "8.6"},
    {  3300,   3363, "Position value",                   ro,   0xFFFF, any_value,               no,  mode_417,  "8.7"},
    {  3364,   3395, "Speed value car",                  ro,        0, any_value,               no,  mode_417,  "8.8"},
    {  3396,   3427, "Acceleration value car",           ro,        0, any_value,               no,  mode_417,  "8.9"},
    {  3428,   3435, "Status word",                      ro,        0, any_value,               no,  mode_417,  "8.10.2"},
    {  3436,   3443, "Modes of operation display",       ro,        0, any_value,               no,  mode_417,  "8.11.2"},
    {  3444,   3459, "Control effort",                   ro,        0, any_value,               no,  mode_417,  "8.12"},
    {  3460,   3475, "Position actual value",            ro,   0xFFFF, any_value,               no,  mode_417,  "8.13.1"},
    {  3492,   3507, "Velocity actual value",            ro,        0, any_value,               no,  mode_417,  "8.15.2"},
    {  3508,   3522, "Load value: absolute load",        ro,   0xFFFF, any_value,               no,  mode_417,  "8.16",   2},
    {  3509,   3523, "Load value: SI unit",              ro,        2, any_value,               no,  mode_417,  "8.16",   2},
    {  3524,   3538, "Load signal",                      ro,        0, any_value,               no,  mode_417,  "8.17",   2},
    {  3525,   3539, "Load signal interrupt",            ro,        0, any_value,               no,  mode_417,  "8.17",   2},
    {  3001,   3003, "Virtual output mapping",           wo,        0, any_value,               no,  mode_417,  "8.3.2"},
    {  3050,   3081, "Door control word",                wo,   0xFFFF, any_value,               no,  mode_417,  "8.4.1"},
    {  3428,   3435, "Control word",                     wo,        0, any_value,               no,  mode_417,  "8.10.1"},
    {  3436,   3443, "Modes of operation",               wo,        0, any_value,               no,  mode_417,  "8.11.1"},
    {  3460,   3475, "Target position",                  wo,        0, any_value,               no,  mode_417,  "8.13.2"},
    {  3476,   3491, "Profile velocity",                 wo,        0, any_value,               no,  mode_417,  "8.14"},
    {  3492,   3507, "Target velocity",                  wo,        0, any_value,               no,  mode_417,  "8.15.1"},
    { 10000,  10319, "RPDO data",                        ro,        0, any_value,               no,  mode_405,  "6.1"},
    { 11000,  11319, "TPDO data",                        rw,        0, any_value,               no,  mode_405,  "6.1"},
    { 10000,  10003, "RPDO1 data",                       ro,        0, any_value,               no,  mode_417,  "6.3"},
    { 11000,  11003, "TPDO1 data",                       rw,        0, any_value,               no,  mode_417,  "6.3"},
    { 12001,  12003, "Virtual input mapping",            ro,        0, any_value,               no,  mode_417,  "8.3.1"},
    { 12004,  12004, "Virtual inputs that wait",         ro,        0, any_value,               no,  mode_417,  "8.3.1"},
    { 12050,  12081, "Door status word",                 ro,   0xFFFF, any_value,               no,  mode_417,  "8.4.2"},
    { 12082,  12113, "Door position",                    ro,   0xFFFF, any_value,               no,  mode_417,  "8.5"},
    { 12114,  12145, "Light barrier status",             ro,   0x00FF, any_value,               no,  mode_417,  "8.6"},
    { 12300,  12363, "Position value",                   ro,   0xFFFF, any_value,               no,  mode_417,  "8.7"},
    { 12364,  12395, "Speed value car",                  ro,        0, any_value,               no,  mode_417,  "8.8"},
    { 12396,  12427, "Acceleration value car",           ro,        0, any_value,               no,  mode_417,  "8.9"},
    { 12428,  12435, "Status word",                      ro,        0, any_value,               no,  mode_417,  "8.10.2"},
    { 12436,  12443, "Modes of operation display",       ro,        0, any_value,               no,  mode_417,  "8.11.2"},
    { 12444,  12459, "Control effort",                   ro,        0, any_value,               no,  mode_417,  "8.12"},
    { 12460,  12475, "Position actual value",            ro,   0xFFFF, any_value,               no,  mode_417,  "8.13.1"},
    { 12492,  12507, "Velocity actual value",            ro,        0, any_value,               no,  mode_417,  "8.15.2"},
    { 12508,  12522, "Load value: absolute load",        ro,   0xFFFF, any_value,               no,  mode_417,  "8.16",   2},
    { 12509,  12523, "Load value: SI unit",              ro,        2, any_value,               no,  mode_417,  "8.16",   2},
    { 12524,  12538, "Load signal",                      ro,        0, any_value,               no,  mode_417,  "8.17",   2},
    { 12525,  12539, "Load signal interrupt",            ro,        0, any_value,               no,  mode_417,  "8.17",   2},
    { 13000,  13000, "Lift number",                      rw,        1, between(0, 255),         no,  mode_417,  "8.2"},
    { 13001,  13003, "Virtual output mapping",           rw,        0, any_value,               no,  mode_417,  "8.3.2"},
    { 13050,  13081, "Door control word",                rw,   0xFFFF, any_value,               no,  mode_417,  "8.4.1"},
    { 13428,  13435, "Control word",                     rw,        0, any_value,               no,  mode_417,  "8.10.1"},
    { 13436,  13443, "Modes of operation",               rw,        0, any_value,               no,  mode_417,  "8.11.1"},
    { 13460,  13475, "Target position",                  rw,        0, any_value,               no,  mode_417,  "8.13.2"},
    { 13476,  13491, "Profile velocity",                 rw,        0, any_value,               no,  mode_417,  "8.14"},
    { 13492,  13507, "Target velocity",                  rw,        0, any_value,               no,  mode_417,  "8.15.1"},
});
// clang-format on
}  // namespace buffer_words

inline constexpr auto& buffer_table = buffer_words::table;

}  // namespace canopus::module::fx3u_can
