#include <array>
#include <chrono>

#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/module/engine/signal_port.hpp"
#include "canopus/module/models/rj71cn91/buffer_table.hpp"
#include "canopus/module/models/rj71cn91/data_sheet.hpp"
#include "canopus/module/models/rj71cn91/event_table.hpp"
#include "canopus/module/models/rj71cn91/rj71cn91.hpp"
#include "canopus/module/q_iqr/canopen_options.hpp"
#include "canopus/module/q_iqr/plc_interface.hpp"

namespace canopus::module::rj71cn91 {

namespace {

namespace emcy_code = canopen::emcy_code;

/// [RJ71CN91 5.1] The LEDs that this manual names; the others are the start-up manual's.
constexpr std::array leds = std::to_array<LedRow>({
    {"RUN", LedUse::supply},
    {"ERR", LedUse::error},
    {"CAN ERR", LedUse::network_error},
});

/// Bits of G25 [RJ71CN91 App. 2 G25].
constexpr CommunicationStatusBits communication_status{
    .operational = 1U << 0,
    .warning_level = 1U << 1,
    .initialization = initialization_bit,
    .pre_operational_state = 1U << 8,
    .operational_state = 1U << 9,
    .lss_active = 1U << 10,
    .start_up_failed = 1U << 11,
    .time_seen = 1U << 12,
    .optional_slave_failed = 1U << 13,
    .slave_start_up = 1U << 14,
    .nmt_master = 1U << 15,
};

// clang-format off
/// Bits of G29 [RJ71CN91 5.3, App. 1 XF]. A hardware error is a major one: it is shown while YF is ON, too.
constexpr std::array errors = std::to_array<ErrorRow>({
    // error                        bit  latched  makes XF  not while YF is ON
    {ModuleError::hardware,           1, false,   true,     false},
    {ModuleError::bus_off,            3, false,   true,     true},
    {ModuleError::flash,              4, false,   true,     true},
    {ModuleError::save_while_online,  5, false,   true,     true},
    {ModuleError::invalid_value,      6, true,    true,     true},
    {ModuleError::queue_overflow,     8, true,    true,     true},
    {ModuleError::node_failure,      10, false,   false,    true},
    {ModuleError::error_passive,     14, false,   false,    true},
    {ModuleError::message_slot,      15, false,   true,     true},
});
// clang-format on

/// What the module sends by itself [RJ71CN91 1.7]. It has no message of its own for a CPU error.
constexpr EmergencyRow cpu_stop{emcy_code::device_specific, 0x81, {'M', 'E', '0', '0', '2'}};
constexpr EmergencyRows emergencies{
    .cpu_error = cpu_stop,
    .cpu_stopped = cpu_stop,
    .restart = {emcy_code::user_software, 0x01, {'M', 'E', '0', '0', '4'}},
    .queue_overflow = {emcy_code::can_overrun, 0x11},
    .error_passive = {emcy_code::error_passive, 0x11},
    .node_lost = {emcy_code::node_lost, 0x11},
};

// [RJ71CN91 1.7, App. 3 1003H]
canopen::NodeOptions node_options() {
  canopen::NodeOptions options = q_iqr::node_options();
  options.profile_event_transmission_type = true;
  options.empty_history_reads_zero = false;
  options.errors_end_with_history = true;
  options.history_has_first_byte_high = true;
  options.active_master_commands_itself = true;
  return options;
}

// [RJ71CN91 1.2, 1.8, 1.9, App. 2 G70, G401]
manager::MasterOptions master_options() {
  manager::MasterOptions options = q_iqr::master_options();
  options.revision_rule = manager::RevisionRule::same_major_newer_minor;
  options.slaves_request_nmt = true;
  options.time_out_ends_activity = true;
  options.heartbeat_state_is_checked = true;
  options.delay_before_each_command = true;
  options.resets_slaves_alone = true;
  return options;
}

}  // namespace

constinit const ModuleModel model{
    .data_sheet = &data_sheet,
    .buffer_memory_size = 32768,
    .buffer_memory = buffer_table,
    .function_modes = function_modes_of_g21,
    .request_port = requests_by_signals,
    .signals = signals,
    .leds = leds,
    .emergencies = emergencies,
    .settings =
        [] {
          SettingsLayout layout = q_iqr::settings;
          layout.saves_offline_only = true;
          return layout;
        }(),
    .status = StatusWordsLayout{.communication_status = g::communication_status,
                                .bits = communication_status,
                                .transmit_errors = g::transmit_errors,
                                .receive_errors = g::receive_errors,
                                .active_bit_rate = g::active_baud_rate,
                                .no_bit_rate_offline = true},
    .error_status = ErrorStatusLayout{.status = g::error_status,
                                      .invalid_address = g::setting_error,
                                      .errors = errors,
                                      .bad_words_are_causes = true,
                                      .clears_node_failures = true,
                                      .overflow_lasts = std::chrono::seconds(1)},
    .exchange_control = ExchangeControlLayout{.address = g::data_exchange_control,
                                              .process_data = 1U << 8,
                                              .emergencies = 1U << 12,
                                              .reads_choice = true,
                                              .waits_for_operational = false},
    .emergency_buffer = q_iqr::emergency_buffer,
    .nmt_status =
        [] {
          NmtStatusLayout layout = q_iqr::nmt_status;
          layout.shows_guarding_master = true;
          return layout;
        }(),
    .network_settings = q_iqr::network_settings,
    .time_stamp =
        TimeStampLayout{
            .first = g::time_stamp, .first_year = 2000, .role_with_clock = true, .late_time_is_first = true},
    // [RJ71CN91 1.3, App. 2 CIF, App. 5] How long a frame may wait is not printed.
    .command =
        [] {
          CommandLayout layout = q_iqr::command;
          layout.skips_empty_records = true;
          layout.no_such_node = canopen::AbortCode::command_specifier;
          layout.frame_time_out = std::chrono::seconds(1);
          layout.is_one_memory = true;
          layout.object_not_set = 0x1F22;
          return layout;
        }(),
    .layer2 = layer2_layout,
    // [RJ71CN91 1.11, App. 2 G6000, G10000]
    .layer2_rules = {.rtr_limit_is_error = true,
                     .frame_word_is_configuration = true,
                     .sends_when_online = true,
                     .clears_receive_words = true,
                     .unique_transmit_identifiers = true,
                     .remote_frames_have_no_changes = true,
                     .overflow_is_of_new_data = true,
                     .online_applies_bit_rate = true,
                     .bad_words_keep_offline = true,
                     .offline_is_silent = true,
                     .saves_transmit_slots = true,
                     .rate_of_cycles = g::baud_rate},
    .program_interface = q_iqr::program_interface,
    .diagnostics = {.events = event_table, .errors = error_table},
    .cpu = {.stop_ends_master = true, .stop_at_start_counts = true, .run_ends_error = true},
    .object_dictionary = object_dictionary,
    .node_id_defaults = q_iqr::set_detect_cycle,
    .node_options = node_options,
    .master_options = master_options,
    .configuration_options = q_iqr::configuration_options,
    .takes_parameters = true,
    .watchdog_error_is_shown = true,
};

std::shared_ptr<const canopen::DictionaryDescription> object_dictionary() {
  static const auto description = q_iqr::make_dictionary({.device_name = "RJ71CN91",
                                                          .hardware_version = "01",
                                                          .software_version = "02",
                                                          .vendor = 0x0000'01D0,
                                                          .product = 0x0000'0100,
                                                          .revision = 0x0001'0000});
  return description;
}

}  // namespace canopus::module::rj71cn91
