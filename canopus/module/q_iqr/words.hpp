#pragma once
// What the buffer memories of MELSEC's intelligent function modules for CAN have alike: function modes, addresses,
// values [ME3CAN1-Q Tab. 3-6; RJ71CN91 App. 2]. What each lets a program do with a word is its own buffer table.

#include <array>

#include "canopus/module/interface/program_interface.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module::q_iqr {

// Function modes (G21).
inline constexpr Modes canopen_405 = 1;
inline constexpr Modes layer2_11 = 2;
inline constexpr Modes layer2_29 = 4;
inline constexpr Modes layer2 = layer2_11 | layer2_29;
inline constexpr Modes all_modes = canopen_405 | layer2;

// Addresses of single words and of areas.
namespace g {
inline constexpr BufferAddress data_exchange_control = 20;
inline constexpr BufferAddress function_mode = 21;
inline constexpr BufferAddress save_restore = 22;
inline constexpr BufferAddress baud_rate = 24;
inline constexpr BufferAddress communication_status = 25;
inline constexpr BufferAddress node_address = 27;
inline constexpr BufferAddress error_status = 29;
inline constexpr BufferAddress transmit_errors = 35;
inline constexpr BufferAddress receive_errors = 36;
inline constexpr BufferAddress active_baud_rate = 37;
inline constexpr BufferAddress sampling_point = 38;
inline constexpr BufferAddress setting_error = 39;
inline constexpr BufferAddress time_stamp = 50;
inline constexpr BufferAddress daily_correction = 59;
inline constexpr BufferAddress start_all_delay = 70;
inline constexpr BufferAddress sdo_time_out = 71;
inline constexpr BufferAddress error_clear_node = 400;
inline constexpr BufferAddress error_control_status = 401;  ///< of node 1
inline constexpr BufferAddress nmt_state = 601;             ///< of node 1
inline constexpr BufferAddress emergencies = 750;
inline constexpr BufferAddress command = 1000;
inline constexpr BufferAddress slot_errors = 5001;
inline constexpr BufferAddress slot_parameters = 6000;
inline constexpr BufferAddress rtr_flags = 8350;
inline constexpr BufferAddress trigger_flags = 8400;
inline constexpr BufferAddress stop_messages = 8450;
inline constexpr BufferAddress slot_data = 10000;  ///< in the Layer 2 modes
inline constexpr BufferAddress receive_data = 10000;
inline constexpr BufferAddress transmit_data = 13000;
}  // namespace g

inline constexpr std::array<std::uint16_t, 3> function_modes{405, 11, 29};
inline constexpr std::array<std::uint16_t, 9> baud_rates{10, 20, 50, 100, 125, 250, 500, 800, 1000};
inline constexpr DataExchangeLayout exchange_layout{
    .receive_first = g::receive_data, .transmit_first = g::transmit_data, .words = 1024, .pdos = 256};

}  // namespace canopus::module::q_iqr
