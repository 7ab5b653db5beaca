#include <array>

#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/module/engine/signal_port.hpp"
#include "canopus/module/models/me3can1_q/buffer_table.hpp"
#include "canopus/module/models/me3can1_q/data_sheet.hpp"
#include "canopus/module/models/me3can1_q/me3can1_q.hpp"
#include "canopus/module/q_iqr/canopen_options.hpp"
#include "canopus/module/q_iqr/plc_interface.hpp"

namespace canopus::module::me3can1_q {

namespace {

namespace emcy_code = canopen::emcy_code;

// clang-format off
/// [ME3CAN1-Q 3.1.1]
constexpr std::array leds = std::to_array<LedRow>({
    {"RUN",     LedUse::supply},
    {"ERR.",    LedUse::error},
    {"CAN RUN", LedUse::network_state},
    {"TX/RX",   LedUse::traffic},
    {"CAN ERR", LedUse::network_error},
});
// clang-format on

/// Bits of G25 [ME3CAN1-Q Tab. 3-10].
constexpr CommunicationStatusBits communication_status{
    .operational = 1U << 0,
    .warning_level = 1U << 1,
    .nmt_reset_seen = 1U << 6,
    .initialization = initialization_bit,
    .pre_operational_state = 1U << 8,
    .operational_state = 1U << 9,
    .lss_active = 1U << 10,
    .time_seen = 1U << 12,
    .slave_start_up = 1U << 14,
    .nmt_master = 1U << 15,
};

// clang-format off
/// Bits of G29 [ME3CAN1-Q Tab. 3-11].
constexpr std::array errors = std::to_array<ErrorRow>({
    // error                     bit  latched  makes X0F
    {ModuleError::hardware,        1, false,   true},
    {ModuleError::bus_off,         3, false,   true},
    {ModuleError::flash,           4, false,   true},
    {ModuleError::refused_write,   5, true,    true},
    {ModuleError::invalid_value,   6, true,    true},
    {ModuleError::queue_overflow,  8, true,    true},
    {ModuleError::error_passive,  14, false,   false},
    {ModuleError::message_slot,   15, true,    true},
});
// clang-format on

/// What the module sends by itself [ME3CAN1-Q 8.2.1, 8.2.2].
constexpr EmergencyRows emergencies{
    .cpu_error = {emcy_code::device_specific, 0x81, {'M', 'E', '0', '0', '1'}},
    .cpu_stopped = {emcy_code::device_specific, 0x81, {'M', 'E', '0', '0', '2'}},
    .restart = {emcy_code::user_software, 0x01, {'M', 'E', '0', '0', '4'}},
    .queue_overflow = {emcy_code::can_overrun, 0x11},
    .error_passive = {emcy_code::error_passive, 0x11},
    .node_lost = {emcy_code::node_lost, 0x11},
};

// [ME3CAN1-Q 4.8.12]
manager::MasterOptions master_options() {
  manager::MasterOptions options = q_iqr::master_options();
  options.configuration_skips_read_only = true;
  return options;
}

}  // namespace

constinit const ModuleModel model{
    .data_sheet = &data_sheet,
    .buffer_memory_size = 65536,
    .buffer_memory = buffer_table,
    .function_modes = function_modes_of_g21,
    .request_port = requests_by_signals,
    .signals = signals,
    .leds = leds,
    .emergencies = emergencies,
    .settings = q_iqr::settings,
    .status = StatusWordsLayout{.communication_status = g::communication_status,
                                .bits = communication_status,
                                .transmit_errors = g::transmit_errors,
                                .receive_errors = g::receive_errors,
                                .active_bit_rate = g::active_baud_rate},
    .error_status = ErrorStatusLayout{.status = g::error_status,
                                      .invalid_address = g::setting_error,
                                      .refused_address = refused_write,
                                      .errors = errors},
    .exchange_control = ExchangeControlLayout{.address = g::data_exchange_control,
                                              .process_data = 1U << 8,
                                              .emergencies = 1U << 12,
                                              .running = 1U << 8},
    .emergency_buffer = q_iqr::emergency_buffer,
    .nmt_status = q_iqr::nmt_status,
    .network_settings = q_iqr::network_settings,
    .time_stamp = TimeStampLayout{.first = g::time_stamp, .two_digit_year = true},
    .command = q_iqr::command,
    .layer2 = layer2_layout,
    .program_interface = q_iqr::program_interface,
    .object_dictionary = object_dictionary,
    .node_id_defaults = q_iqr::set_detect_cycle,
    .node_options = q_iqr::node_options,
    .master_options = master_options,
    .configuration_options = q_iqr::configuration_options,
    .faulty_mapping_keeps_initializing = true,
    .layer2_deletes_objects = true,
};

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description = q_iqr::make_dictionary({.device_name = "ME3CAN1-Q",
                                                          .hardware_version = "1.00",
                                                          .software_version = "1.00",
                                                          .vendor = 0x0000'0071,
                                                          .product = 0x0000'ED63,
                                                          .revision = 0x0001'0000});
  return description;
}

}  // namespace canopus::module::me3can1_q
