#pragma once
// What the registers of the AS-FCOPM say of errors [AS-FCOPM 10.5.1].

#include <array>

#include "canopus/module/interface/error_words.hpp"

namespace canopus::module::as_fcopm {

namespace errors {
// clang-format off
inline constexpr std::array own = std::to_array<ErrorText>({
    {0xA0, "initializing"},
    {0xA1, "Pre-operational"},
    {0xA3, "downloading"},
    {0xB0, "heartbeat message time-out"},
    {0xB1, "PDO data length inconsistent"},
    {0xF1, "a slave is not in the node list"},
    {0xF2, "downloading"},
    {0xF3, "error of the PLC"},
    {0xF4, "bus off"},
    {0xF5, "setting error: node address 1 to 127"},
    {0xF8, "internal memory error"},
    {0xFB, "send buffer full"},
    {0xFC, "receive buffer full"},
});
inline constexpr std::array node = std::to_array<ErrorText>({
    {0xE0, "emergency from the slave"},
    {0xE1, "PDO length not consistent"},
    {0xE2, "PDO of the slave not received"},
    {0xE3, "auto SDO failed"},
    {0xE4, "PDO parameter configuration failed"},
    {0xE5, "key parameter error: another device than configured"},
    {0xE6, "the slave is not in the network"},
    {0xE7, "error control (heartbeat) timed out"},
    {0xE8, "master and slave have the same node-ID"},
});
inline constexpr std::array words = std::to_array<ErrorWords>({
    {ErrorWords::Kind::codes, 825, 825, "", own},
    {ErrorWords::Kind::codes, 830, 893, "node", node},
});
// clang-format on
}  // namespace errors

inline constexpr ErrorTables error_tables{.prefix = "SR", .words = errors::words};

}  // namespace canopus::module::as_fcopm
