#include <array>

#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/module/models/fx3u_can/buffer_table.hpp"
#include "canopus/module/models/fx3u_can/data_sheet.hpp"
#include "canopus/module/models/fx3u_can/fx3u_can.hpp"
#include "canopus/module/models/fx3u_can/lift_table.hpp"
#include "canopus/module/models/fx3u_can/object_table.hpp"
#include "canopus/module/q_iqr/canopen_options.hpp"

namespace canopus::module::fx3u_can {

namespace {

namespace emcy_code = canopen::emcy_code;

canopen::NodeOptions node_options() {
  canopen::NodeOptions options = q_iqr::node_options();
  options.rpdo_timer_for_events_alone = true;
  options.rpdo_time_out_names_pdo = true;
  options.profile_event_transmission_type = true;
  options.sync_length_error = emcy_code::sync_length;
  return options;
}

/// PDOs of a drive have the CAN-ID 180H [FX3U-CAN Tab. 5.8].
canopen::NodeOptions lift_node_options() {
  canopen::NodeOptions options = node_options();
  options.permitted_pdo_identifier = 0x180;
  return options;
}

// clang-format off
constexpr std::array mode_rows = std::to_array<FunctionModeRow>({
    {405, mode_405,  FunctionModeRow::Kind::canopen},
    {11,  layer2_11, FunctionModeRow::Kind::layer2_base},
    {29,  layer2_29, FunctionModeRow::Kind::layer2_extended},
    {417, mode_417,  FunctionModeRow::Kind::canopen, lift_dictionary, lift_node_options},
});

/// The same process data at the numbers of older programs [FX3U-CAN 6.1, 7.1].
constexpr std::array windows = std::to_array<ProcessDataWindow>({
    {  0,  19,  0, canopen_modes},
    {100, 399, 20, mode_405},
});

/// Requests by bits, and words whose write, or read, is a request [FX3U-CAN 6.4, 6.6, 6.8, 6.11, 6.19, 9.5, 10.1].
constexpr std::array request_words = std::to_array<RequestWordRow>({
    {  20, RequestUse::data_exchange,    1U << 0 | 1U << 8 | 1U << 12, mode_405},
    {  20, RequestUse::data_exchange,    1U << 0 | 1U << 8 | 1U << 9 | 1U << 12, mode_417},
    {  20, RequestUse::data_exchange,    1U << 0, layer2},
    {  22, RequestUse::save_restore,     1U << 0 | 1U << 1},
    {  25, RequestUse::restart,          1U << 0},
    {  25, RequestUse::online,           1U << 4, layer2},
    {  29, RequestUse::nmt_error,        1U << 10, canopen_modes},
    {  51, RequestUse::read_clock,       {}, canopen_modes},
    {  56, RequestUse::set_clock,        {}, canopen_modes},
    {1000, RequestUse::command},
    {1280, RequestUse::transmit_trigger, {}, layer2},
    {1281, RequestUse::transmit_trigger, {}, layer2},
    {1282, RequestUse::transmit_trigger, {}, layer2},
});

/// Bits of BFM #25 [FX3U-CAN 6.8].
constexpr CommunicationStatusBits communication_status{
    .operational = 1U << 0,
    .layer2_online = 1U << 0,
    .warning_level = 1U << 1,
    .nmt_reset_seen = 1U << 6,
    .initialization = 1U << 7,
    .pre_operational_state = 1U << 8,
    .operational_state = 1U << 9,
    .lss_active = 1U << 10,
    .start_up_failed = 1U << 11,
    .time_seen = 1U << 12,
    .optional_slave_failed = 1U << 13,
    .slave_start_up = 1U << 14,
    .nmt_master = 1U << 15,
};

/// Bits of BFM #29 [FX3U-CAN 14.2].
constexpr std::array error_rows = std::to_array<ErrorRow>({
    // error                          bit  latched  makes bit 0
    {ModuleError::hardware,             1, false,   true},
    {ModuleError::bus_off,              3, false,   true},
    {ModuleError::flash,                4, false,   true},
    {ModuleError::refused_write,        5, true,    true},
    {ModuleError::invalid_value,        6, true,    true},
    {ModuleError::access_watchdog,      7, false,   true},
    {ModuleError::queue_overflow,       8, true,    true},
    {ModuleError::node_failure,        10, true,    true},
    {ModuleError::baud_rate_change,    11, false,   true},
    {ModuleError::node_address_change, 12, false,   true},
    {ModuleError::slave_emergency,     13, true,    false},
    {ModuleError::error_passive,       14, false,   false},
    {ModuleError::message_slot,        15, true,    true},
});
// #27: 14.2 says bit 12, 6.10 says bit 6.
constexpr std::array word_errors = std::to_array<WordErrorRow>({
    {24, ModuleError::baud_rate_change,    false},
    {27, ModuleError::node_address_change, true, canopen_modes},
});

constexpr std::array watched_words = std::to_array<WatchedWords>({
    {0, 19}, {100, 399}, {3000, 3539}, {10000, 10319}, {11000, 11319}, {12000, 12539}, {13000, 13539},
});

/// [FX3U-CAN 7.2, 9.7, 10]
constexpr std::array commands = std::to_array<CommandRow>({
    // code   what it does                modes      success  partly failed
    {0x0000, CommandKind::display,       all_modes, 0x0000,  0x0000},
    {0x0002, CommandKind::sdo_write,     canopen_modes, 0x0003,  0x000F},
    {0x0004, CommandKind::sdo_read,      canopen_modes, 0x0005,  0x000F},
    {0x0006, CommandKind::multi_write,   canopen_modes, 0x0007,  0x00F7},
    {0x0008, CommandKind::multi_read,    canopen_modes, 0x0009,  0x00F9},
    {0x000A, CommandKind::emergency,     canopen_modes, 0x000B,  0x000C},
    {0x000C, CommandKind::send_frame,    layer2,    0x000D,  0xF00C},
    {0x6000, CommandKind::set_up,        canopen_modes, 0x6001,  0x600F, SetUpKind::store},
    {0x6010, CommandKind::set_up,        canopen_modes, 0x6011,  0x601F, SetUpKind::restore},
    {0x7400, CommandKind::set_up,        canopen_modes, 0x7401,  0x740F, SetUpKind::heartbeat_consuming},
    {0x7410, CommandKind::set_up,        canopen_modes, 0x7411,  0x741F, SetUpKind::heartbeat_producing},
    {0x8200, CommandKind::map_pdos,      mode_405,  0x8201,  0x82FF, {}, PdoMapping::mode_a},
    {0x8300, CommandKind::set_up,        mode_405,  0x8301,  0x83FF, SetUpKind::bind_pdos},
    {0x8400, CommandKind::set_up,        canopen_modes, 0x8401,  0x84FF, SetUpKind::slave_assignment},
    {0x8900, CommandKind::map_pdos,      mode_405,  0x8901,  0x000F, {}, PdoMapping::mode_0},
    {0xFFFF, CommandKind::clear,         all_modes, 0x0000,  0x0000},
});

/// [FX3U-CAN 1.2.2]
constexpr std::array leds = std::to_array<LedRow>({
    {"RUN",     LedUse::network_state},
    {"FROM/TO", LedUse::access},
    {"Tx/Rx",   LedUse::traffic},
    {"ERROR",   LedUse::module_error},
    {"POWER",   LedUse::supply},
});
// clang-format on

/// What the module sends by itself. The table of the texts labels the first letter as the fifth byte [FX3U-CAN 6.23].
constexpr EmergencyRow text_message(std::uint16_t code, std::uint8_t error_register, char digit) {
  return {code, error_register, {static_cast<std::uint8_t>(digit), '0', '0', 'X', 'F'}};
}
constexpr EmergencyRows emergencies{
    .cpu_error = text_message(emcy_code::device_specific, 0x81, '1'),
    .cpu_stopped = text_message(emcy_code::device_specific, 0x81, '2'),
    .restart = text_message(emcy_code::user_software, 0x01, '4'),
    .queue_overflow = {emcy_code::can_overrun, 0x11},
    .error_passive = {emcy_code::error_passive, 0x11},
    .node_lost = {emcy_code::node_lost, 0x11},
    .access_watchdog = text_message(emcy_code::user_software, 0x01, '3'),
};

manager::MasterOptions master_options() {
  manager::MasterOptions options = q_iqr::master_options();
  options.commands_show_all_nodes = true;
  options.presence_retry_counts_from_request = true;
  options.configuration_skips_read_only = true;  // [FX3U-CAN 5.8.13]
  return options;
}

}  // namespace

constinit const ModuleModel model{
    .data_sheet = &data_sheet,
    .buffer_memory_size = 32768,
    .buffer_memory = buffer_table,
    .process_data_windows = windows,
    .function_modes = mode_rows,
    .request_port = requests_by_words,
    .request_words = request_words,
    .leds = leds,
    .emergencies = emergencies,
    .settings = {.function_mode = 21,
                 .baud_rate = 24,
                 .node_address = 27,
                 .save_restore = 22,
                 .save = 1U << 0,
                 .restore = 1U << 1},
    .status = StatusWordsLayout{.communication_status = 25,
                                .bits = communication_status,
                                .transmit_errors = 35,
                                .receive_errors = 36,
                                .active_bit_rate = 37},
    .error_status = ErrorStatusLayout{.status = 29,
                                      .invalid_address = 39,
                                      .refused_address = 40,
                                      .errors = error_rows,
                                      .general_error_bit = 0,
                                      .word_errors = word_errors,
                                      .keeps_invalid_value_online = true},
    .exchange_control = ExchangeControlLayout{.address = 20,
                                              .process_data = 1U << 0 | 1U << 8,
                                              .emergencies = 1U << 0 | 1U << 12,
                                              .inputs = 1U << 0 | 1U << 9,
                                              .running = 1U << 0 | 1U << 8,
                                              .layer2_running = 1U << 0},
    .emergency_buffer = EmergencyBufferLayout{.first = 750, .stack = 11, .ring = 11},
    .nmt_status =
        NmtStatusLayout{
            .error_control = 900, .error_control_nodes_per_word = 2, .state = 601, .cleared_by_write = true},
    .network_settings = NetworkSettingsLayout{.start_all_delay = 70, .sdo_time_out = 71},
    .time_stamp = TimeStampLayout{.first = 50,
                                  .two_digit_year = true,
                                  .first_year = 2000,
                                  .last_year = 2099,
                                  .year_of_century = true,
                                  .interval_starts = true,
                                  .consumer_words_fixed = true},
    .access_watchdog = AccessWatchdogLayout{.time = 26, .words = watched_words},
    .command = CommandLayout{.first = 1000, .commands = commands, .clear_code_stops = true},
    .lift = lift_layout,
    .layer2 = Layer2Layout{.error_codes = 401,
                           .parameters = 1100,
                           .rtr_flags = 1270,
                           .trigger_flags = 1280,
                           .stop_messages = 1900,
                           .process_data = 100},
    .layer2_rules = {.cycle_of_zero = std::chrono::milliseconds(1),
                     .exchange_sends_cyclic = true,
                     .errors_keep_offline = false,
                     .frame_word_is_configuration = true,
                     .base_high_word_ignored = true},
    .program_interface =
        {.exchange = {.kind = ProgramRequest::Kind::bits, .word = 20, .bits = 1U << 0},
         .online = {.kind = ProgramRequest::Kind::bits, .word = 25, .bits = 1U << 4},
         .status = 25,
         .initializing = 1U << 7,
         .process_data = exchange_layout,
         .command = {.first = 1000,
                     .sdo_write = 0x0002,
                     .success = 0x0003,
                     .execute = {.kind = ProgramRequest::Kind::write, .word = 1000, .bits = 0x0002}},
         .node_address = 27},
    .cpu = {.stop_ends_master = true, .stop_at_start_counts = true, .stop_ends_layer2 = true},
    .object_dictionary = object_dictionary,
    .node_id_defaults = q_iqr::set_detect_cycle,
    .node_options = node_options,
    .master_options = master_options,
    .configuration_options = q_iqr::configuration_options,
    .faulty_mapping_keeps_initializing = true,
    .restore_clears_files_at_once = true,
    .layer2_deletes_objects = true,
};

}  // namespace canopus::module::fx3u_can
