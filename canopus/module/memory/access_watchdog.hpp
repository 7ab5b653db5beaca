#pragma once
// FROM/TO watchdog: the program has to use the data words, or any word, again and again. The first access starts it, or the
// module's start; each further one starts it anew; when it expires, that stays until its word is written [FX3U-CAN 6.9;
// FX2N-32CAN 4.2.5].

#include <chrono>
#include <optional>
#include <span>

#include "canopus/can/time.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

/// Data words first..last.
struct WatchedWords {
  BufferAddress first = 0;
  BufferAddress last = 0;
};

struct AccessWatchdogLayout {
  BufferAddress time = 0;  ///< word of its time, in steps of 10 ms; 0: off
  std::span<const WatchedWords> words{};
  /// It runs from the module's start on, in every state of the network [FX2N-32CAN 4.2.5].
  bool runs_always = false;
};

class AccessWatchdog final : public BufferArea {
 public:
  /// Everything must outlive it. Without a layout there is no watchdog.
  AccessWatchdog(const std::optional<AccessWatchdogLayout>& layout, BufferMemory& memory)
      : layout_(layout), memory_(&memory) {
    if (layout) memory.attach(layout->time, layout->time, *this);
  }

  /// The program has used a word. `online`: the network works, the watchdog may run.
  void accessed(BufferAddress address, bool online, can::Time now) {
    if (layout_ && (online || (layout_->runs_always && due_ != can::never)) && is_watched(address))
      start(now);
  }
  /// The module works from now on.
  void module_started(can::Time now) {
    if (layout_ && layout_->runs_always) start(now);
  }
  /// As from power-on.
  void reset() noexcept {
    due_ = can::never;
    expired_ = false;
  }
  /// True when it expires now. Once it has, no access starts it. Offline it ends by itself.
  [[nodiscard]] bool expires(bool online, can::Time now) noexcept {
    if (now < due_) return false;
    due_ = can::never;
    expired_ = online || layout_->runs_always;
    return expired_;
  }
  [[nodiscard]] bool expired() const noexcept { return expired_; }
  [[nodiscard]] can::Alarm& alarm() noexcept { return due_; }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) const override {
    return memory_->word(address);
  }
  /// Ends the error, and starts it anew if it ran or had expired.
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override {
    memory_->store(address, value);
    const bool ran = expired_ || due_ != can::never;
    reset();
    if (ran || layout_->runs_always) start(now);
    return WriteResult::done;
  }

 private:
  [[nodiscard]] bool is_watched(BufferAddress address) const noexcept {
    for (const WatchedWords& words : layout_->words)
      if (address >= words.first && address <= words.last) return true;
    return false;
  }
  void start(can::Time now) {
    const std::uint16_t time = memory_->word(layout_->time);
    due_ = time == 0 || expired_ ? can::never : can::later(now, time * std::chrono::milliseconds(10));
  }

  std::optional<AccessWatchdogLayout> layout_;
  BufferMemory* memory_;
  can::Alarm due_;
  bool expired_ = false;
};

}  // namespace canopus::module
