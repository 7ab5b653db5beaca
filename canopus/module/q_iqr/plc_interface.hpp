#pragma once
// How a program works with MELSEC's intelligent function modules for CAN: function modes, signals, commands, and which
// words are which area's. The two manuals agree on all of it [ME3CAN1-Q 3.3, 3.4, 5; RJ71CN91 App. 1, App. 2].

#include <array>

#include "canopus/module/canopen/emergency_buffer.hpp"
#include "canopus/module/canopen/network_settings.hpp"
#include "canopus/module/canopen/nmt_status.hpp"
#include "canopus/module/commands/command_interface.hpp"
#include "canopus/module/engine/module_model.hpp"
#include "canopus/module/layer2/layer2_settings.hpp"
#include "canopus/module/memory/module_state.hpp"
#include "canopus/module/q_iqr/words.hpp"

namespace canopus::module::q_iqr {

inline constexpr std::array function_modes_of_g21 = std::to_array<FunctionModeRow>({
    {405, canopen_405, FunctionModeRow::Kind::canopen},
    {11, layer2_11, FunctionModeRow::Kind::layer2_base},
    {29, layer2_29, FunctionModeRow::Kind::layer2_extended},
});

// clang-format off
/// Commands of the command interface [ME3CAN1-Q 4.4, 5; RJ71CN91 App. 2].
inline constexpr std::array commands = std::to_array<CommandRow>({
    // code   what it does                modes        success  partly failed
    {0x0000, CommandKind::display,       all_modes,   0x0000,  0x0000},
    {0x0002, CommandKind::sdo_write,     canopen_405, 0x0003,  0x000F},
    {0x0004, CommandKind::sdo_read,      canopen_405, 0x0005,  0x000F},
    {0x0006, CommandKind::multi_write,   canopen_405, 0x0007,  0x00F7},
    {0x0008, CommandKind::multi_read,    canopen_405, 0x0009,  0x00F9},
    {0x000A, CommandKind::emergency,     canopen_405, 0x000B,  0x000C},
    {0x000C, CommandKind::send_frame,    layer2,      0x000D,  0xF00C},
    {0xFFFF, CommandKind::clear,         all_modes,   0x0000,  0x0000},
});

/// Signals: offsets from the head address [ME3CAN1-Q Tab. 3-3; RJ71CN91 App. 1].
inline constexpr std::uint8_t ready_signal = 0x00;
inline constexpr std::uint8_t data_exchange_signal = 0x01;
inline constexpr std::uint8_t online_signal = 0x03;
inline constexpr std::uint8_t command_signal = 0x17;
inline constexpr std::array signals = std::to_array<SignalRow>({
    {ready_signal,         RequestUse::ready,            all_modes},
    {data_exchange_signal, RequestUse::data_exchange,    all_modes},
    {0x02,                 RequestUse::restart,          all_modes},
    {online_signal,        RequestUse::online,           layer2},
    {0x04,                 RequestUse::transmit_trigger, layer2},
    {0x0F,                 RequestUse::error,            all_modes},
    {0x10,                 RequestUse::nmt_error,        canopen_405},
    {0x11,                 RequestUse::emergency,        canopen_405},
    {0x12,                 RequestUse::set_clock,        canopen_405},
    {0x13,                 RequestUse::read_clock,       canopen_405},
    {command_signal,       RequestUse::command,          all_modes},
    {0x1F,                 RequestUse::save_restore,     all_modes},
});
// clang-format on

inline constexpr SettingsLayout settings{.function_mode = g::function_mode,
                                         .baud_rate = g::baud_rate,
                                         .node_address = g::node_address,
                                         .save_restore = g::save_restore,
                                         .save = 1U << 0,
                                         .restore = 1U << 1};
inline constexpr EmergencyBufferLayout emergency_buffer{.first = g::emergencies, .stack = 11, .ring = 11};
inline constexpr NmtStatusLayout nmt_status{
    .error_control = g::error_control_status, .state = g::nmt_state, .clear_node = g::error_clear_node};
inline constexpr NetworkSettingsLayout network_settings{.start_all_delay = g::start_all_delay,
                                                        .sdo_time_out = g::sdo_time_out};
inline constexpr CommandLayout command{.first = g::command, .commands = commands};
inline constexpr Layer2Layout layer2_layout{.error_codes = g::slot_errors,
                                            .parameters = g::slot_parameters,
                                            .rtr_flags = g::rtr_flags,
                                            .trigger_flags = g::trigger_flags,
                                            .stop_messages = g::stop_messages,
                                            .process_data = g::slot_data};

/// Bit 7 of G25.
inline constexpr std::uint16_t initialization_bit = 1U << 7;

// [ME3CAN1-Q 3.3.2, 3.5.5]
inline constexpr ProgramInterface program_interface{
    .exchange = {.kind = ProgramRequest::Kind::signal, .signal = data_exchange_signal},
    .online = {.kind = ProgramRequest::Kind::signal, .signal = online_signal},
    .ready = ready_signal,
    .status = g::communication_status,
    .initializing = initialization_bit,
    .process_data = exchange_layout,
    .command = {.first = g::command,
                .sdo_write = 0x0002,
                .success = 0x0003,
                .execute = {.kind = ProgramRequest::Kind::signal, .signal = command_signal}},
    .node_address = g::node_address};

}  // namespace canopus::module::q_iqr
