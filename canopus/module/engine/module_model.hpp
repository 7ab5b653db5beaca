#pragma once
// What the manual of one model says, as the engine (module_engine.hpp) reads it: which word, bit, signal,
// command, object or emergency message is which. One constant of this type per model, in the model's folder.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/boot/master_options.hpp"
#include "canopus/manager/configuration/configuration_manager.hpp"
#include "canopus/module/canopen/emergency_buffer.hpp"
#include "canopus/module/canopen/network_settings.hpp"
#include "canopus/module/canopen/nmt_status.hpp"
#include "canopus/module/canopen/time_stamp.hpp"
#include "canopus/module/commands/command_interface.hpp"
#include "canopus/module/engine/exchange_control.hpp"
#include "canopus/module/engine/request_port.hpp"
#include "canopus/module/engine/signals.hpp"
#include "canopus/module/engine/status_words.hpp"
#include "canopus/module/engine/word_port.hpp"
#include "canopus/module/interface/data_sheet.hpp"
#include "canopus/module/interface/led.hpp"
#include "canopus/module/interface/program_interface.hpp"
#include "canopus/module/layer2/layer2_settings.hpp"
#include "canopus/module/lift/lift.hpp"
#include "canopus/module/memory/access_watchdog.hpp"
#include "canopus/module/memory/buffer_memory.hpp"
#include "canopus/module/memory/diagnostics.hpp"
#include "canopus/module/memory/error_status.hpp"
#include "canopus/module/memory/module_state.hpp"
#include "canopus/module/memory/process_data_windows.hpp"

namespace canopus::module {

class ModuleEngine;

/// The words of a module's settings, as far as words hold them.
struct SettingsLayout {
  std::optional<BufferAddress> function_mode{};
  std::optional<BufferAddress> baud_rate{};  ///< kbit/s
  std::optional<BufferAddress> node_address{};
  std::optional<BufferAddress> save_restore{};
  std::uint16_t save = 0;     ///< bit of the save/restore word
  std::uint16_t restore = 0;  ///< likewise
  /// Saving and restoring is refused while Layer 2 is online (ModuleError::save_while_online) [RJ71CN91 App. 1 Y1F].
  bool saves_offline_only = false;
  /// The words are saved as they are written, without a request [FX2N-32CAN 4.2.8].
  bool saves_at_once = false;
};

/// Factory settings that no word holds.
struct FactorySettings {
  std::uint16_t bit_rate = 250;  ///< kbit/s
  std::uint8_t node_id = 127;
};

/// An emergency message that a module sends by itself; code 0: it does not.
struct EmergencyRow {
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> manufacturer{};
};
struct EmergencyRows {
  EmergencyRow cpu_error{};    ///< an error stopped the CPU
  EmergencyRow cpu_stopped{};  ///< the CPU went from RUN to STOP
  EmergencyRow restart{};      ///< the module is restarted
  EmergencyRow queue_overflow{};
  EmergencyRow error_passive{};
  EmergencyRow node_lost{};  ///< guarding: code + node-ID
  EmergencyRow access_watchdog{};
};

/// What an LED shows.
enum class LedUse : std::uint8_t {
  supply,         ///< lit while the module works
  error,          ///< the error signal
  network_state,  ///< NMT state, LSS, Layer 2 online
  traffic,        ///< frames sent or received
  network_error,  ///< bus-off, error control, LSS, error counters
  module_error,   ///< the same, and errors of the CPU and of the program [FX3U-CAN 1.2.2]
  access,         ///< the program uses words
  operational,    ///< lit in Operational
  interface,      ///< lit while the CAN controller works and is not bus-off
  error_bits,     ///< lit while some of LedRow::bits of the error status word are 1
};
struct LedRow {
  std::string_view name{};
  LedUse use = LedUse::supply;
  std::uint16_t bits = 0;
};

/// What the CPU's STOP and RUN do beyond the NMT state and its emergency message.
struct CpuRules {
  /// STOP ends the role as NMT master and the master's heartbeat, RUN begins them anew; in STOP they do not begin
  /// [RJ71CN91 App. 4].
  bool stop_ends_master = false;
  /// A start, or an NMT reset, with the CPU in STOP counts as one from RUN to STOP [RJ71CN91 App. 4].
  bool stop_at_start_counts = false;
  /// RUN takes the emergency message of STOP out of 1003H [RJ71CN91 1.7].
  bool run_ends_error = false;
  /// STOP takes Layer 2 offline, after its messages [FX3U-CAN 11].
  bool stop_ends_layer2 = false;
  /// The module does not see whether the CPU runs: a program that has stopped uses no words [FX2N-32CAN 4.2.5].
  bool is_unknown = false;
  /// The access watchdog leaves the NMT state alone, and its emergency message is for Operational [FX2N-32CAN 4.2.7].
  bool watchdog_keeps_state = false;
  /// While the access watchdog has expired no command begins [FX2N-32CAN 6.4.7].
  bool watchdog_holds_commands = false;
};

struct ModuleModel {
  const DataSheet* data_sheet = nullptr;
  /// 0: the module has no buffer memory; its words are registers of the CPU.
  BufferAddress buffer_memory_size = 0;
  std::span<const BufferRow> buffer_memory{};
  /// In the order of their addresses.
  std::span<const ProcessDataWindow> process_data_windows{};
  /// Registers of the CPU that are the module's; their numbers are addresses of `buffer_memory`.
  std::span<const RegisterRange> registers{};
  std::span<const FunctionModeRow> function_modes{};
  /// How a program makes requests: requests_by_signals with `signals`, requests_by_words with `request_words`, or a port of
  /// the model's own. Made once per module.
  std::unique_ptr<RequestPort> (*request_port)(ModuleEngine& engine) = nullptr;
  std::span<const SignalRow> signals{};
  std::span<const RequestWordRow> request_words{};
  std::span<const LedRow> leds{};
  EmergencyRows emergencies{};
  FactorySettings factory{};

