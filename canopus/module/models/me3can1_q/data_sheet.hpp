#pragma once
// Facts of the ME3CAN1-Q that are physical, or about its place in a system
// [ME3CAN1-Q 1.2, 2.2, 3.1, 3.2, 6.4].

#include <array>

#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/reset_procedure.hpp"

namespace canopus::module::me3can1_q {

// clang-format off
inline constexpr std::array mode_facts = std::to_array<FunctionMode>({
    {"405", "CANopen, CiA 405"},
    {"11",  "Layer 2, 11-bit identifiers"},
    {"29",  "Layer 2, 29-bit identifiers"},
});

inline constexpr std::array standard_facts = std::to_array<Standard>({
    {"CiA 301",   "4.2", "application layer and communication profile"},
    {"CiA 302",   "4.1", "additional application layer functions"},
    {"CiA 305",   "2.2", "layer setting services"},
    {"CiA 405",   "2.0", "IEC 61131-3 programmable devices"},
    {"CiA 303-1", "1.8", "connector"},
    {"CiA 303-3", "1.4", "LEDs"},
});

// [ME3CAN1-Q 3.1.2]
inline constexpr std::array pin_facts = std::to_array<ConnectorPin>({
    {1, "",         ""},
    {2, "CAN_L",    "dominant low"},
    {3, "CAN_GND",  "ground"},
    {4, "",         ""},
    {5, "CAN_SHLD", "shield"},
    {6, "",         ""},
    {7, "CAN_H",    "dominant high"},
    {8, "",         ""},
    {9, "",         ""},
});

// [ME3CAN1-Q 3.2]
inline constexpr std::array bus_length_facts = std::to_array<BusLength>({
    {1000, 25}, {800, 50}, {500, 100}, {250, 250}, {125, 500}, {100, 600}, {50, 1000}, {20, 2500}, {10, 5000},
});

// [ME3CAN1-Q Tab. 2-1, 2-2]
inline constexpr std::array cpu_facts = std::to_array<ModulesPerCpu>({
    {"Basic model QCPU",             "Q00J",                     16},
    {"Basic model QCPU",             "Q00 Q01",                  24},
    {"High performance model QCPU",  "Q02 Q02H Q06H Q12H",       64},
    {"Process CPU",                  "Q02PH Q06PH Q12PH Q25PH",  64},
    {"Redundant CPU",                "Q12PRH Q25PRH",             0},
    {"Universal model QCPU",         "Q00UJ",                    16},
    {"Universal model QCPU",         "Q00U Q01U",                24},
    {"Universal model QCPU",         "Q02U",                     36},
    {"Universal model QCPU",         "QnUD(E) Q50UDEH Q100UDEH", 64},
    {"Safety CPU",                   "QS001",                     0},
    {"C Controller module",          "Q06CCPU-V-H01 Q06CCPU-V Q06CCPU-V-B Q12DCCPU-V", 64},
    {"MELSECNET/H remote I/O head",  "QJ72LP25-25 QJ72LP25G QJ72LP25GE QJ72BR15", 64},
});

inline constexpr std::array property_facts = std::to_array<Property>({
    {"Base units",                "any I/O slot of main and extension base units"},
    {"MELSECNET/H remote I/O",    "not with a Basic model QCPU or a C Controller module"},
    {"Transmission",              "CAN bus network (RS-485, CSMA/CR)"},
    {"Cable",                     "ISO 11898, shielded, 2 x 2 twisted, about 120 ohm"},
    // [6.4.2, Tab. 6-3]
    {"Cable cross section",       "to 40 m 0.3 to 0.34 mm2, to 300 m 0.34 to 0.60 mm2, to 600 m 0.50 to 0.60 mm2, to 1000 m 0.75 to 0.80 mm2"},
    {"Cable resistance",          "to 40 m 70 mOhm/m, to 300 m below 60, to 600 m below 40, to 1000 m below 26"},
    {"Terminating resistors",     "120 ohm at both ends, not built in"},
    {"Insulation",                "photocouplers and DC/DC converter between CAN and PLC"},
    {"Current consumption (5 V)", "0.34 A"},
    {"Weight",                    "0.12 kg"},
    // [8.2.1]
    {"Emergency codes",           "0000H 6200H 8110H 8120H 8200H 8210H 8220H 8250H 8F01H-8F7FH FF00H; others by command 000AH only"},
    {"Emergency code 8250H",      "never occurs: RPDO time-out, and 1400H-14FFH have no event timer"},
});
// clang-format on

inline constexpr DataSheet data_sheet{
    .model = "ME3CAN1-Q",
    .maker = "Mitsubishi Electric",
    .manual = "ME3CAN1-Q User's Manual, version A, 10/2014",
    .type = "Intelli.",
    .series = "Q",
    .serial_number = "1203100000000000",
    .function_version = "B",
    .points = 32,
    .io_assignment = "Intelligent 32 points",
    .online_module_change = false,
    .multiple_cpu = "parameters are accepted from the module's control CPU only",
    .flash_writes = 10'000,  // [4.6]
    .connector = "9-pin D-sub, 4-40 UNC screws",
    .modes = mode_facts,
    .standards = standard_facts,
    .pins = pin_facts,
    .bus_lengths = bus_length_facts,
    .modules_per_cpu = cpu_facts,
    .properties = property_facts,
};

// [ME3CAN1-Q 3.3.2, 3.5.7]
inline constexpr ResetProcedure reset_procedure{
    .clear_errors = {.kind = ResetRequest::Kind::signal, .signal = 0x0F, .text = "Y0F ON until X0F is OFF"},
    .restart = {.kind = ResetRequest::Kind::signal, .signal = 0x02, .text = "Y02 ON until X02 is ON"},
    .error_word = 29,
    .error_word_name = "G29",
};

}  // namespace canopus::module::me3can1_q
