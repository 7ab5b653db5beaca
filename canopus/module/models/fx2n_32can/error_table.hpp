#pragma once
// What the words of the FX2N-32CAN say of errors [FX2N-32CAN 4.2.7, 6.3.1, 6.4, 7.2, 7.4.3, 8.1].

#include <array>

#include "canopus/module/interface/error_words.hpp"

namespace canopus::module::fx2n_32can {

namespace errors {
// clang-format off
inline constexpr std::array status = std::to_array<ErrorText>({
    { 2, "power error"},
    { 3, "CAN bus off"},
    { 4, "EEPROM/flash memory error: stored data are damaged"},
    { 7, "FROM/TO watchdog expired"},
    { 8, "data queue overflow"},
    { 9, "command or event queue overflow"},
    {10, "CANopen guarding error"},
    {11, "baud rate change error"},
    {12, "node address change error"},
    {13, "CANopen emergency"},
    {14, "CAN error passive"},
});
inline constexpr std::array command = std::to_array<ErrorText>({
    {0x000F, "error"},
    {0x81FF, "no COB-ID for the requested RPDO"},
    {0x82FF, "node number mismatch"},
    {0x83FF, "mode B binding error"},
    {0x84FF, "guarding parameter error"},
    {0x8FFF, "the queue is not accessible"},
});
inline constexpr std::array command_class = std::to_array<ErrorText>({
    {0x0003, "SDO error"},
    {0x0064, "unknown command"},
    {0x00C8, "internal error"},
    {0x8FFF, "the transmit queue is not available"},
    {0xFFFF, "a command or parameter was changed while the last one ran"},
});
inline constexpr std::array words = std::to_array<ErrorWords>({
    {ErrorWords::Kind::bits,      29,   29, "Error status", status},
    {ErrorWords::Kind::command, 1000, 1000, "last command", command, command_class},
});
// clang-format on
}  // namespace errors

inline constexpr ErrorTables error_tables{.prefix = "BFM #", .words = errors::words};

}  // namespace canopus::module::fx2n_32can
