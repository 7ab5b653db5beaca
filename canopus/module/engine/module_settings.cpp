#include "canopus/module/engine/module_settings.hpp"

#include <algorithm>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/dictionary/stored_values.hpp"
#include "canopus/module/storage/stored_settings.hpp"

namespace canopus::module {

namespace {

using State = NonVolatileMemory::Content::State;

// There while a save runs: found at a start, the supply went off in the middle of one.
constexpr std::string_view saving_name = "saving";

constexpr std::uint16_t device_type = 0x1000;

}  // namespace

ModuleSettings::ModuleSettings(const ModuleModel& model, NonVolatileMemory& memory, BufferMemory& buffer)
    : model_(&model),
      memory_(&memory),
      buffer_(&buffer),
      flash_(memory, {words_name, objects_name, concise_dcfs_name}) {}

const FunctionModeRow& ModuleSettings::preset_mode() const {
  const auto& address = model_->settings.function_mode;
  const auto word = address ? factory_words_.find(*address) : factory_words_.end();
  if (word == factory_words_.end()) return model_->function_modes.front();
  return *std::ranges::find(model_->function_modes, word->second, &FunctionModeRow::value);
}

bool ModuleSettings::may_preset(BufferAddress address, std::uint16_t value) const {
  const bool is_stored = std::ranges::any_of(model_->buffer_memory, [&](const BufferRow& row) {
    return row.stored == Stored::yes && row.covers(address);
  });
  if (!is_stored) return false;
  // Until the function mode is known, of any mode.
  const auto& mode_word = model_->settings.function_mode;
  const bool any = mode_word && (address == *mode_word || !factory_words_.contains(*mode_word));
  return buffer_->check(address, value, any ? every_mode : preset_mode().bit) == WriteResult::done;
}

bool ModuleSettings::preset_word(BufferAddress address, std::uint16_t value) {
  if (!may_preset(address, value)) return false;
  factory_words_[address] = value;
  return true;
}

// The function mode is not among what the tools set [RJ71CN91 2.4].
bool ModuleSettings::parameter_word(BufferAddress address, std::uint16_t value) {
  if (address == model_->settings.function_mode || !may_preset(address, value)) return false;
  parameters_.words[address] = value;
  return true;
}

bool ModuleSettings::preset_bit_rate(std::uint32_t bit_rate) {
  if (bit_rate % 1000 != 0 || bit_rate > 1'000'000) return false;
  const auto kbit = static_cast<std::uint16_t>(bit_rate / 1000);
  if (model_->settings.baud_rate) return preset_word(*model_->settings.baud_rate, kbit);
  const auto& rates = model_->data_sheet->bus_lengths;
  if (std::ranges::find(rates, kbit, &BusLength::kbps) == rates.end()) return false;
  factory_bit_rate_ = kbit;
  return true;
}

bool ModuleSettings::preset_node_id(std::uint8_t node_id) {
  if (model_->settings.node_address) return preset_word(*model_->settings.node_address, node_id);
  if (node_id < 1 || node_id > 127) return false;
  factory_node_id_ = node_id;
  return true;
}

std::uint16_t ModuleSettings::bit_rate() const { return bit_rate(*buffer_); }

std::uint16_t ModuleSettings::bit_rate(const BufferMemory& buffer) const {
  if (model_->settings.baud_rate) return buffer.word(*model_->settings.baud_rate);
  return factory_bit_rate_.value_or(model_->factory.bit_rate);
}

std::uint8_t ModuleSettings::node_id() const { return node_id(*buffer_); }

std::uint8_t ModuleSettings::node_id(const BufferMemory& buffer) const {
  if (model_->settings.node_address) {
    return static_cast<std::uint8_t>(buffer.word(*model_->settings.node_address));
  }
  return factory_node_id_.value_or(model_->factory.node_id);
}

bool ModuleSettings::takes_word(BufferAddress address, std::uint16_t value) const {
  return buffer_->check(address, value, preset_mode().bit) == WriteResult::done;
}

std::optional<BufferAddress> ModuleSettings::layer2_preset_error(const Layer2Rules& rules) const {
  const FunctionModeRow& mode = preset_mode();
  if (mode.kind == FunctionModeRow::Kind::canopen) return std::nullopt;
  BufferMemory words(model_->buffer_memory);
  words.select_mode(mode.bit);
  words.apply_stored(factory_words_);
  Layer2Settings settings(*model_->layer2, rules, words);
  settings.select(mode.kind == FunctionModeRow::Kind::layer2_extended);
  return settings.first_error();
}

canopen::AbortCode ModuleSettings::preset_object(std::uint16_t index, std::uint8_t sub,
                                                 std::span<const std::uint8_t> value) {
  const canopen::AbortCode code = check_object(index, sub, value);
  if (code != canopen::AbortCode::none) return code;
  factory_objects_[{index, sub}] = {value.begin(), value.end()};
  images_are_made_ = false;
  return code;
}

canopen::AbortCode ModuleSettings::parameter_object(std::uint16_t index, std::uint8_t sub,
                                                    std::span<const std::uint8_t> value) {
  const canopen::AbortCode code = check_object(index, sub, value);
  if (code != canopen::AbortCode::none) return code;
  parameters_.objects[{index, sub}] = {value.begin(), value.end()};
  images_are_made_ = false;
  return code;
}

canopen::AbortCode ModuleSettings::check_object(std::uint16_t index, std::uint8_t sub,
                                                std::span<const std::uint8_t> value) const {
  // The services' handlers are not called: the order of the presets must not matter.
  const auto description = model_->dictionary_of(preset_mode());
  const canopen::ObjectDescription* object = description->find(index);
  if (object == nullptr) return canopen::AbortCode::no_object;
  const canopen::Entry entry = description->find(*object, sub);
  if (!entry) return canopen::AbortCode::no_sub_index;
  if (const auto code = description->check_write(entry, value); code != canopen::AbortCode::none) return code;
  if (!entry.description->stored) return canopen::AbortCode::cannot_store;
  const manager::MasterOptions rules = model_->master_options();
  const bool bad_role = index == 0x1F80 && sub == 0 && (can::load_u32(value) & ~rules.start_up_bits) != 0;
  const bool bad_assignment = index == 0x1F81 && (value[0] & ~rules.assignment_bits) != 0;
  return bad_role || bad_assignment ? canopen::AbortCode::invalid_value : canopen::AbortCode::none;
}

std::span<const std::uint8_t> ModuleSettings::object_preset(std::uint16_t index, std::uint8_t sub) const {
  const auto preset = factory_objects_.find({index, sub});
  if (preset == factory_objects_.end()) return {};
  return preset->second;
}

bool ModuleSettings::presets_canopen_mode() const {
  return preset_mode().kind == FunctionModeRow::Kind::canopen;
}

const FunctionModeRow& ModuleSettings::load() {
  error_ = false;
  flash_.load();
  known_writes_ = flash_.writes();
  if (memory_->read(saving_name).state != State::missing) {
    error_ = true;
    memory_->erase(saving_name);
  }
  auto words = stored_words();
  const FunctionModeRow* mode = words ? use_words(*words, *buffer_) : nullptr;
  if (mode == nullptr) {  // answered with the factory's defaults, all of them
    error_ = true;
    words.emplace();
    mode = use_words(*words, *buffer_);
  }
  words_ = std::move(*words);
  mode_ = mode;
  if (mode->kind == FunctionModeRow::Kind::canopen) buffer_->apply_stored(parameters_.words);
  const bool is_canopen = mode->kind == FunctionModeRow::Kind::canopen;
  const bool deletes =
      is_canopen ? !are_of(*mode, flash_.read(objects_name).bytes) : model_->layer2_deletes_objects;
  if (deletes && flash_.read(objects_name).state != State::missing) flash_.write(objects_name, {});
  return *mode;
}

std::optional<StoredWords> ModuleSettings::stored_words() {
  const NonVolatileMemory::Content content = flash_.read(words_name);
  if (content.state == State::missing) return factory_words_;
  return content.state == State::good ? decode_words(content.bytes) : std::nullopt;
}

// Selects the function mode and puts the words in. nullptr when they are not all what a module can have
// stored.
const FunctionModeRow* ModuleSettings::use_words(const StoredWords& words, BufferMemory& buffer) const {
  const auto& address = model_->settings.function_mode;
  const auto word = address ? words.find(*address) : words.end();
  auto mode = model_->function_modes.begin();
  if (word != words.end()) {
    const auto stored = std::ranges::find(model_->function_modes, word->second, &FunctionModeRow::value);
    if (stored != model_->function_modes.end()) mode = stored;
  }
  buffer.select_mode(mode->bit);
  return buffer.apply_stored(words) ? &*mode : nullptr;
}

ModuleSettings::Found ModuleSettings::read_flash() {
  BufferMemory buffer(model_->buffer_memory);
  const auto words = stored_words();
  const FunctionModeRow* mode = words ? use_words(*words, buffer) : nullptr;
  if (mode == nullptr) mode = use_words({}, buffer);
  if (mode->kind == FunctionModeRow::Kind::canopen) buffer.apply_stored(parameters_.words);
  return {.mode = mode,
          .node_id = node_id(buffer),
          .bit_rate = bit_rate(buffer),
          .objects = stored_objects().bytes};
}

std::optional<canopen::Entry> ModuleSettings::faulty_mapping(std::uint8_t node_id) {
  const NonVolatileMemory::Content content = flash_.read(objects_name);
  if (content.state != State::good) return std::nullopt;
  canopen::ObjectDictionary scratch(model_->dictionary_of(*mode_), node_id);
  const auto stored = [](const canopen::Entry& entry) { return entry.description->stored; };
  // Damaged is not faulty: the defaults hold.
  if (!canopen::apply_stored_values(content.bytes, stored_length, scratch, stored)) return std::nullopt;
  return first_faulty_mapping(scratch);
}

// Each reset of the node reads them.
void ModuleSettings::make_images() {
  const auto make = [](std::vector<std::uint8_t>& image, const auto& objects) {
    image.clear();
    for (const auto& [place, value] : objects) {
      canopen::append_stored_value(image, stored_length, place.first, place.second, value);
    }
    image.shrink_to_fit();
  };
  make(factory_image_, factory_objects_);
  make(parameter_image_, parameters_.objects);
  images_are_made_ = true;
}

NonVolatileMemory::Content ModuleSettings::stored_objects() {
  NonVolatileMemory::Content content = flash_.read(objects_name);
  if (content.state == State::damaged) content.bytes.clear();
  if (!images_are_made_) make_images();
  const auto append = [&content](const std::vector<std::uint8_t>& image) {
    content.bytes.insert(content.bytes.end(), image.begin(), image.end());
  };
  if (content.state == State::missing) append(factory_image_);
  append(parameter_image_);  // the last one counts
  return content;
}

std::vector<std::uint8_t> ModuleSettings::ObjectStore::load() {
  NonVolatileMemory::Content content = settings_->stored_objects();
  if (content.state == State::damaged) found_damaged();
  return std::move(content.bytes);
}

// Restored settings are factory defaults, not presets: an empty content, not a missing one.
canopen::AbortCode ModuleSettings::ObjectStore::save(std::span<const std::uint8_t> image) {
  std::vector<std::uint8_t> content(image.begin(), image.end());
  settings_->mark(content);
  return settings_->flash_.write(objects_name, content) ? canopen::AbortCode::none
                                                        : canopen::AbortCode::hardware_error;
}

// The objects of a dictionary of its own are recognised by the device type before them; it is no stored object, so no start puts
// it in.
void ModuleSettings::mark(std::vector<std::uint8_t>& objects) const {
  if (mode_ == nullptr || mode_->object_dictionary == nullptr) return;
  const canopen::ObjectDictionary scratch(mode_->object_dictionary(), 127);
  std::vector<std::uint8_t> marked;
  canopen::append_stored_value(marked, stored_length, device_type, 0,
                               scratch.bytes(scratch.description().find(device_type, 0)));
  objects.insert(objects.begin(), marked.begin(), marked.end());
}

bool ModuleSettings::are_of(const FunctionModeRow& mode, std::span<const std::uint8_t> objects) const {
  if (objects.empty()) return true;
  const canopen::ObjectDictionary scratch(model_->dictionary_of(mode), 127);
  canopen::StoredValueReader reader(objects, stored_length);
  const auto first = reader.next();
  if (!first || first->index != device_type) return mode.object_dictionary == nullptr;
  return std::ranges::equal(first->bytes, scratch.bytes(scratch.description().find(device_type, 0)));
}

void ModuleSettings::begin_save(can::Time end) {
  const SettingsLayout& layout = model_->settings;
  request_ = layout.save_restore ? buffer_->written(*layout.save_restore) : std::uint16_t{0};
  if ((request_ & layout.save) != 0) memory_->write(saving_name, {});
  save_end_ = end;
}

bool ModuleSettings::end_save() {
  save_end_ = can::never;
  const SettingsLayout& layout = model_->settings;
  if (restores()) buffer_->restore_initial();
  if (layout.save_restore) buffer_->set_word(*layout.save_restore, 0);
  if ((request_ & layout.save) == 0) return true;
  if (restores()) words_.clear();  // of all modes
  buffer_->collect_stored(words_);
  leave_out_receive_slots();
  const bool written = flash_.write(words_name, encode_words(words_));
  memory_->erase(saving_name);
  if (!written) error_ = true;
  return written;
}

bool ModuleSettings::word_written(BufferAddress address) {
  if (!model_->settings.saves_at_once) return true;
  const BufferRow* row = buffer_->row(address, WordAccess::write);
  if (row == nullptr || row->stored == Stored::no) return true;
  const StoredWords before = words_;
  buffer_->collect_stored(words_);
  if (words_ == before) return true;  // no need to wear the memory
  const bool written = flash_.write(words_name, encode_words(words_));
  if (!written) error_ = true;
  return written;
}

// [RJ71CN91 App. 2 G10000] Words of a slot that does not send are not saved.
void ModuleSettings::leave_out_receive_slots() {
  if (mode_->kind == FunctionModeRow::Kind::canopen || !model_->layer2_rules.saves_transmit_slots) return;
  const Layer2Settings settings(*model_->layer2, model_->layer2_rules, *buffer_);
  for (unsigned slot = 0; slot < layer2_slots; ++slot) {
    if (settings.kind(slot) == SlotKind::transmit) continue;
    const BufferAddress first = settings.block(slot);
    words_.erase(words_.lower_bound(first), words_.lower_bound(first + Layer2Settings::block_words));
  }
}

bool ModuleSettings::has_worn_out() noexcept {
  const std::uint32_t lasts = model_->data_sheet->flash_writes;
  const bool worn_before = known_writes_ > lasts;
  known_writes_ = flash_.writes();
  return lasts != 0 && known_writes_ > lasts && !worn_before;
}

}  // namespace canopus::module
