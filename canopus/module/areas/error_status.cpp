#include "canopus/module/areas/error_status.hpp"

namespace canopus::module {

ErrorStatus::ErrorStatus(const std::optional<ErrorStatusLayout>& layout, BufferMemory& memory)
    : layout_(layout) {
  if (!layout) return;
  for (const ErrorRow& row : layout->errors) {
    if (row.latched) latched_ = static_cast<Errors>(latched_ | mask(row.error));
    if (row.signal) signal_ = static_cast<Errors>(signal_ | mask(row.error));
  }
  memory.attach(layout->status, layout->status, *this);
  for (const auto& address : {layout->invalid_address, layout->refused_address}) {
    if (address) memory.attach(*address, *address, *this);
  }
}

std::uint16_t ErrorStatus::read_word(BufferAddress address, can::Time) {
  if (address == layout_->invalid_address) return static_cast<std::uint16_t>(invalid_address_);
  if (address == layout_->refused_address) return static_cast<std::uint16_t>(refused_address_);
  return word_;
}

WriteResult ErrorStatus::write_word(BufferAddress, std::uint16_t value, can::Time) {
  Errors cleared = 0;
  for (const ErrorRow& row : layout_->errors) {
    if (row.latched && (value >> row.bit & 1U) == 0) cleared = static_cast<Errors>(cleared | mask(row.error));
  }
  clear(cleared);
  return WriteResult::done;
}

void ErrorStatus::set(Errors errors) noexcept {
  errors_ = errors;
  if (!layout_) return;
  unsigned word = 0;
  for (const ErrorRow& row : layout_->errors) {
    if (has(row.error)) word |= 1U << row.bit;
  }
  if (layout_->general_error_bit && any()) word |= 1U << *layout_->general_error_bit;
  word_ = static_cast<std::uint16_t>(word);
}

void ErrorStatus::clear(Errors errors) noexcept {
  set(static_cast<Errors>(errors_ & ~errors));
  if (!has(ModuleError::invalid_value)) invalid_address_ = 0;
  if (!has(ModuleError::refused_write)) refused_address_ = 0;
}

}  // namespace canopus::module