  // The areas, as far as the model has them.
  SettingsLayout settings{};
  std::optional<StatusWordsLayout> status{};
  std::optional<ErrorStatusLayout> error_status{};
  std::optional<ExchangeControlLayout> exchange_control{};
  std::optional<EmergencyBufferLayout> emergency_buffer{};
  std::optional<NmtStatusLayout> nmt_status{};
  std::optional<NetworkSettingsLayout> network_settings{};
  std::optional<TimeStampLayout> time_stamp{};
  std::optional<AccessWatchdogLayout> access_watchdog{};
  std::optional<CommandLayout> command{};
  std::optional<LiftLayout> lift{};
  std::optional<Layer2Layout> layer2{};
  Layer2Rules layer2_rules{};
  ProgramInterface program_interface{};
  DiagnosticsTables diagnostics{};

  CpuRules cpu{};

  /// In the CANopen function mode.
  std::shared_ptr<const canopen::DictionaryDescription> (*object_dictionary)() = nullptr;
  [[nodiscard]] std::shared_ptr<const canopen::DictionaryDescription> dictionary_of(
      const FunctionModeRow& mode) const {
    return mode.object_dictionary != nullptr ? mode.object_dictionary() : object_dictionary();
  }
  /// Defaults that depend on the node-ID in a way of their own, at each reset of the dictionary.
  void (*node_id_defaults)(canopen::ObjectDictionary& objects, std::uint8_t node_id) = nullptr;
  canopen::NodeOptions (*node_options)() = nullptr;
  manager::MasterOptions (*master_options)() = nullptr;
  /// Which concise DCFs 1F22H takes, if not any as CiA 302-3 allows; the times are the profile's.
  manager::ConfigurationOptions (*configuration_options)() = nullptr;

  /// A command that sets a PDO mapping mode clears the process data words [FX3U-CAN 7.2].
  bool mapping_clears_words = true;
  /// Engineering tools write parameters for it, which the CPU gives it [RJ71CN91 2.4].
  bool takes_parameters = false;
  /// A stored PDO mapping that is faulty keeps the module in its initialization [ME3CAN1-Q 8.1.2].
  bool faulty_mapping_keeps_initializing = false;
  /// A watchdog error stops the module, which shows it as a hardware error; else nothing of it can be read any more
  /// [RJ71CN91 5.3, 5.5].
  bool watchdog_error_is_shown = false;
  /// "load" at 1011H clears the concise DCFs at once, not at the restart [FX3U-CAN 5.6.12].
  bool restore_clears_files_at_once = false;
  /// A start in a Layer 2 mode deletes what 1010H has stored [ME3CAN1-Q 3.5.2].
  bool layer2_deletes_objects = false;
};

}  // namespace canopus::module
