#include "canopus/module/memory/error_status.hpp"

#include <algorithm>

namespace canopus::module {

ErrorStatus::ErrorStatus(const std::optional<ErrorStatusLayout>& layout, BufferMemory& memory)
    : layout_(layout), memory_(&memory) {
  if (!layout) return;
  for (const ErrorRow& row : layout->errors) {
    if (row.latched) latched_ = static_cast<Errors>(latched_ | mask(row.error));
    if (row.masked) masked_ = static_cast<Errors>(masked_ | mask(row.error));
    if (row.signal) signal_ = static_cast<Errors>(signal_ | mask(row.error));
  }
  memory.attach(layout->status, layout->status, *this);
  for (const auto& address : {layout->invalid_address, layout->refused_address}) {
    if (address) memory.attach(*address, *address, *this);
  }
}

std::uint16_t ErrorStatus::read_word(BufferAddress address, can::Time) const {
  if (address == layout_->invalid_address) return static_cast<std::uint16_t>(invalid_address_);
  if (address == layout_->refused_address) return static_cast<std::uint16_t>(refused_address_);
  return word_;
}

WriteResult ErrorStatus::write_word(BufferAddress, std::uint16_t value, can::Time) {
  Errors cleared = 0;
  for (const ErrorRow& row : layout_->errors) {
    if (row.latched && (value >> row.bit & 1U) == 0) cleared = static_cast<Errors>(cleared | mask(row.error));
  }
  if (layout_->keeps_invalid_value_online && memory_->online())
    cleared = static_cast<Errors>(cleared & ~mask(ModuleError::invalid_value));
  clear(cleared);
  return WriteResult::done;
}

void ErrorStatus::set(Errors errors) noexcept {
  errors_ = errors;
  if (!layout_) return;
  unsigned word = 0;
  for (const ErrorRow& row : layout_->errors) {
    if ((shown() & mask(row.error)) != 0) word |= 1U << row.bit;
  }
  if (layout_->general_error_bit && any()) word |= 1U << *layout_->general_error_bit;
  word_ = static_cast<std::uint16_t>(word);
}

bool ErrorStatus::note_word_error(WriteResult result, BufferAddress address) {
  const auto row = std::ranges::find(layout_->word_errors, address, &WordErrorRow::word);
  if (row == layout_->word_errors.end() || (row->modes & memory_->mode()) == 0) return true;
  if (result != WriteResult::invalid && result != WriteResult::done) return true;
  follow(row->error, result == WriteResult::invalid);
  any_word_error_ = std::ranges::any_of(layout_->word_errors,
                                        [this](const WordErrorRow& other) { return has(other.error); });
  return row->is_invalid_value;
}

void ErrorStatus::note_write(WriteResult result, BufferAddress address) {
  if (layout_ && !note_word_error(result, address)) return;
  if (layout_ && layout_->bad_words_are_causes) {
    const auto known = std::ranges::find(bad_words_, address);
    if (result == WriteResult::invalid && known == bad_words_.end()) bad_words_.push_back(address);
    if (result == WriteResult::done && known != bad_words_.end()) {
      bad_words_.erase(known);
      cause_removed();
    }
  }
  if (hold_clear_) return;
  if (result == WriteResult::invalid) note(ModuleError::invalid_value, invalid_address_, address);
  if (result == WriteResult::refused) note(ModuleError::refused_write, refused_address_, address);
}

// The address is shown until the program clears it, or the next one comes [RJ71CN91 App. 2 G39].
void ErrorStatus::cause_removed() {
  if (!first_cause()) follow(ModuleError::invalid_value, false);
}

std::optional<BufferAddress> ErrorStatus::first_cause() const noexcept {
  if (!bad_words_.empty()) return bad_words_.front();
  return wrong_[0] ? wrong_[0] : wrong_[1];
}

void ErrorStatus::found_wrong(WordGroup group, BufferAddress address) {
  if (layout_ && layout_->bad_words_are_causes) wrong_[index(group)] = address;
  if (!hold_clear_) note(ModuleError::invalid_value, invalid_address_, address);
}

void ErrorStatus::found_good(WordGroup group) {
  if (!is_wrong(group)) return;
  wrong_[index(group)].reset();
  cause_removed();
}

void ErrorStatus::hold_clear(bool held) {
  hold_clear_ = held;
  if (held) return clear();
  set(errors_);
  if (const auto cause = first_cause()) note(ModuleError::invalid_value, invalid_address_, *cause);
}

void ErrorStatus::clear(Errors errors) noexcept {
  set(static_cast<Errors>(errors_ & ~errors));
  if (!has(ModuleError::invalid_value)) invalid_address_ = 0;
  if (!has(ModuleError::refused_write)) refused_address_ = 0;
}

}  // namespace canopus::module
