#pragma once
// Facts of the FX2N-32CAN that are physical, or about its place in a system [FX2N-32CAN 3].

#include <array>

#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/reset_procedure.hpp"

namespace canopus::module::fx2n_32can {

// clang-format off
inline constexpr std::array mode_facts = std::to_array<FunctionMode>({
    {"405", "CANopen, DS-405"},
});

// [FX2N-32CAN 3.1]
inline constexpr std::array standard_facts = std::to_array<Standard>({
    {"CiA DS-301", "3.0",  "application layer and communication profile"},
    {"CiA DS-302", "2.0",  "NMT, guarding, guarding request"},
    {"CiA DS-405", "1.0",  "network variables"},
});

// [FX2N-32CAN 3.3] 5000 m at most; the lengths of the other rates are not printed.
inline constexpr std::array bus_length_facts = std::to_array<BusLength>({
    {1000, 0}, {800, 0}, {500, 0}, {250, 0}, {125, 0}, {50, 0}, {20, 0}, {10, 5000},
});

// [FX2N-32CAN 3.3] Special function blocks No. 0 to 7.
inline constexpr std::array cpu_facts = std::to_array<ModulesPerCpu>({
    {"FX1N, FX2N, FX2NC", "all", 8},
});

inline constexpr std::array property_facts = std::to_array<Property>({
    {"Place",             "right side of the main unit; special function block No. 0 to 7"},
    {"Transmission",      "CAN bus network (ISO 11898:1993)"},
    {"Cable",             "ISO 11898, shielded twisted pair 2 x 2, 120 ohm"},
    {"Nodes per segment", "30 without repeaters, 127 in the network"},
    {"Supply",            "5 V DC 130 mA from the PLC"},
    {"Dielectric",        "500 V AC for 1 min between signal line and ground"},
});
// clang-format on

inline constexpr DataSheet data_sheet{
    .model = "FX2N-32CAN",
    .maker = "Mitsubishi Electric",
    .manual = "FX2N-32CAN Communication Module User's Manual, JY992D92801 revision B",
    .type = "Special",
    .series = "FX",
    .points = 8,
    .io_assignment = "8 points, no X/Y",
    .word_prefix = "BFM #",
    .online_module_change = false,
    .multiple_cpu = "none",
    .flash_writes = 0,  // not printed
    .connector = "in the hardware manual JY992D92901",
    .modes = mode_facts,
    .standards = standard_facts,
    .bus_lengths = bus_length_facts,
    .modules_per_cpu = cpu_facts,
    .properties = property_facts,
};

// [FX2N-32CAN 4.2.4, 4.2.7]
inline constexpr ResetProcedure reset_procedure{
    .clear_errors = {.kind = ResetRequest::Kind::word, .word = 29, .value = 0, .text = "0 into BFM #29"},
    .restart = {.kind = ResetRequest::Kind::word, .word = 25, .value = 1, .text = "bit 0 into BFM #25"},
    .error_word = 29,
    .error_word_name = "BFM #29",
};

}  // namespace canopus::module::fx2n_32can
