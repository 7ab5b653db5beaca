#include "canopus/module/me3can1_q/model.hpp"

#include <array>
#include <chrono>

#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/module/engine/signal_port.hpp"
#include "canopus/module/me3can1_q/buffer_table.hpp"
#include "canopus/module/me3can1_q/data_sheet.hpp"
#include "canopus/module/me3can1_q/object_table.hpp"

namespace canopus::module::me3can1_q {

namespace {

namespace assignment_bit = manager::assignment_bit;
namespace emcy_code = canopen::emcy_code;

constexpr std::array function_modes_of_g21 = std::to_array<FunctionModeRow>({
    {405, canopen_405, FunctionModeRow::Kind::canopen},
    {11, layer2_11, FunctionModeRow::Kind::layer2_base},
    {29, layer2_29, FunctionModeRow::Kind::layer2_extended},
});

// clang-format off
/// Commands of the command interface [ME3CAN1-Q 4.4, 5].
constexpr std::array commands = std::to_array<CommandRow>({
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

/// Signals: offsets from the head address [ME3CAN1-Q Tab. 3-3].
constexpr std::uint8_t ready_signal = 0x00;
constexpr std::uint8_t data_exchange_signal = 0x01;
constexpr std::uint8_t online_signal = 0x03;
constexpr std::uint8_t command_signal = 0x17;
constexpr std::array signals = std::to_array<SignalRow>({
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
    .initialization = 1U << 7,
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

canopen::NodeOptions node_options() {
  return {
      .dismiss_events_during_inhibit = true,
      .unsent_values_are_changed = false,
      .send_tpdos_on_start = false,
      .sdo_write_is_event = false,
      .tpdo_rtr_bit_is_constant = true,
      .rtr_transmission_types = false,
      .profile_event_transmission_type = false,
      .inhibit_time_resolution = std::chrono::milliseconds(1),
      .extended_identifiers = false,
      .sync_needs_active_master = true,
      .sync_period_resolution = std::chrono::milliseconds(1),
      .history_clears_error_register = true,
      .empty_history_reads_zero = true,
      .guarding_emergency_names_node = true,
      .sync_length_error = emcy_code::protocol_error,
      .save_before_restored = true,
  };
}

// No software check, no restore [ME3CAN1-Q Tab. 4-30]; the manual knows no SDO block transfer.
manager::MasterOptions master_options() {
  manager::MasterOptions options;
  options.assignment_bits = assignment_bit::slave | assignment_bit::boot_slave | assignment_bit::mandatory |
                            assignment_bit::keep_alive;
  options.block_from = 0;
  return options;
}

// [ME3CAN1-Q 4.8.12]
manager::ConfigurationOptions configuration_options() {
  return {.maximum_files = 60,
          .maximum_size = 65531,
          .delete_first = true,
          .check_files = false,
          .in_download = canopen::AbortCode::hardware_error,
          .no_room = canopen::AbortCode::cannot_store};
}

// [ME3CAN1-Q 4.8.10]
void set_detect_cycle(canopen::ObjectDictionary& objects, std::uint8_t node_id) {
  objects.set<std::uint16_t>(0x1F90, 6, static_cast<std::uint16_t>(4000 + 10 * node_id));
}

}  // namespace

constinit const ModuleModel model{
    .data_sheet = &data_sheet,
    .word_prefix = "G",
    .buffer_memory_size = 65536,
    .buffer_memory = buffer_table,
    .function_modes = function_modes_of_g21,
    .request_port = requests_by_signals,
    .signals = signals,
    .leds = leds,
    .emergencies = emergencies,
    .settings = {.function_mode = g::function_mode,
                 .baud_rate = g::baud_rate,
                 .node_address = g::node_address,
                 .save_restore = g::save_restore,
                 .save = 1U << 0,
                 .restore = 1U << 1},
    .status = StatusWordsLayout{.communication_status = g::communication_status,
                                .bits = communication_status,
                                .transmit_errors = g::transmit_errors,
                                .receive_errors = g::receive_errors,
                                .active_bit_rate = g::active_baud_rate},
    .error_status = ErrorStatusLayout{.status = g::error_status,
                                      .invalid_address = g::setting_error,
                                      .refused_address = g::refused_write,
                                      .errors = errors},
    .exchange_control = ExchangeControlLayout{.address = g::data_exchange_control,
                                              .process_data = 1U << 8,
                                              .emergencies = 1U << 12,
                                              .running = 1U << 8},
    .emergency_buffer = EmergencyBufferLayout{.first = g::emergencies, .stack = 11, .ring = 11},
    .nmt_status = NmtStatusLayout{.error_control = g::error_control_status,
                                  .state = g::nmt_state,
                                  .clear_node = g::error_clear_node},
    .network_settings =
        NetworkSettingsLayout{.start_all_delay = g::start_all_delay, .sdo_time_out = g::sdo_time_out},
    .time_stamp = TimeStampLayout{.first = g::time_stamp, .two_digit_year = true},
    .command = CommandLayout{.first = g::command, .commands = commands},
    .layer2 = Layer2Layout{.error_codes = g::slot_errors,
                           .parameters = g::slot_parameters,
                           .rtr_flags = g::rtr_flags,
                           .trigger_flags = g::trigger_flags,
                           .stop_messages = g::stop_messages,
                           .process_data = g::slot_data},
    // [ME3CAN1-Q 3.3.2, 3.5.5]
    .program_interface = {.exchange = {.kind = ProgramRequest::Kind::signal, .signal = data_exchange_signal},
                          .online = {.kind = ProgramRequest::Kind::signal, .signal = online_signal},
                          .ready = ready_signal,
                          .status = g::communication_status,
                          .initializing = communication_status.initialization,
                          .process_data = exchange_layout,
                          .command = {.first = g::command,
                                      .sdo_write = 0x0002,
                                      .success = 0x0003,
                                      .execute = {.kind = ProgramRequest::Kind::signal,
                                                  .signal = command_signal}},
                          .node_address = g::node_address},
    .object_dictionary = object_dictionary,
    .node_id_defaults = set_detect_cycle,
    .node_options = node_options,
    .master_options = master_options,
    .configuration_options = configuration_options,
    .faulty_mapping_keeps_initializing = true,
    .layer2_deletes_objects = true,
};

}  // namespace canopus::module::me3can1_q
