#pragma once
// The words that show how a module and its CAN controller are: communication status, error counters, bit rate
// [ME3CAN1-Q 3.4.1, 3.5.5, 3.5.8, 3.5.9; FX3U-CAN 6.8, 6.13-6.15]. They are made when they are read.

#include <cstdint>
#include <optional>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/nmt/nmt_master.hpp"
#include "canopus/module/memory/buffer_memory.hpp"
#include "canopus/module/memory/module_state.hpp"

namespace canopus::module {

class Layer2Mode;

/// Bits of the communication status word; 0: the model has no such bit.
struct CommunicationStatusBits {
  std::uint16_t online = 0;  ///< the CANopen node works, in whatever state [FX2N-32CAN 4.2.4]
  std::uint16_t operational = 0;
  std::uint16_t layer2_online = 0;
  std::uint16_t warning_level = 0;
  std::uint16_t nmt_reset_seen = 0;  ///< until a 0 is written
  std::uint16_t initialization = 0;
  std::uint16_t pre_operational_state = 0;  ///< of the network state's two
  std::uint16_t operational_state = 0;
  std::uint16_t lss_active = 0;
  std::uint16_t start_up_failed = 0;        ///< a mandatory slave is not booted: NmtMaster::halted()
  std::uint16_t time_seen = 0;              ///< until a 0 is written
  std::uint16_t optional_slave_failed = 0;  ///< NmtMaster::optional_slave_failed()
  std::uint16_t slave_start_up = 0;
  std::uint16_t nmt_master = 0;
};

/// Addresses of the words; each may be missing.
struct StatusWordsLayout {
  std::optional<BufferAddress> communication_status{};
  CommunicationStatusBits bits{};
  std::optional<BufferAddress> transmit_errors{};
  std::optional<BufferAddress> receive_errors{};
  std::optional<BufferAddress> active_bit_rate{};
  unsigned active_bit_rate_per_kbit = 10;  ///< 10: in 0.1 kbit/s, 1: in kbit/s
  bool no_bit_rate_offline = false;        ///< Layer 2 offline: the bit rate reads 0 [RJ71CN91 App. 2 G37]
};

class StatusWords final : public BufferArea {
 public:
  /// What the words show.
  struct Sources {
    const ModuleState& state;
    const bool& is_resetting;  ///< the node is in an NMT reset
    const can::Controller& controller;
    const canopen::Node& node;
    const manager::NmtMaster& master;
    const Layer2Mode& layer2;
  };
  /// Everything must outlive it, and may be under construction.
  StatusWords(const std::optional<StatusWordsLayout>& layout, BufferMemory& memory, const Sources& sources);

  /// The node has been reset by an NMT command; shown until the program takes note, or the next reset.
  void show_nmt_reset(bool seen) noexcept { nmt_reset_seen_ = seen; }
  /// A TIME object came; shown until the program takes note.
  void show_time() noexcept { time_seen_ = true; }
  /// As from power-on.
  void reset() noexcept { nmt_reset_seen_ = time_seen_ = false; }

  [[nodiscard]] std::uint16_t read_word(BufferAddress address, can::Time now) const override;
  /// Acts on two bits of the communication status only, and only as a 0.
  WriteResult write_word(BufferAddress address, std::uint16_t value, can::Time now) override;

 private:
  [[nodiscard]] unsigned communication_status() const;

  StatusWordsLayout layout_;
  Sources sources_;
  bool nmt_reset_seen_ = false;
  bool time_seen_ = false;
};

/// The error counter from which on a controller is at the warning level [ISO 11898-1].
inline constexpr unsigned warning_counter = 96;
/// The larger of a controller's two error counters.
[[nodiscard]] unsigned error_counter(const can::Controller& controller);

}  // namespace canopus::module
