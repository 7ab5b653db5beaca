#pragma once
// What the manual of one model says, as the engine (module_engine.hpp) reads it: which word, bit, signal,
// command, object or emergency message is which. One constant of this type per model, in the model's folder.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "canopus/canopen/node.hpp"
#include "canopus/manager/master_options.hpp"
#include "canopus/module/buffer_memory.hpp"
#include "canopus/module/command_interface.hpp"
#include "canopus/module/data_sheet.hpp"
#include "canopus/module/error_status.hpp"
#include "canopus/module/layer2_settings.hpp"
#include "canopus/module/led.hpp"
#include "canopus/module/program_interface.hpp"
#include "canopus/module/signals.hpp"
#include "canopus/module/time_stamp.hpp"

namespace canopus::module {

/// A function mode of a module. The first of the list is the one a module leaves the factory with.
struct FunctionModeRow {
  enum class Kind : std::uint8_t { canopen, layer2_base, layer2_extended };
  std::uint16_t value = 0;  ///< of the function mode word
  Modes bit = 0;            ///< in the tables
  Kind kind = Kind::canopen;
};

/// Single words that the engine reads or makes.
struct SystemWords {
  BufferAddress data_exchange_control = 0;
  BufferAddress function_mode = 0;
  BufferAddress save_restore = 0;
  BufferAddress baud_rate = 0;  ///< kbit/s
  BufferAddress communication_status = 0;
  BufferAddress node_address = 0;
  BufferAddress transmit_errors = 0;
  BufferAddress receive_errors = 0;
  BufferAddress active_baud_rate = 0;  ///< 0.1 kbit/s
  BufferAddress start_all_delay = 0;   ///< ms
  BufferAddress sdo_time_out = 0;      ///< ms
  BufferAddress error_clear_node = 0;
  BufferAddress error_control_status = 0;  ///< of node n: + n
  BufferAddress nmt_state = 0;             ///< of node n: + n
  BufferAddress emergencies = 0;
  BufferAddress command = 0;
};

/// Bits of the data exchange control word.
struct DataExchangeBits {
  std::uint16_t process_data = 0;  ///< to be exchanged; neither of the two: everything is
  std::uint16_t emergencies = 0;
  std::uint16_t running = 0;  ///< what it reads while process data wait for their exchange
};

/// Bits of the save/restore word.
struct SaveRestoreBits {
  std::uint16_t save = 0;
  std::uint16_t restore = 0;
};

/// Bits of the communication status word; 0: the model has no such bit.
struct CommunicationStatusBits {
  std::uint16_t operational = 0;
  std::uint16_t warning_level = 0;
  std::uint16_t nmt_reset_seen = 0;  ///< until a 0 is written
  std::uint16_t initialization = 0;
  std::uint16_t pre_operational_state = 0;  ///< of the network state's two
  std::uint16_t operational_state = 0;
  std::uint16_t lss_active = 0;
  std::uint16_t time_seen = 0;  ///< until a 0 is written
  std::uint16_t slave_start_up = 0;
  std::uint16_t nmt_master = 0;
};

/// Bit numbers of the error status word that the engine sets.
struct ErrorBits {
  unsigned hardware = 0;
  unsigned bus_off = 0;
  unsigned flash = 0;
  unsigned queue_overflow = 0;
  unsigned error_passive = 0;
  unsigned message_slot = 0;
};

/// An emergency message that a module sends by itself.
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
};

/// Records of the two parts of the buffer for received emergency messages.
struct EmergencyRecords {
  unsigned stack = 0;
  unsigned ring = 0;
};

/// What an LED shows.
enum class LedUse : std::uint8_t {
  supply,         ///< lit while the module works
  error,          ///< the error signal
  network_state,  ///< NMT state, LSS, Layer 2 online
  traffic,        ///< frames sent or received
  network_error,  ///< bus-off, error control, LSS, error counters
};
struct LedRow {
  std::string_view name{};
  LedUse use = LedUse::supply;
};

struct ModuleModel {
  const DataSheet* data_sheet = nullptr;
  /// What stands before an address in messages: "G".
  std::string_view word_prefix{};
  BufferAddress buffer_memory_size = 0;
  std::span<const BufferRow> buffer_memory{};
  std::span<const FunctionModeRow> function_modes{};
  std::span<const CommandRow> commands{};
  std::span<const SignalRow> signals{};
  std::span<const LedRow> leds{};
  SystemWords words{};
  DataExchangeBits data_exchange{};
  SaveRestoreBits save_restore{};
  CommunicationStatusBits communication_status{};
  ErrorStatusLayout error_status{};
  ErrorBits errors{};
  EmergencyRows emergencies{};
  EmergencyRecords emergency_records{};
  Layer2Layout layer2{};
  Layer2Rules layer2_rules{};
  TimeStampLayout time_stamp{};
  ProgramInterface program_interface{};

  /// In the CANopen function mode.
  std::shared_ptr<const canopen::DictionaryDescription> (*object_dictionary)() = nullptr;
  /// Defaults that depend on the node-ID in a way of their own, after each reset of the dictionary.
  void (*node_id_defaults)(canopen::ObjectDictionary& objects, std::uint8_t node_id) = nullptr;
  canopen::NodeOptions (*node_options)() = nullptr;
  manager::MasterOptions (*master_options)() = nullptr;

  /// A stored PDO mapping that is faulty keeps the module in its initialization [ME3CAN1-Q 8.1.2].
  bool faulty_mapping_keeps_initializing = false;
  /// A start in a Layer 2 mode deletes what 1010H has stored [ME3CAN1-Q 3.5.2].
  bool layer2_deletes_objects = false;
};

}  // namespace canopus::module
