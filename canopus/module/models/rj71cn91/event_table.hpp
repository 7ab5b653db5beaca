#pragma once
// Events and errors that the RJ71CN91 reports to its CPU [RJ71CN91 5.5, 5.6]. The manual prints the class of 1804H (minor)
// and 3000H (moderate); of the others it follows from 5.1: hardware is major, parameters and stored data are moderate,
// communication is minor.

#include <array>

#include "canopus/module/interface/event_records.hpp"
#include "canopus/module/memory/diagnostics.hpp"

namespace canopus::module::rj71cn91 {

// clang-format off
inline constexpr std::array event_table = std::to_array<EventRow>({
    {ModuleEvent::canopen_start,         0x0400, "Start in CANopen 405 mode"},
    {ModuleEvent::layer2_base_start,     0x0401, "Start in 11-bit CAN-ID Layer 2 message mode"},
    {ModuleEvent::layer2_extended_start, 0x0402, "Start in 29-bit CAN-ID Layer 2 message mode"},
    {ModuleEvent::restarted,             0x0404, "Module restart complete"},
    {ModuleEvent::online,                0x0405, "Layer 2 online mode status"},
    {ModuleEvent::offline,               0x0406, "Layer 2 offline mode status"},
    {ModuleEvent::errors_cleared,        0x0408, "Error clear complete"},
    {ModuleEvent::node_failures_cleared, 0x0409, "NMT error control failure clear complete"},
    {ModuleEvent::emergencies_cleared,   0x040A, "EMCY message area clear complete"},
    {ModuleEvent::saved,                 0x040C, "Configuration save complete"},
    {ModuleEvent::restored,              0x040D, "Restore factory default complete"},
    {ModuleEvent::warning_level,         0x040E, "CAN error counter warning level"},
    {ModuleEvent::error_passive,         0x040F, "CAN error counter passive state"},
    {ModuleEvent::emergency_received,    0x0410, "EMCY message received"},
    {ModuleEvent::emergency_sent,        0x0411, "EMCY message transmission command completed"},
    {ModuleEvent::error_control,         0x0412, "NMT error control event"},
    {ModuleEvent::life_guarding,         0x0413, "Node guarding event"},
    {ModuleEvent::nmt_reset,             0x0414, "NMT reset executed"},
    {ModuleEvent::nmt_state,             0x0415, "NMT state changed"},
    {ModuleEvent::flying_master,         0x0416, "Flying master event"},
});

inline constexpr std::array error_table = std::to_array<DiagnosisRow>({
    {Diagnosis::flash_worn,          0x1080, ErrorClass::minor,    "The number of writes to the flash ROM has exceeded 100000"},
    {Diagnosis::queue_overflow,      0x1800, ErrorClass::minor,    "The send buffer or receive buffer has overflown"},
    {Diagnosis::rpdo_length,         0x1801, ErrorClass::minor,    "The data length of the received PDO is invalid", {"PDO number", "PDO error cause"}},
    {Diagnosis::invalid_object,      0x1802, ErrorClass::minor,    "An invalid CANopen object was received", {"COB-ID", "CANopen error cause"}},
    {Diagnosis::message_slot,        0x1803, ErrorClass::minor,    "A Layer 2 message slot specific error occurred", {"Message slot number"}},
    {Diagnosis::bus_off,             0x1804, ErrorClass::minor,    "The module is in bus off state"},
    {Diagnosis::save_while_online,   0x1805, ErrorClass::minor,    "Save or restore was requested in the Layer 2 online mode"},
    {Diagnosis::slave_boot,          0x1806, ErrorClass::minor,    "An error occurred during NMT slave start-up", {"Node ID", "NMT slave start-up error cause"}},
    {Diagnosis::start_up,            0x1807, ErrorClass::minor,    "An error occurred during NMT start-up", {"NMT start-up error cause"}},
    {Diagnosis::slave_configuration, 0x1808, ErrorClass::minor,    "An error occurred in the NMT slave setting during NMT start-up", {"Node ID", "NMT slave setting error cause"}},
    {Diagnosis::extension_parameter, 0x2250, ErrorClass::moderate, "An error was detected in the extension parameter", {"Parameter type"}},
    {Diagnosis::invalid_value,       0x3000, ErrorClass::moderate, "The set parameter value is invalid", {"Buffer memory address"}},
    {Diagnosis::flash_data,          0x3001, ErrorClass::moderate, "There is invalid data in the flash ROM"},
    {Diagnosis::hardware,            0x3C00, ErrorClass::major,    "A hardware failure has been detected", {"Cause type code"}},
    {Diagnosis::watchdog,            0x3C02, ErrorClass::major,    "A hardware failure has been detected", {"Cause type code"}},
});
// clang-format on

}  // namespace canopus::module::rj71cn91
