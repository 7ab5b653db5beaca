#pragma once
// Facts of the FX3U-CAN that are physical, or about its place in a system [FX3U-CAN 1.2, 1.3, 2].

#include <array>

#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/reset_procedure.hpp"

namespace canopus::module::fx3u_can {

// clang-format off
inline constexpr std::array mode_facts = std::to_array<FunctionMode>({
    {"405", "CANopen, CiA 405"},
    {"11",  "Layer 2, 11-bit identifiers"},
    {"29",  "Layer 2, 29-bit identifiers"},
    {"417", "CANopen, CiA 417 (lifts)"},
});

// [FX3U-CAN 2.3]
inline constexpr std::array standard_facts = std::to_array<Standard>({
    {"CiA 301",   "4.2", "application layer and communication profile"},
    {"CiA 302",   "4.1", "additional application layer functions"},
    {"CiA 305",   "2.2", "layer setting services (master)"},
    {"CiA 405",   "2.0", "IEC 61131-3 programmable devices"},
    {"CiA 417",   "2.1", "lift control systems (function mode 417)"},
});

// [FX3U-CAN 1.2.3] A row of five terminals.
inline constexpr std::array pin_facts = std::to_array<ConnectorPin>({
    {1, "CAN_GND",  "ground"},
    {2, "CAN_L",    "dominant low"},
    {3, "CAN_SHLD", "shield"},
    {4, "CAN_H",    "dominant high"},
    {5, "CAN_V+",   "not connected inside"},
});

// [FX3U-CAN 2.3]
inline constexpr std::array bus_length_facts = std::to_array<BusLength>({
    {1000, 25}, {800, 50}, {500, 100}, {250, 250}, {125, 500}, {100, 600}, {50, 1000}, {20, 2500}, {10, 5000},
});

// [FX3U-CAN 1.3.2]
inline constexpr std::array cpu_facts = std::to_array<ModulesPerCpu>({
    {"FX3G",          "1.00 or later",  8},
    {"FX3GC",         "1.40 or later",  8},
    {"FX3U, FX3UC",   "2.20 or later",  8},
    {"FX3UC-32MT-LT", "2.20 or later",  7},
    {"FX5U, FX5UC",   "1.031 or later", 8},
});

inline constexpr std::array property_facts = std::to_array<Property>({
    {"Place",                 "right side of the main unit; special function block No. 0 to 7, 1 to 7 behind an FX3UC-32MT-LT, 2 to 16 behind an FX5U or FX5UC (1 to 16 in the configuration tool)"},
    {"Firmware",              "as 1.12"},
    {"Since firmware 1.10",   "100CH, 100DH, 1020H, 102AH; #70, #71, #10000 to #13539; #20 bits 8, 9, 12; EMCY 3111H, 3121H, 8F01H to 8F7FH"},
    {"Since firmware 1.12",   "FX5U, FX5UC"},
    {"Version of the PLC",    "last three digits of D8001 or D8101"},
    {"Values of 32 bits",     "two words: read and write them by 32-bit instructions, else old and new may mix; no error shows it"},
    {"RUN>STOP messages",     "sent some time after STOP that depends on the PLC and its extension blocks; here at once"},
    {"Transmission",          "CAN bus network (ISO 11898, CSMA/CR)"},
    {"Cable",                 "ISO 11898, shielded twisted pair, 120 ohm"},
    {"Terminating resistors", "120 ohm at both ends, not built in"},
    {"Nodes per segment",     "30 without repeaters, 127 in the network"},
    {"Supply",                "24 V DC 110 mA from the PLC"},
    {"Weight",                "0.2 kg"},
});
// clang-format on

inline constexpr DataSheet data_sheet{
    .model = "FX3U-CAN",
    .maker = "Mitsubishi Electric",
    .manual = "FX3U-CAN User's Manual, revision E",
    .type = "Special",
    .series = "FX",
    .function_version = "1.12",
    .points = 8,
    .io_assignment = "8 points, no X/Y",
    .word_prefix = "BFM #",
    .online_module_change = false,
    .multiple_cpu = "none",
    .flash_writes = 10'000,  // [6.1]
    .connector = "5 terminals, M3",
    .modes = mode_facts,
    .standards = standard_facts,
    .pins = pin_facts,
    .bus_lengths = bus_length_facts,
    .modules_per_cpu = cpu_facts,
    .properties = property_facts,
};

// [FX3U-CAN 6.8, 6.17, 14.2]
inline constexpr ResetProcedure reset_procedure{
    .clear_errors = {.kind = ResetRequest::Kind::word, .word = 29, .value = 0, .text = "0 into BFM #29"},
    .restart = {.kind = ResetRequest::Kind::word, .word = 25, .value = 1, .text = "bit 0 into BFM #25"},
    .error_word = 29,
    .error_word_name = "BFM #29",
};

}  // namespace canopus::module::fx3u_can
