#pragma once
// Facts of the RJ71CN91 that are physical, or about its place in a system [RJ71CN91 2.1, 2.3, App. 3, App. 6]. Connector,
// cable and bus length are in the start-up manual (SH-081734ENG), not in this one.

#include <array>

#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/reset_procedure.hpp"

namespace canopus::module::rj71cn91 {

// clang-format off
inline constexpr std::array mode_facts = std::to_array<FunctionMode>({
    {"405", "CANopen, CiA 405"},
    {"11",  "Layer 2, 11-bit identifiers"},
    {"29",  "Layer 2, 29-bit identifiers"},
});

// [RJ71CN91 App. 2 G24]
inline constexpr std::array bus_length_facts = std::to_array<BusLength>({
    {1000, 0}, {800, 0}, {500, 0}, {250, 0}, {125, 0}, {100, 0}, {50, 0}, {20, 0}, {10, 0},
});

inline constexpr std::array property_facts = std::to_array<Property>({
    {"In GX Works3", "RJ71CN91; in a Layer 2 mode as a general intelligent module with 32 points"},
    {"Configuration tool",    "CANopen 405 mode only; writes while the CPU is in STOP, to a Safety CPU with user authentication"},
    {"Configuration tool: projects",   "project and export files of a newer version are not opened by older ones"},
    {"Configuration tool: one writer", "while it writes nodes, no other program may write by SDO"},
    {"Safety, R00 to R02 CPU", "from firmware version 02 on"},
    {"100 kbit/s in the tool",         "from firmware version 02 on, tool version 1.01B or 1.04E"},
    {"Refresh: not possible", "RnCPU, RnENCPU up to firmware 27, RnPCPU up to 11, RnSFCPU up to 13 (error 2220H); C Controller"},
    {"Refresh: for one module", "RnCPU, RnENCPU firmware 28 to 34, RnPCPU 12 to 13"},
    {"Refresh: no limit",              "RnCPU, RnENCPU from firmware 35 on, RnPCPU, RnSFCPU from 14 on"},
    {"Refresh processing time",        "module label or RD: read 95.20 us, write 28.62 us, in all 123.82 us; device: see the CPU's manual"},
    {"Refresh timing",                 "at the END instruction, or at a program of refresh group 1 to 64"},
    {"Module restart by Y2",           "about 6 s"},
    {"Emergency codes",                "0000H 6200H 8110H 8120H 8200H 8210H 8220H 8250H 8F01H-8F7FH FF00H; others by command 000AH only"},
    {"Emergency code 8250H",           "never occurs: RPDO time-out, and 1400H-14FFH have no event timer"},
    {"Emergency code 8150H",           "never sent: equal CAN-IDs of two nodes are not found out"},
});
// clang-format on

inline constexpr DataSheet data_sheet{
    .model = "RJ71CN91",
    .maker = "Mitsubishi Electric",
    .manual = "MELSEC iQ-R CANopen Module User's Manual (Application), SH-081736ENG-F, 01/2024",
    .type = "Intelli.",
    .series = "R",
    .serial_number = "--",
    .function_version = "02",
    .points = 32,
    .io_assignment = "Intelligent 32 points",
    .online_module_change = false,
    .multiple_cpu = "not said in this manual",
    .flash_writes = 100'000,  // [App. 3 note 3]
    .connector = "not said in this manual",
    .modes = mode_facts,
    .bus_lengths = bus_length_facts,
    .properties = property_facts,
};

// [RJ71CN91 App. 1]
inline constexpr ResetProcedure reset_procedure{
    .clear_errors = {.kind = ResetRequest::Kind::signal, .signal = 0x0F, .text = "YF ON until XF is OFF"},
    .restart = {.kind = ResetRequest::Kind::signal, .signal = 0x02, .text = "Y2 ON until X2 is ON"},
    .error_word = 29,
    .error_word_name = "G29",
};

}  // namespace canopus::module::rj71cn91
