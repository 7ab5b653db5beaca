#pragma once
// Data exchange as the program requests it: what is to be exchanged, that it runs, and its end. Process data
// wait for Operational; the exchange is reported as done all the same [ME3CAN1-Q 3.3.2, 3.5.1; FX3U-CAN 6.4].
//
//   idle --begin()--> running --its time is over--> done
//                                process data: --Operational--> exchanged

#include <cstdint>
#include <optional>

#include "canopus/canopen/node/node.hpp"
#include "canopus/module/canopen/data_exchange.hpp"
#include "canopus/module/canopen/emergency_buffer.hpp"
#include "canopus/module/layer2/layer2.hpp"
#include "canopus/module/lift/lift.hpp"
#include "canopus/module/memory/buffer_memory.hpp"

namespace canopus::module {

/// The data exchange control word. A choice that names nothing requests process data and EMCYs.
struct ExchangeControlLayout {
  BufferAddress address = 0;
  std::uint16_t process_data = 0;  ///< any of these bits: process data are exchanged
  std::uint16_t emergencies = 0;   ///< any of these bits: received EMCYs are shown
  std::uint16_t inputs = 0;        ///< any of these bits: the next virtual input of a lift is shown, at once
  std::uint16_t running = 0;       ///< what it reads while process data wait for their exchange
  std::uint16_t layer2_running = 0;  ///< what it reads while an exchange of Layer 2 runs
  bool reads_choice = false;         ///< it reads what was written instead [RJ71CN91 App. 2 G20]
  /// Process data wait for Operational; else an exchange outside of it leaves them alone [RJ71CN91 App. 1 Y1].
  bool waits_for_operational = true;
  /// The write itself exchanges; outside of Operational what was written waits, and a later write takes its place
  /// [FX2N-32CAN 4.2.2].
  bool at_once = false;
  /// With `at_once`: what it reads while Operational, and not bus-off.
  std::uint16_t exchanging = 0;
};

class ExchangeControl final : public BufferArea {
 public:
  /// What is exchanged.
  struct Data {
    DataExchange& process_data;
    LiftData& lift;
    EmergencyBuffer& emergencies;
    Layer2& layer2;
    canopen::Node& node;
    const can::Controller& controller;
  };
  /// Everything must outlive it. A module without the control word always exchanges everything.
  ExchangeControl(const std::optional<ExchangeControlLayout>& layout, BufferMemory& memory, const Data& data);

  /// What the program has written goes out as it is now; the exchange takes `duration`, but for one that is done at once.
  void begin(bool canopen_mode, can::Time now, can::Duration duration);
  /// True when the exchange's time has come: it is done.
  [[nodiscard]] bool end_if_due(can::Time now);
  /// The CPU's refresh exchanges process data from now on, the program's request no more [RJ71CN91 2.2].
  void use_refresh() noexcept { by_refresh_ = true; }
  [[nodiscard]] bool by_refresh() const noexcept { return by_refresh_; }
  /// The CPU's refresh: at once, if the node is Operational.
  void refresh(can::Time now);
  /// Exchanges process data that wait, if the node is Operational.
  void exchange_if_operational(can::Time now) {
    if (waiting_ && data_.node.state() == canopen::NmtState::operational) exchange_process_data(now);
  }
  /// As from power-on.
  void reset() noexcept;
  /// Process data run, or wait for Operational; in Layer 2 as far as the word shows it.
  [[nodiscard]] bool running() const noexcept {
    if (layout_ && layout_->at_once) return false;  // nothing has to wait
    return running_ || (layout_ && layout_->layer2_running != 0 && runs_in_layer2());
  }
  [[nodiscard]] can::Alarm& alarm() noexcept { return end_; }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  /// What was chosen is not what is read.
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

 private:
  void latch_transmit_data();
  void exchange_process_data(can::Time now);
  [[nodiscard]] bool runs_in_layer2() const noexcept { return !canopen_mode_ && end_ != can::never; }

  std::optional<ExchangeControlLayout> layout_;
  BufferMemory* memory_;
  Data data_;
  bool canopen_mode_ = false;
  bool by_refresh_ = false;
  bool running_ = false;      // process data, until they are exchanged
  bool waiting_ = false;      // process data, for Operational
  bool emergencies_ = false;  // are shown at the end
  can::Alarm end_;
};

}  // namespace canopus::module
