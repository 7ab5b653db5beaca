#include <array>

#include "canopus/canopen/service/emcy_code.hpp"
#include "canopus/module/models/fx2n_32can/buffer_table.hpp"
#include "canopus/module/models/fx2n_32can/data_sheet.hpp"
#include "canopus/module/models/fx2n_32can/fx2n_32can.hpp"

namespace canopus::module::fx2n_32can {

namespace {

// clang-format off
/// There is no other.
constexpr std::array mode_rows = std::to_array<FunctionModeRow>({
    {405, every_mode, FunctionModeRow::Kind::canopen},
});

/// [FX2N-32CAN 4.2.2, 4.2.4, 6]
constexpr std::array request_words = std::to_array<RequestWordRow>({
    {  20, RequestUse::data_exchange, 1U << 0},
    {  25, RequestUse::restart,       1U << 0},
    {1000, RequestUse::command},
});

/// Bits of BFM #29 [FX2N-32CAN 4.2.7].
constexpr std::array error_rows = std::to_array<ErrorRow>({
    // error                          bit  latched  makes bit 0
    {ModuleError::power_supply,         2, true,    true},
    {ModuleError::bus_off,              3, false,   true},
    {ModuleError::flash,                4, false,   true},
    {ModuleError::access_watchdog,      7, false,   false},
    {ModuleError::queue_overflow,       8, true,    false},
    {ModuleError::command_overflow,     9, true,    false},
    {ModuleError::node_failure,        10, false,   false},
    {ModuleError::baud_rate_change,    11, false,   false},
    {ModuleError::node_address_change, 12, false,   false},
    {ModuleError::emergency,           13, false,   false},
    {ModuleError::error_passive,       14, true,    false},
});
constexpr std::array word_errors = std::to_array<WordErrorRow>({
    {24, ModuleError::baud_rate_change,    false},
    {27, ModuleError::node_address_change, false},
});

/// Every word [FX2N-32CAN 4.2.5].
constexpr std::array watched_words = std::to_array<WatchedWords>({
    {0, 32767},
});

/// [FX2N-32CAN 6 to 9] The manual prints no result of 000AH and 000CH: the FX3U-CAN's.
constexpr std::array commands = std::to_array<CommandRow>({
    // code   what it does                    modes       success  failed
    {0x0002, CommandKind::sdo_write,         every_mode, 0x0003,  0x000F},
    {0x0004, CommandKind::sdo_read,          every_mode, 0x0005,  0x000F},
    {0x000A, CommandKind::emergency_bytes,   every_mode, 0x000B,  0x000F},
    {0x000C, CommandKind::plain_frame,       every_mode, 0x000D,  0x000F},
    {0x8100, CommandKind::request_pdos,      every_mode, 0x8101,  0x81FF},
    {0x8200, CommandKind::map_pdos,          every_mode, 0x8201,  0x82FF, {}, PdoMapping::mode_a},
    {0x8300, CommandKind::set_up,            every_mode, 0x8301,  0x83FF, SetUpKind::bind_pdos},
    {0x8400, CommandKind::set_up,            every_mode, 0x8401,  0x84FF, SetUpKind::slave_assignment},
    {0x8500, CommandKind::guarding_status,   every_mode, 0x8501,  0x000F},
    {0x8600, CommandKind::clear_guarding,    every_mode, 0x8601,  0x000F},
    {0x8700, CommandKind::read_emergencies,  every_mode, 0x8701,  0x000F},
    {0x8900, CommandKind::map_pdos,          every_mode, 0x8901,  0x000F, {}, PdoMapping::mode_0},
    {0xFFFF, CommandKind::clear,             every_mode, 0x0000,  0x0000},
});

/// [FX2N-32CAN 3.3] ERROR: general, communication and overflow errors.
constexpr std::uint16_t error_led_bits =
    1U << 0 | 1U << 2 | 1U << 3 | 1U << 4 | 1U << 7 | 1U << 8 | 1U << 9 | 1U << 10 | 1U << 14;
constexpr std::array leds = std::to_array<LedRow>({
    {"RUN",     LedUse::operational},
    {"FROM/TO", LedUse::access},
    {"Tx/Rx",   LedUse::interface},
    {"ERROR",   LedUse::error_bits, error_led_bits},
    {"POWER",   LedUse::supply},
});
// clang-format on

/// The manual prints neither code nor bytes: the FX3U-CAN's [FX3U-CAN 6.23].
constexpr EmergencyRows emergencies{
    .access_watchdog = {canopen::emcy_code::user_software, 0x01, {'3', '0', '0', 'X', 'F'}},
};

constexpr std::uint32_t slave = manager::assignment_bit::slave;
constexpr std::uint32_t boot_slave = manager::assignment_bit::boot_slave;

constexpr CommandLayout command{.first = 1000,
                                .commands = commands,
                                .no_such_node = abort_no_channel,
                                .clear_code_stops = true,
                                .set_up = {.assignment_bits = slave | boot_slave,
                                           .marks_skipped_words = true,
                                           .default_mapping_first = true,
                                           .writes_over_cob_ids = true,
                                           .takes_own_cob_ids = true},
                                .data_bytes = 118,
                                .reads_results_only = true,
                                .has_state_classes = false,
                                .silent_node = abort_no_channel,
                                .channel_in_use = canopen::AbortCode::device_state,
                                .too_long_at_last = canopen::AbortCode::cannot_store,
                                .shows_written_length = true};

/// CiA DS-301 V3.0 where later versions differ.
canopen::NodeOptions node_options() {
  constexpr std::uint8_t state_stays = 1;
  return {.unsent_values_are_changed = false,
          .send_tpdos_on_start = false,
          .sdo_write_is_event = false,
          .pdo_identifiers_may_change = true,
          .extended_identifiers = false,
          .predefined_emergency = true,
          .error_behaviour = state_stays,
          .save_before_restored = true};
}

/// CiA DS-302 V2.0 where later versions differ [FX2N-32CAN 8.2.2].
manager::MasterOptions master_options() {
  namespace start_up = manager::start_up_bit;
  manager::MasterOptions options;
  options.start_up_bits = start_up::nmt_master | start_up::start_all_nodes | start_up::wait_for_application |
                          start_up::do_not_start_slaves | start_up::reset_all_nodes;
  options.assignment_bits = slave | boot_slave;
  options.boot_bit_is_for_recovery = true;
  options.toggle_error_is_shown = true;
  options.guarding_is_repeated = true;
  options.block_from = 0;
  return options;
}

/// A response that is missed is repeated; an error it is when the life time is over [FX2N-32CAN 8.2.3].
constexpr std::uint16_t guarding_errors =
    manager::error_control::node_lost | manager::error_control::unexpected_state |
    manager::error_control::life_guarding | manager::error_control::toggle_error;

}  // namespace

constinit const ModuleModel model{
    .data_sheet = &data_sheet,
    .buffer_memory_size = 32768,
    .buffer_memory = buffer_table,
    .function_modes = mode_rows,
    .request_port = requests_by_words,
    .request_words = request_words,
    .leds = leds,
    .emergencies = emergencies,
    .settings = {.baud_rate = 24, .node_address = 27, .saves_at_once = true},
    .status =
        StatusWordsLayout{
            .communication_status = 25,
            .bits = {.online = 1U << 0, .pre_operational_state = 1U << 8, .operational_state = 1U << 9}},
    .error_status =
        ErrorStatusLayout{
            .status = 29, .errors = error_rows, .general_error_bit = 0, .word_errors = word_errors},
    .exchange_control =
        ExchangeControlLayout{.address = 20, .process_data = 1U << 0, .at_once = true, .exchanging = 1U << 0},
    .emergency_buffer = EmergencyBufferLayout{.stack = 11, .ring = 11, .has_words = false},
    .nmt_status = NmtStatusLayout{.failures = guarding_errors},
    .access_watchdog = AccessWatchdogLayout{.time = 26, .words = watched_words, .runs_always = true},
    .command = command,
    .program_interface =
        {.exchange = {.kind = ProgramRequest::Kind::write, .word = 20, .bits = 1U << 0},
         .status = 25,
         .initializing = 1U << 0,
         .initializing_is_0 = true,
         .process_data = exchange_layout,
         .command = {.first = 1000,
                     .sdo_write = 0x0002,
                     .success = 0x0003,
                     .execute = {.kind = ProgramRequest::Kind::write, .word = 1000, .bits = 0x0002}},
         .node_address = 27},
    .cpu = {.is_unknown = true, .watchdog_keeps_state = true, .watchdog_holds_commands = true},
    .object_dictionary = object_dictionary,
    .node_options = node_options,
    .master_options = master_options,
    .mapping_clears_words = false,
};

}  // namespace canopus::module::fx2n_32can
