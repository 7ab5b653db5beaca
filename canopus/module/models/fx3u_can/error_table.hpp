#pragma once
// What the words of the FX3U-CAN say of errors [FX3U-CAN 14.2, 6.17, 6.18, 6.23, 6.24, 7.2, 9.2, 10.9.1].

#include <array>

#include "canopus/module/interface/error_words.hpp"

namespace canopus::module::fx3u_can {

namespace errors {
// clang-format off
inline constexpr std::array status = std::to_array<ErrorText>({
    { 1, "hardware error"},
    { 2, "internal power supply error"},
    { 3, "CAN bus-off"},
    { 4, "flash memory error"},
    { 5, "write while initialising"},
    { 6, "buffer memory setting error"},
    { 7, "FROM/TO watchdog expired"},
    { 8, "internal data queue overflow"},
    {10, "NMT error control failure"},
    {11, "baud rate change error"},
    {12, "node address change error"},
    {13, "emergency received from a slave"},
    {14, "CAN error passive"},
    {15, "Layer 2 message error"},
});
inline constexpr std::array node_status = std::to_array<ErrorText>({
    {2, "node guarding: one message missed, or toggle bit error"},
    {3, "node guarding: no response, the life time has passed"},
    {4, "NMT start-up failed"},
    {5, "node guarding: unexpected state"},
    {6, "guarding failed: the master does not ask any more"},
    {7, "heartbeat missing"},
});
inline constexpr std::array slot = std::to_array<ErrorText>({{0x2000, "receive buffer overflow"}});
inline constexpr std::array command = std::to_array<ErrorText>({
    {0x000C, "EMCY communication error"},
    {0x000F, "error"},
    {0x00F7, "multi write: at least one access failed"},
    {0x00F9, "multi read: at least one access failed"},
    {0x600F, "store parameter error"},
    {0x601F, "restore parameter error"},
    {0x740F, "heartbeat consuming parameter error"},
    {0x741F, "heartbeat producing parameter error"},
    {0x82FF, "Mode A: the local node number is not 1 to 8"},
    {0x83FF, "Mode B parameter error"},
    {0x84FF, "node guarding parameter error"},
    {0xF00C, "Layer 2 send: setting error"},
});
inline constexpr std::array command_class = std::to_array<ErrorText>({
    {0x0001, "EMCY inhibit time runs"},
    {0x0002, "neither Operational nor Pre-operational"},
    {0x0003, "SDO error"},
    {0x0064, "unknown command"},
    {0x0F0F, "the device is in the wrong state"},
    {0x8FFF, "the transmission queue is not available"},
    {0xB0FF, "bus-off"},
    {0xFFFF, "a command or parameter was changed while the last one ran"},
});
inline constexpr std::array emergencies = std::to_array<ErrorText>({
    {0x0010, "CiA 417: CAN warning level"},
    {0x3111, "CiA 417: mains over-voltage"},
    {0x3121, "CiA 417: mains under-voltage"},
    {0x3211, "CiA 417: over-voltage inside the device"},
    {0x3221, "CiA 417: under-voltage inside the device"},
    {0x8F00, "guarding or heartbeat error of node"},
    {0xFF01, "CiA 417: light barrier defect"},
    {0xFF02, "CiA 417: finger protector defect"},
    {0xFF03, "CiA 417: motion detection defect"},
    {0xFF04, "CiA 417: application error"},
});
inline constexpr std::array words = std::to_array<ErrorWords>({
    {ErrorWords::Kind::bits,         29,   29, "Error status", status},
    {ErrorWords::Kind::address,      39,   39, "first value out of range was written to"},
    {ErrorWords::Kind::address,      40,   40, "first refused write was to"},
    {ErrorWords::Kind::node_pairs,  900,  963, "node", node_status, {}, ErrorWords::When::canopen},
    {ErrorWords::Kind::codes,       401,  442, "message", slot, {}, ErrorWords::When::layer2},
    {ErrorWords::Kind::command,    1000, 1000, "last command", command, command_class},
});
// clang-format on
}  // namespace errors

inline constexpr ErrorTables error_tables{
    .prefix = "BFM #", .words = errors::words, .emergencies = errors::emergencies};

}  // namespace canopus::module::fx3u_can
