#pragma once
// What a module keeps beyond power-off, and its factory settings: the words that the PLC has saved, the object
// dictionary as 1010H stored it, the concise DCFs (written by their own store into the same flash memory). A power cut leaves each of them as it was before or after a write; one in the middle of a save is
// noticed at the next start.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "canopus/canopen/dictionary/object_dictionary.hpp"
#include "canopus/canopen/dictionary/parameter_store.hpp"
#include "canopus/module/engine/module_model.hpp"
#include "canopus/module/interface/parameters.hpp"
#include "canopus/module/storage/flash_memory.hpp"

namespace canopus::module {

class ModuleSettings {
 public:
  /// Names of what is stored.
  static constexpr std::string_view words_name = "buffer-memory";
  static constexpr std::string_view objects_name = "object-dictionary";
  static constexpr std::string_view concise_dcfs_name = "concise-dcf";
  static constexpr std::array stored_names{words_name, objects_name, concise_dcfs_name};

  /// Everything must outlive it. `buffer` is the module's, made of the model's table.
  ModuleSettings(const ModuleModel& model, NonVolatileMemory& memory, BufferMemory& buffer);

  // --- factory settings: see CommunicationModule
  bool preset_word(BufferAddress address, std::uint16_t value);
  bool preset_bit_rate(std::uint32_t bit_rate);
  bool preset_node_id(std::uint8_t node_id);
  canopen::AbortCode preset_object(std::uint16_t index, std::uint8_t sub,
                                   std::span<const std::uint8_t> value);
  [[nodiscard]] std::span<const std::uint8_t> object_preset(std::uint16_t index, std::uint8_t sub) const;
  [[nodiscard]] bool presets_canopen_mode() const;
  [[nodiscard]] bool presets_free_pdos() const { return preset_mode().object_dictionary == nullptr; }
  /// The CPU's parameters: words and objects count over what is stored, in the CANopen function mode.
  bool parameter_word(BufferAddress address, std::uint16_t value);
  canopen::AbortCode parameter_object(std::uint16_t index, std::uint8_t sub,
                                      std::span<const std::uint8_t> value);
  [[nodiscard]] ModuleParameters& parameters() noexcept { return parameters_; }
  [[nodiscard]] std::optional<BufferAddress> layer2_preset_error(const Layer2Rules& rules) const;
  [[nodiscard]] bool takes_word(BufferAddress address, std::uint16_t value) const;

  // --- at a start
  /// Selects the stored function mode and puts its stored words into the buffer memory. What is damaged is
  /// answered with the factory's defaults.
  const FunctionModeRow& load();
  /// What load() would select, and the image of the stored objects (canopen/dictionary/stored_values.hpp).
  struct Found {
    const FunctionModeRow* mode = nullptr;
    std::uint8_t node_id = 0;
    std::uint16_t bit_rate = 0;  ///< kbit/s
    std::vector<std::uint8_t> objects{};
  };
  /// Looks at what a start would find, and changes nothing: no mark of an interrupted save is taken away.
  [[nodiscard]] Found read_flash();
  /// The first mapping of the stored object dictionary that the module cannot work with.
  [[nodiscard]] std::optional<canopen::Entry> faulty_mapping(std::uint8_t node_id);

  // --- in force from the next start on
  [[nodiscard]] std::uint16_t bit_rate() const;  ///< kbit/s
  [[nodiscard]] std::uint8_t node_id() const;

  // --- saving
  /// Carries out the save/restore word until `end`; what it finds then is what counts.
  void begin_save(can::Time end);
  /// When end_save() is due; never: nothing is being saved or restored.
  [[nodiscard]] can::Time save_deadline() const noexcept { return save_end_; }
  [[nodiscard]] can::Alarm& alarm() noexcept { return save_end_; }
  /// The supply went off, or a start began.
  void cancel_save() noexcept { save_end_ = can::never; }
  /// False when the flash memory could not be written.
  bool end_save();
  /// The program has written this word: where that saves it, it is saved. False as above.
  bool word_written(BufferAddress address);
  /// The request that is being carried out, or was last, restores.
  [[nodiscard]] bool restores() const noexcept { return (request_ & model_->settings.restore) != 0; }
  /// The request saves.
  [[nodiscard]] bool saves() const noexcept { return (request_ & model_->settings.save) != 0; }
  /// Where the node's 1010H and 1011H keep what is stored of the object dictionary.
  [[nodiscard]] canopen::ParameterStore& object_store() noexcept { return object_store_; }

  [[nodiscard]] FlashMemory& flash() noexcept { return flash_; }
  [[nodiscard]] const FlashMemory& flash() const noexcept { return flash_; }
  /// Since the last call the flash memory was written for the first time more often than the real one lasts.
  bool wore_out() noexcept { return known_writes_ != flash_.writes() && has_worn_out(); }
  /// Something stored was damaged, or could not be written.
  [[nodiscard]] bool error() const noexcept { return error_; }
  void note_error() noexcept { error_ = true; }

 private:
  class ObjectStore final : public canopen::ParameterStore {
   public:
    explicit ObjectStore(ModuleSettings& settings) : settings_(&settings) {}
    [[nodiscard]] std::vector<std::uint8_t> load() override;
    canopen::AbortCode save(std::span<const std::uint8_t> image) override;
    void found_damaged() override { settings_->note_error(); }

   private:
    ModuleSettings* settings_;
  };

  /// Whether the word or object can be set before a start.
  bool may_preset(BufferAddress address, std::uint16_t value) const;
  canopen::AbortCode check_object(std::uint16_t index, std::uint8_t sub,
                                  std::span<const std::uint8_t> value) const;
  bool has_worn_out() noexcept;
  /// Says of which dictionary stored objects are, where a mode has its own.
  void mark(std::vector<std::uint8_t>& objects) const;
  [[nodiscard]] bool are_of(const FunctionModeRow& mode, std::span<const std::uint8_t> objects) const;
  void leave_out_receive_slots();
  const FunctionModeRow& preset_mode() const;
  /// The stored words of all modes; nothing when they are damaged.
  [[nodiscard]] std::optional<StoredWords> stored_words();
  /// The stored objects, or the factory's.
  [[nodiscard]] NonVolatileMemory::Content stored_objects();
  void make_images();
  const FunctionModeRow* use_words(const StoredWords& words, BufferMemory& buffer) const;
  [[nodiscard]] std::uint8_t node_id(const BufferMemory& buffer) const;
  [[nodiscard]] std::uint16_t bit_rate(const BufferMemory& buffer) const;

  const ModuleModel* model_;
  NonVolatileMemory* memory_;
  BufferMemory* buffer_;
  FlashMemory flash_;  // the settings; the mark of a running save is in memory_ itself
  ObjectStore object_store_{*this};
  StoredWords factory_words_;
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::vector<std::uint8_t>> factory_objects_;
  ModuleParameters parameters_;
  std::vector<std::uint8_t> factory_image_;  // of the objects of both, as they are stored
  std::vector<std::uint8_t> parameter_image_;
  bool images_are_made_ = false;
  StoredWords words_;                      // as stored, of all function modes
  const FunctionModeRow* mode_ = nullptr;  // in use, from the first load() on
  std::uint32_t known_writes_ = 0;         // when wore_out() looked last
  std::optional<std::uint16_t> factory_bit_rate_;
  std::optional<std::uint8_t> factory_node_id_;
  std::uint16_t request_ = 0;
  can::Alarm save_end_;
  bool error_ = false;
};

}  // namespace canopus::module
