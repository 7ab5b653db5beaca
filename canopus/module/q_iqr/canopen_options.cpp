#include "canopus/module/q_iqr/canopen_options.hpp"

#include <chrono>

#include "canopus/canopen/service/emcy_code.hpp"

namespace canopus::module::q_iqr {

namespace assignment_bit = manager::assignment_bit;
namespace emcy_code = canopen::emcy_code;

canopen::NodeOptions node_options() {
  return {
      .dismiss_events_during_inhibit = true,
      .unsent_values_are_changed = false,
      .send_tpdos_on_start = false,
      .sdo_write_is_event = false,
      .tpdo_rtr_bit_is_constant = true,
      .reserved_bit_30_is_zero = true,
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

manager::MasterOptions master_options() {
  manager::MasterOptions options;
  options.assignment_bits = assignment_bit::slave | assignment_bit::boot_slave | assignment_bit::mandatory |
                            assignment_bit::keep_alive;
  options.block_from = 0;
  return options;
}

manager::ConfigurationOptions configuration_options() {
  return {.maximum_files = 60,
          .maximum_size = 65531,
          .delete_first = true,
          .check_files = false,
          .in_download = canopen::AbortCode::hardware_error,
          .no_room = canopen::AbortCode::cannot_store};
}

void set_detect_cycle(canopen::ObjectDictionary& objects, std::uint8_t node_id) {
  objects.set<std::uint16_t>(0x1F90, 6, static_cast<std::uint16_t>(4000 + 10 * node_id));
}

}  // namespace canopus::module::q_iqr
