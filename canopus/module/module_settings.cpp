#include "canopus/module/module_settings.hpp"

#include <algorithm>

#include "canopus/canopen/data_type.hpp"
#include "canopus/module/stored_settings.hpp"

namespace canopus::module {

namespace {

using State = NonVolatileMemory::Content::State;

// There while a save runs: found at a start, the supply went off in the middle of one.
constexpr std::string_view saving_name = "saving";

}  // namespace

ModuleSettings::ModuleSettings(const ModuleModel& model, NonVolatileMemory& memory, BufferMemory& buffer)
    : model_(&model),
      memory_(&memory),
      buffer_(&buffer),
      flash_(memory, {words_name, objects_name, concise_dcfs_name}) {}

const FunctionModeRow& ModuleSettings::preset_mode() const {
  const auto word = shelf_words_.find(model_->words.function_mode);
  if (word == shelf_words_.end()) return model_->function_modes.front();
  return *std::ranges::find(model_->function_modes, word->second, &FunctionModeRow::value);
}

bool ModuleSettings::preset_word(BufferAddress address, std::uint16_t value) {
  const bool is_stored = std::ranges::any_of(model_->buffer_memory, [&](const BufferRow& row) {
    return row.stored == Stored::yes && row.covers(address);
  });
  if (!is_stored) return false;
  // Until the function mode is known, of any mode.
  const bool any =
      address == model_->words.function_mode || !shelf_words_.contains(model_->words.function_mode);
  if (buffer_->check(address, value, any ? every_mode : preset_mode().bit) != WriteResult::done) return false;
  shelf_words_[address] = value;
  return true;
}

bool ModuleSettings::takes_word(BufferAddress address, std::uint16_t value) const {
  return buffer_->check(address, value, preset_mode().bit) == WriteResult::done;
}

std::optional<BufferAddress> ModuleSettings::layer2_preset_error(const Layer2Rules& rules) const {
  const FunctionModeRow& mode = preset_mode();
  if (mode.kind == FunctionModeRow::Kind::canopen) return std::nullopt;
  BufferMemory words(model_->buffer_memory);
  words.select_mode(mode.bit);
  words.apply_stored(shelf_words_);
  Layer2Settings settings(model_->layer2, rules, words);
  settings.select(mode.kind == FunctionModeRow::Kind::layer2_extended);
  return settings.first_error();
}

canopen::AbortCode ModuleSettings::preset_object(std::uint16_t index, std::uint8_t sub,
                                                 std::span<const std::uint8_t> value) {
  // A dictionary of its own, without the services' handlers: the order of the presets must not matter.
  canopen::ObjectDictionary scratch(model_->object_dictionary(), 127);
  const auto entry = scratch.find(index, sub);
  if (!entry) return entry.error();
  if (const auto code = scratch.write(index, sub, value, {}); code != canopen::AbortCode::none) return code;
  if (!entry->description->stored) return canopen::AbortCode::cannot_store;
  const manager::MasterOptions rules = model_->master_options();
  const bool bad_role = index == 0x1F80 && (scratch.get<std::uint32_t>(index, 0) & ~rules.start_up_bits) != 0;
  const bool bad_assignment = index == 0x1F81 && (value[0] & ~rules.assignment_bits) != 0;
  if (bad_role || bad_assignment) return canopen::AbortCode::invalid_value;
  shelf_objects_[{index, sub}] = {value.begin(), value.end()};
  return canopen::AbortCode::none;
}

const FunctionModeRow& ModuleSettings::load() {
  error_ = false;
  flash_.load();
  told_writes_ = flash_.writes();
  if (memory_->read(saving_name).state != State::missing) {
    error_ = true;
    memory_->erase(saving_name);
  }
  words_.clear();
  const NonVolatileMemory::Content content = flash_.read(words_name);
  if (content.state == State::missing) {
    words_ = shelf_words_;
  } else if (auto words = content.state == State::good ? decode_words(content.bytes) : std::nullopt) {
    words_ = std::move(*words);
  } else {
    error_ = true;
  }
  const FunctionModeRow* mode = use_words();
  if (mode == nullptr) {  // answered with the factory's defaults, all of them
    error_ = true;
    words_.clear();
    mode = use_words();
  }
  const bool deletes = mode->kind != FunctionModeRow::Kind::canopen && model_->layer2_deletes_objects;
  if (deletes && flash_.read(objects_name).state != State::missing) flash_.write(objects_name, {});
  return *mode;
}

// Selects the function mode and puts the words in. nullptr when they are not all what a module can have
// stored.
const FunctionModeRow* ModuleSettings::use_words() {
  const auto word = words_.find(model_->words.function_mode);
  auto mode = model_->function_modes.begin();
  if (word != words_.end()) {
    const auto stored = std::ranges::find(model_->function_modes, word->second, &FunctionModeRow::value);
    if (stored != model_->function_modes.end()) mode = stored;
  }
  buffer_->select_mode(mode->bit);
  return buffer_->apply_stored(words_) ? &*mode : nullptr;
}

std::optional<canopen::Entry> ModuleSettings::faulty_mapping(std::uint8_t node_id) {
  const NonVolatileMemory::Content content = flash_.read(objects_name);
  if (content.state != State::good) return std::nullopt;
  canopen::ObjectDictionary scratch(model_->object_dictionary(), node_id);
  if (!apply_objects(content.bytes, scratch)) return std::nullopt;  // damaged, not faulty: the defaults hold
  return first_faulty_mapping(scratch);
}

void ModuleSettings::load_objects(canopen::ObjectDictionary& objects) {
  const NonVolatileMemory::Content content = flash_.read(objects_name);
  switch (content.state) {
    case State::missing:
      for (const auto& [place, value] : shelf_objects_) {
        objects.assign(objects.description().find(place.first, place.second), value);
      }
      break;
    case State::good:
      if (!apply_objects(content.bytes, objects)) error_ = true;
      break;
    case State::damaged: error_ = true; break;
  }
}

void ModuleSettings::begin_save(std::uint16_t request) {
  request_ = request & (model_->save_restore.save | model_->save_restore.restore);
  if ((request_ & model_->save_restore.save) != 0) memory_->write(saving_name, {});
}

bool ModuleSettings::end_save() {
  if (restores()) buffer_->restore_initial();
  if ((request_ & model_->save_restore.save) == 0) return true;
  if (restores()) words_.clear();  // of all modes
  buffer_->collect_stored(words_);
  const bool written = flash_.write(words_name, encode_words(words_));
  memory_->erase(saving_name);
  if (!written) error_ = true;
  return written;
}

bool ModuleSettings::has_worn_out() noexcept {
  const std::uint32_t lasts = model_->data_sheet->flash_writes;
  const bool worn_before = told_writes_ > lasts;
  told_writes_ = flash_.writes();
  return told_writes_ > lasts && !worn_before;
}

bool ModuleSettings::store_objects(const canopen::ObjectDictionary& objects) {
  return flash_.write(objects_name, encode_objects(objects));
}

// Restored settings are factory defaults, not those of the shelf: an empty content, not a missing one.
bool ModuleSettings::restore_objects() { return flash_.write(objects_name, {}); }

}  // namespace canopus::module
