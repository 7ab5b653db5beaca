#include "canopus/module/memory/process_data_windows.hpp"

namespace canopus::module {

ProcessDataWindows::ProcessDataWindows(std::span<const ProcessDataWindow> windows,
                                       const DataExchangeLayout& layout, BufferMemory& memory)
    : windows_(windows), layout_(layout), memory_(&memory) {
  for (const ProcessDataWindow& window : windows) {
    for (BufferAddress address = window.first; address <= window.last; ++address) {
      behind_.push_back(memory.area(address));
    }
    memory.attach(window.first, window.last, *this);
  }
}

ProcessDataWindows::Place ProcessDataWindows::place(BufferAddress address) const noexcept {
  const ProcessDataWindow* window = windows_.data();
  std::size_t before = 0;
  for (; address > window->last; ++window) before += window->last - window->first + 1U;
  const BufferAddress offset = address - window->first;
  return {.word = window->word + offset,
          .open = (window->modes & memory_->mode()) != 0,
          .behind = behind_[before + offset]};
}

std::uint16_t ProcessDataWindows::read_word(BufferAddress address, can::Time now) const {
  const Place at = place(address);
  if (at.open) return memory_->word(layout_.receive_first + at.word);
  return at.behind != nullptr ? at.behind->read_word(address, now) : memory_->word(address);
}

void ProcessDataWindows::program_reads(BufferAddress address, can::Time now) {
  const Place at = place(address);
  if (!at.open && at.behind != nullptr) at.behind->program_reads(address, now);
}

WriteResult ProcessDataWindows::write_word(BufferAddress address, std::uint16_t value, can::Time now) {
  const Place at = place(address);
  if (!at.open && at.behind != nullptr) return at.behind->write_word(address, value, now);
  if (at.open) {
    memory_->set_word(layout_.transmit_first + at.word, value);
  } else {
    memory_->store(address, value);
  }
  return WriteResult::done;
}

}  // namespace canopus::module
