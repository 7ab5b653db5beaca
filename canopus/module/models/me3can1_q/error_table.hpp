#pragma once
// What the words of the ME3CAN1-Q say of errors [ME3CAN1-Q Tab. 3-11, 3.5.10, 3.5.15, 3.5.18, 3.6.1, 5.4, 8.2.1].

#include <array>

#include "canopus/module/interface/error_words.hpp"

namespace canopus::module::me3can1_q {

namespace errors {
// clang-format off
inline constexpr std::array status = std::to_array<ErrorText>({
    { 1, "hardware error"},
    { 3, "CAN controller bus-off: too many transmission errors"},
    { 4, "flash memory error: the stored settings are damaged"},
    { 5, "a write while the module initialized, or of a setting while it was online in Layer 2"},
    { 6, "buffer memory setting error: a value out of range was written"},
    { 8, "internal data queue overflow: too much traffic, or the data are exchanged too often"},
    {14, "CAN error passive"},
    {15, "Layer 2 message slot error"},
});
inline constexpr std::array node_status = std::to_array<ErrorText>({
    {2, "node guarding: one message missed, or toggle error"},
    {3, "node guarding: the slave does not answer any more"},
    {4, "NMT start-up failed"},
    {5, "node guarding: unexpected state"},
    {6, "life guarding: the master does not ask any more"},
    {7, "heartbeat missing"},
});
inline constexpr std::array slot = std::to_array<ErrorText>({{0x2000, "receive buffer overflow"}});
inline constexpr std::array command = std::to_array<ErrorText>({
    {0x000C, "EMCY communication error"},
    {0x000F, "error"},
    {0x00F7, "SDO multi write: at least one failed"},
    {0x00F9, "SDO multi read: at least one failed"},
    {0xF00C, "Layer 2 send: setting error"},
});
inline constexpr std::array command_class = std::to_array<ErrorText>({
    {0x0001, "EMCY inhibit time has not passed"},
    {0x0002, "neither Operational nor Pre-operational"},
    {0x0003, "SDO error"},
    {0x0064, "unknown command"},
    {0x0F0F, "the module is in the wrong state"},
    {0xB0FF, "bus-off"},
    {0xFFFF, "a command or parameter was changed while the last one ran"},
});
inline constexpr std::array emergencies = std::to_array<ErrorText>({
    {0x8F00, "guarding or heartbeat error of node"},
});
inline constexpr std::array words = std::to_array<ErrorWords>({
    {ErrorWords::Kind::bits,        29,   29, "Error status", status},
    {ErrorWords::Kind::address,     39,   39, "first value out of range was written to"},
    {ErrorWords::Kind::address,     40,   40, "first refused write was to"},
    {ErrorWords::Kind::node_bits,  401,  527, "node", node_status, {}, ErrorWords::When::canopen},
    {ErrorWords::Kind::command,   1000, 1000, "last command", command, command_class},
    {ErrorWords::Kind::codes,     5001, 5042, "message slot", slot, {}, ErrorWords::When::layer2},
});
// clang-format on
}  // namespace errors

inline constexpr ErrorTables error_tables{
    .prefix = "G", .words = errors::words, .emergencies = errors::emergencies};

}  // namespace canopus::module::me3can1_q
