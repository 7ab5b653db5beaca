#pragma once
// The registers of the CPU that are the AS-FCOPM's [AS-FCOPM 10.1.2, 10.5.1]. D24979-24999 and D25979-25999 belong to
// the areas, too; the manual does not say what they hold, and they stay registers of the CPU.

#include <array>

#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/program_interface.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module::as_fcopm {

inline constexpr std::array<std::uint16_t, 6> bit_rates{20, 50, 125, 250, 500, 1000};  // kbit/s

inline constexpr BufferAddress response_first = 24000;
inline constexpr BufferAddress input_first = 24032;
inline constexpr BufferAddress request_first = 25000;
inline constexpr BufferAddress output_first = 25032;
inline constexpr std::size_t message_words = 32;
inline constexpr std::size_t process_words = 947;  ///< each way, as master
inline constexpr std::size_t slave_words = 32;     ///< each way, as slave

inline constexpr BufferAddress version_register = 821;
inline constexpr BufferAddress bit_rate_register = 822;
inline constexpr BufferAddress state_register = 825;
inline constexpr BufferAddress abnormal_first = 826;
inline constexpr BufferAddress node_code_first = 830;

/// Modes: bit 0 as master, bit 1 as slave.
inline constexpr Modes as_master = 1;
inline constexpr Modes as_slave = 2;

namespace registers {
constexpr auto rw = WordAccess::read_write;
constexpr auto ro = WordAccess::read;
constexpr auto no = Stored::no;
constexpr Modes both = as_master | as_slave;
// clang-format off
inline constexpr std::array table = std::to_array<BufferRow>({
    // first   last  name                                        acc. def. range      stored modes      section
    {   821,    821, "SR821: version of CANopen DS301",          ro,   0, any_value, no,    both,      "10.5.1"},
    {   822,    822, "SR822: bit rate in kbit/s",                ro,   0, any_value, no,    both,      "10.5.1"},
    {   825,    825, "SR825: state of the AS300",                ro,   0, any_value, no,    both,      "10.5.1"},
    {   826,    829, "SR826-829: abnormal slaves, nodes 1-64",   ro,   0, any_value, no,    as_master, "10.5.1"},
    {   830,    893, "SR830-893: code of node 1-64",             ro,   0, any_value, no,    as_master, "10.5.1"},
    { 24000,  24031, "Response",                                 ro,   0, any_value, no,    as_master, "10.1.2"},
    { 24032,  24063, "RxPDO data from the master",               ro,   0, any_value, no,    as_slave,  "10.1.2"},
    { 24032,  24978, "TxPDO data of the slaves",                 ro,   0, any_value, no,    as_master, "10.1.2"},
    { 25000,  25031, "Request",                                  rw,   0, any_value, no,    as_master, "10.1.2"},
    { 25032,  25063, "TxPDO data to the master",                 rw,   0, any_value, no,    as_slave,  "10.1.2"},
    { 25032,  25978, "RxPDO data of the slaves",                 rw,   0, any_value, no,    as_master, "10.1.2"},
});
inline constexpr std::array ranges = std::to_array<RegisterRange>({
    {RegisterKind::special, 821, 822},
    {RegisterKind::special, 825, 893},
    {RegisterKind::data, 24000, 24978},
    {RegisterKind::data, 25000, 25978},
});
// clang-format on
}  // namespace registers

inline constexpr auto& register_table = registers::table;

}  // namespace canopus::module::as_fcopm
