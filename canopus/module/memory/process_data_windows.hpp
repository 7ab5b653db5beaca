#pragma once
// Process data words that a program also reaches at other addresses, where one number is two words: FROM reads
// received data, TO writes data to send [FX3U-CAN 6.1, 7.1; FX2N-32CAN 4.1, 4.3]. Where a function mode uses the
// same numbers for something else, that has them.

#include <span>
#include <vector>

#include "canopus/module/interface/program_interface.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

/// Addresses first..last show the process data words word, word + 1 ...
struct ProcessDataWindow {
  BufferAddress first = 0;
  BufferAddress last = 0;
  BufferAddress word = 0;
  Modes modes = every_mode;  ///< function modes with this window
};

class ProcessDataWindows final : public BufferArea {
 public:
  /// Everything must outlive it. Areas that have some of these words in other modes attach before.
  ProcessDataWindows(std::span<const ProcessDataWindow> windows, const DataExchangeLayout& layout,
                     BufferMemory& memory);
  ProcessDataWindows(const ProcessDataWindows&) = delete;
  ProcessDataWindows& operator=(const ProcessDataWindows&) = delete;

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  void program_reads(BufferAddress address, can::Time now) override;
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

 private:
  struct Place {
    BufferAddress word = 0;  // of the process data
    bool open = false;       // the function mode has the window
    BufferArea* behind = nullptr;
  };
  [[nodiscard]] Place place(BufferAddress address) const noexcept;

  std::span<const ProcessDataWindow> windows_;
  DataExchangeLayout layout_;
  BufferMemory* memory_;
  std::vector<BufferArea*> behind_;  // for each word of the windows, in their order; nullptr: a plain word
};

}  // namespace canopus::module
