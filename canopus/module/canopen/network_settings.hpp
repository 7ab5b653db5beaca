#pragma once
// The words that hold times of the network: they go to the NMT master as they are written
// [ME3CAN1-Q 3.5.12, 3.5.13; FX3U-CAN 6.20, 6.21]. A module without them keeps the master's own.

#include <chrono>
#include <optional>

#include "canopus/manager/nmt/nmt_master.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

struct NetworkSettingsLayout {
  BufferAddress start_all_delay = 0;  ///< ms
  BufferAddress sdo_time_out = 0;     ///< ms
};

class NetworkSettings final : public BufferArea {
 public:
  /// Everything must outlive it.
  NetworkSettings(const std::optional<NetworkSettingsLayout>& layout, BufferMemory& memory,
                  manager::NmtMaster& master)
      : layout_(layout), memory_(&memory), master_(&master) {
    if (!layout) return;
    memory.attach(layout->start_all_delay, layout->start_all_delay, *this);
    memory.attach(layout->sdo_time_out, layout->sdo_time_out, *this);
  }

  /// Applies the words as they are now: when others than the program have changed them.
  void apply() {
    if (!layout_) return;
    manager::MasterOptions& options = master_->options();
    options.start_all_delay = std::chrono::milliseconds(memory_->word(layout_->start_all_delay));
    options.sdo_time_out = std::chrono::milliseconds(memory_->word(layout_->sdo_time_out));
  }
  [[nodiscard]] can::Duration sdo_time_out() const { return master_->options().sdo_time_out; }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time) const override {
    return memory_->word(address);
  }
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override {
    memory_->store(address, value);
    apply();
    master_->options_changed(now);
    return WriteResult::done;
  }

 private:
  std::optional<NetworkSettingsLayout> layout_;
  BufferMemory* memory_;
  manager::NmtMaster* master_;
};

}  // namespace canopus::module
