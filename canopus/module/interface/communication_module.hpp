#pragma once
// A CANopen communication module of any make, as a plant sees it: beside what the PLC does to it (Module),
// its factory settings, what a PLC program needs to work with it, and its state for displays.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopus/canopen/dictionary/abort_code.hpp"
#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/module/interface/led.hpp"
#include "canopus/module/interface/module.hpp"
#include "canopus/module/interface/module_information.hpp"

namespace canopus::canopen {
struct Emergency;
class Node;
}  // namespace canopus::canopen

namespace canopus::module {

struct ModuleErrorRecord;
struct ModuleEventRecord;
struct ProgramInterface;
struct SlaveBootRecord;

class CommunicationModule : public Module {
 public:
  /// Another number after receive(): something that is shown of the module, words, signals or states, may have changed, other than
  /// received process data.
  [[nodiscard]] virtual std::uint64_t change_count() const noexcept = 0;

  // --- factory settings; to be called before power_on()

  /// A setting in place of the factory default, until the module saves its own. Only words that it saves,
  /// checked as a write is; false otherwise.
  virtual bool preset_word(BufferAddress /*address*/, std::uint16_t /*value*/) { return false; }
  /// The bit rate, bit/s, and the node-ID, 1..127, wherever the module keeps them. False: not one of its own.
  virtual bool preset_bit_rate(std::uint32_t bit_rate) = 0;
  virtual bool preset_node_id(std::uint8_t node_id) = 0;
  /// The same for an object that 1010H stores, until 1010H stores for the first time. The answer of a write:
  /// no_object, no_sub_index, length_too_low, invalid_value ..., cannot_store for an object that 1010H does
  /// not store.
  virtual canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                           std::span<const std::uint8_t> value) = 0;
  /// What preset_object() gave an object; empty: nothing, its default counts.
  [[nodiscard]] virtual std::span<const std::uint8_t> object_preset(std::uint16_t /*index*/,
                                                                    std::uint8_t /*sub*/) const {
    return {};
  }
  /// The preset words select a function mode in which it is a CANopen node.
  [[nodiscard]] virtual bool presets_canopen_mode() const { return true; }
  /// In that mode its PDOs can be mapped to the process data words; else they are those of a device profile.
  [[nodiscard]] virtual bool presets_free_pdos() const { return true; }
  /// The first of the preset words that would keep the module from going online in the Layer 2 mode they
  /// select.
  [[nodiscard]] virtual std::optional<BufferAddress> layer2_preset_error() const { return std::nullopt; }
  /// A program may write this value to this word in the preset function mode.
  [[nodiscard]] virtual bool takes_word(BufferAddress /*address*/, std::uint16_t /*value*/) const {
    return false;
  }

  // --- parameters of the engineering tools, of a module that takes them; to be called before power_on()

  /// The tools of its series write parameters for it.
  [[nodiscard]] virtual bool takes_parameters() const noexcept { return false; }
  /// As preset_word() and preset_object(), but over whatever the module saves.
  virtual bool parameter_word(BufferAddress /*address*/, std::uint16_t /*value*/) { return false; }
  virtual canopen::AbortCode parameter_object(std::uint16_t /*index*/, std::uint8_t /*sub*/,
                                              std::span<const std::uint8_t> /*value*/) {
    return canopen::AbortCode::cannot_store;
  }
  /// A concise DCF for a node, which need not be a good one. False: too many, or too long.
  virtual bool parameter_concise_dcf(std::uint8_t /*node_id*/, std::vector<std::uint8_t> /*file*/) {
    return false;
  }
  /// Process data are exchanged by refresh() alone, not by the program's request.
  virtual void use_refresh() {}
  /// The CPU's refresh [RJ71CN91 2.3]: what it has written to the transmit words goes out, what was received comes into the
  /// receive words; nothing outside of Operational.
  virtual void refresh(can::Time /*now*/) {}

  /// The CANopen node that the next power-on makes, of factory settings or of what was saved.
  struct InitialNode {
    std::uint8_t node_id = 0;
    canopen::ObjectDictionary objects;
    bool produces_sync = false;
    std::uint32_t bit_rate = 0;              ///< bit/s
    std::vector<std::uint8_t> configures{};  ///< slaves that it configures when it boots them (1F22H)
  };
  /// Nothing when it makes none, as in a Layer 2 mode. Changes nothing, whatever it finds in the memory. To be
  /// called while the module is off.
  [[nodiscard]] virtual std::optional<InitialNode> initial_node() { return std::nullopt; }

  /// What a PLC program needs.
  [[nodiscard]] virtual const ProgramInterface& program_interface() const noexcept = 0;

  // --- for display

  /// The CANopen node inside: state, node-ID, objects.
  [[nodiscard]] virtual const canopen::Node& node() const noexcept = 0;
  /// The slaves that it boots, or has booted, as the active NMT master, by node-ID. manager::explain() says in
  /// words where a boot is.
  [[nodiscard]] virtual std::vector<SlaveBootRecord> boots() const;
  /// Whether it is in a Layer 2 mode, and online.
  [[nodiscard]] virtual Layer2State layer2_state() const noexcept { return Layer2State::inactive; }
  /// Its events in the CPU's event history, oldest first, and the errors that module diagnostics show now.
  [[nodiscard]] virtual std::vector<ModuleEventRecord> event_history() const;
  [[nodiscard]] virtual std::vector<ModuleErrorRecord> module_errors() const;
  /// What "Clear Error" of the engineering tool does. False: there is an error that it cannot clear.
  virtual bool clear_module_errors() { return true; }
  [[nodiscard]] virtual ModuleInformation information() const { return {}; }
  /// Emergency messages of other nodes that it keeps for the program, oldest first.
  [[nodiscard]] virtual std::vector<canopen::Emergency> emergency_history() const;
  /// The concise DCF that it keeps for a slave (1F22H); empty: none. Valid until the module gets another one.
  [[nodiscard]] virtual std::span<const std::uint8_t> concise_dcf(std::uint8_t /*node_id*/) const {
    return {};
  }
  /// Its LEDs, from the top.
  [[nodiscard]] virtual std::vector<Led> leds(can::Time now) const = 0;
  /// Writes of the flash memory over all runs, as it would wear.
  [[nodiscard]] virtual std::uint32_t flash_writes() const noexcept = 0;
};

}  // namespace canopus::module
