#pragma once
// Facts of the AS-FCOPM that are physical, or about its place in a system [AS-FCOPM 10.1, 10.2].

#include <array>

#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/reset_procedure.hpp"

namespace canopus::module::as_fcopm {

// clang-format off
inline constexpr std::array mode_facts = std::to_array<FunctionMode>({
    {"1", "CANopen DS301, master"},
    {"2", "CANopen DS301, slave"},
});

// [AS-FCOPM 10.1.1]
inline constexpr std::array standard_facts = std::to_array<Standard>({
    {"CiA DS-301", "4.02", "application layer and communication profile, as master and as slave"},
});

// [AS-FCOPM 10.2.4.3]
inline constexpr std::array bus_length_facts = std::to_array<BusLength>({
    {1000, 25}, {500, 100}, {250, 250}, {125, 500}, {50, 1000}, {20, 2500},
});

// [AS-FCOPM 10.2.2]
inline constexpr std::array cpu_facts = std::to_array<ModulesPerCpu>({
    {"AS300", "AS332T-A, AS332P-A, AS324MT-A", 1},
});

inline constexpr std::array property_facts = std::to_array<Property>({
    {"Place",       "function card slot 2 of an AS300 PLC"},
    {"Cable",       "UC-DN01Z-01A, UC-DN01Z-02A, UC-CMC; RJ45"},
    {"Termination", "120 ohm, by a switch on the card"},
    {"Tools",       "HWCONFIG in ISPSoft, CANopen Builder"},
    {"LEDs",        "not described in chapter 10"},
});
// clang-format on

inline constexpr DataSheet data_sheet{
    .model = "AS-FCOPM",
    .maker = "Delta Electronics",
    .manual = "AS series manual, chapter 10 (CANopen function and operation)",
    .type = "Function card",
    .series = "AS",
    .points = 0,
    .io_assignment = "no X/Y; registers D24000-24978, D25000-25978, SR821-893",
    .word_prefix = "",
    .online_module_change = false,
    .multiple_cpu = "none",
    .flash_writes = 0,  // not printed
    .connector = "RJ45",
    .modes = mode_facts,
    .standards = standard_facts,
    .bus_lengths = bus_length_facts,
    .modules_per_cpu = cpu_facts,
    .properties = property_facts,
};

// [AS-FCOPM 10.5.1]
inline constexpr ResetProcedure reset_procedure{
    .clear_errors = {.text = "its codes go by themselves when their cause is gone"},
    .restart = {.text = "it starts with the PLC's supply alone"},
};

}  // namespace canopus::module::as_fcopm
