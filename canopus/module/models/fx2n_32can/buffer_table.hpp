#pragma once
// The FX2N-32CAN's buffer memory [FX2N-32CAN 4.1, 4.3]. One number is two words where FROM and TO mean different ones.

#include <array>

#include "canopus/module/interface/program_interface.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module::fx2n_32can {

inline constexpr std::array<std::uint16_t, 8> baud_rates{10, 20, 50, 125, 250, 500, 800, 1000};

// 30 PDOs of four words each way: #0 to #19, then #100 to #199. All of an area of network variables is one index
// [FX2N-32CAN 5.1, 5.2].
inline constexpr DataExchangeLayout exchange_layout{.receive_first = 0,
                                                    .transmit_first = 0,
                                                    .words = 120,
                                                    .pdos = 30,
                                                    .variables = {240, 120, 60},
                                                    .first_part = 20,
                                                    .rest_first = 100,
                                                    .all_variables = true};

namespace buffer_words {
constexpr auto rw = WordAccess::read_write;
constexpr auto ro = WordAccess::read;
constexpr auto wo = WordAccess::write;
constexpr auto yes = Stored::yes;
constexpr auto no = Stored::no;
constexpr Modes all = every_mode;
// clang-format off
inline constexpr std::array table = std::to_array<BufferRow>({
    // first   last  name                                access default range               stored modes section
    {     0,     19, "RPDO data",                        ro,        0, any_value,           no,  all,  "4.2.1"},
    {     0,     19, "TPDO data",                        wo,        0, any_value,           no,  all,  "4.2.1"},
    {    20,     20, "Data exchange",                    rw,        0, any_value,           no,  all,  "4.2.2"},
    {    24,     24, "Baud rate",                        rw,       10, one_of(baud_rates),  yes, all,  "4.2.3"},
    {    25,     25, "Communication status, restart",    rw,        0, any_value,           no,  all,  "4.2.4"},
    {    26,     26, "FROM/TO watchdog",                 rw,       20, any_value,           yes, all,  "4.2.5"},
    {    27,     27, "Node address in use",              ro,      127, any_value,           no,  all,  "4.2.6"},
    {    27,     27, "Node address",                     wo,      127, between(1, 127),     yes, all,  "4.2.6"},
    {    29,     29, "Error status",                     rw,        0, any_value,           no,  all,  "4.2.7"},
    {    30,     30, "Module code",                      ro,     7100, any_value,           no,  all,  "4.1"},
    {   100,    199, "RPDO data",                        ro,        0, any_value,           no,  all,  "4.3"},
    {   100,    199, "TPDO data",                        wo,        0, any_value,           no,  all,  "4.3"},
    {  1000,   1066, "Command interface",                rw,        0, any_value,           no,  all,  "6"},
});
// clang-format on
}  // namespace buffer_words

inline constexpr auto& buffer_table = buffer_words::table;

}  // namespace canopus::module::fx2n_32can
