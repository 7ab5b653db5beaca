#pragma once
// What the words of the RJ71CN91 say of errors [RJ71CN91 5.3, App. 2 G39, G401, CIF, G5001, 1.7].

#include <array>

#include "canopus/module/interface/error_words.hpp"

namespace canopus::module::rj71cn91 {

namespace errors {
// clang-format off
inline constexpr std::array status = std::to_array<ErrorText>({
    { 1, "hardware error"},
    { 3, "CAN bus-off"},
    { 4, "flash ROM error"},
    { 5, "save or restore while online in Layer 2"},
    { 6, "buffer memory setting error"},
    { 8, "send or receive buffer overflow"},
    {10, "NMT error control failure"},
    {14, "CAN error passive"},
    {15, "Layer 2 message slot error"},
});
inline constexpr std::array node_status = std::to_array<ErrorText>({
    {2, "node guarding: a message was missed or invalid"},
    {3, "node guarding: time-out of the slave"},
    {4, "NMT start-up failure"},
    {5, "unexpected NMT state"},
    {6, "node guarding: time-out of the master"},
    {7, "heartbeat time-out"},
});
inline constexpr std::array slot = std::to_array<ErrorText>({
    {0x2000, "receive buffer overflow"},
    {0x2002, "time-out: the frame was not sent"},
});
inline constexpr std::array command = std::to_array<ErrorText>({
    {0x000C, "EMCY was not sent"},
    {0x000F, "error"},
    {0x00F7, "SDO multi write: at least one failed"},
    {0x00F9, "SDO multi read: at least one failed"},
    {0xF00C, "Layer 2: input error"},
});
inline constexpr std::array command_class = std::to_array<ErrorText>({
    {0x0001, "EMCY inhibit time is not over"},
    {0x0002, "NMT state is neither Pre-operational nor Operational"},
    {0x0003, "SDO error"},
    {0x000F, "message slot error"},
    {0x0064, "unknown command"},
    {0x0F0F, "invalid state of the device"},
    {0xB0FF, "bus-off"},
    {0xFFFF, "access while the last command ran"},
});
inline constexpr std::array emergencies = std::to_array<ErrorText>({
    {0x8F00, "guarding or heartbeat error of node"},
});
inline constexpr std::array words = std::to_array<ErrorWords>({
    {ErrorWords::Kind::bits,        29,   29, "Error status", status},
    {ErrorWords::Kind::address,     39,   39, "first value out of range was written to"},
    {ErrorWords::Kind::node_bits,  401,  527, "node", node_status, {}, ErrorWords::When::canopen},
    {ErrorWords::Kind::command,   1000, 1000, "last command", command, command_class},
    {ErrorWords::Kind::codes,     5001, 5042, "message slot", slot, {}, ErrorWords::When::layer2},
});
// clang-format on
}  // namespace errors

inline constexpr ErrorTables error_tables{
    .prefix = "G", .words = errors::words, .emergencies = errors::emergencies};

}  // namespace canopus::module::rj71cn91
