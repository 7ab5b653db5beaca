#pragma once
// Module refresh, as a parameter of the engineering tool sets it up: at a moment of the scan the CPU copies blocks of its own
// devices into a module's transmit words, has the module exchange its process data, and copies blocks of the receive words
// into its devices [RJ71CN91 2.2, 2.3]. What the buffer memory held is overwritten each time.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/module/interface/communication_module.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc {

class ModuleRefresh final : private can::Ticker, private RackListener {
 public:
  static constexpr std::uint32_t block_words = 64;

  struct Block {
    module::BufferAddress words = 0;  ///< the first of 64
    std::optional<Device> device{};   ///< a bit device: 16 points for each word; none: a module label
    std::uint32_t number = 0;
    bool to_module = false;
  };

  /// When: at the END of each scan, in STOP, too; or whenever a program of the module's refresh group is executed, in RUN
  /// alone. A program takes no time here, so what comes in before it and what goes out after it are one moment.
  struct Timing {
    bool at_end = true;
    bool each_scan = false;                  ///< the group has a program of the scan execution type
    std::vector<can::Duration> intervals{};  ///< of its programs of the fixed scan execution type
  };

  /// Listens to the rack, which must hold the module at `head`; all must outlive it. The rack joins the timeline before: at an
  /// END its scan comes first. Nothing is exchanged without a block in each direction.
  ModuleRefresh(Rack& rack, can::Timeline& timeline, std::uint16_t head, module::CommunicationModule& module,
                std::vector<Block> blocks, Timing timing, const std::string& name);
  ModuleRefresh(const ModuleRefresh&) = delete;
  ModuleRefresh& operator=(const ModuleRefresh&) = delete;

 private:
  void tick(can::Time now) override;
  void supply_changed(bool on, can::Time now) override;
  void cpu_changed(module::CpuState state, can::Time now) override;
  void cpu_paused(bool paused, can::Time now) override;
  void scan_ended(can::Time now) override;
  void programs_run(bool run, can::Time now);
  /// never: the refresh follows the END of the rack's own scan.
  [[nodiscard]] can::Time next_after(can::Time now) const;
  void exchange(can::Time now);
  /// Writes what differs.
  void copy_to_module(std::size_t block, can::Time now);

  Rack& rack_;
  std::uint16_t head_;
  module::CommunicationModule& module_;
  std::vector<Block> blocks_;
  std::vector<std::array<std::uint16_t, block_words>> labels_;  // of the blocks
  Timing timing_;
  bool exchanges_ = false;  // the supply is on, and there is a block in each direction
  bool programs_run_ = false;
  can::Time run_since_{};  // fixed scan execution counts from here
};

}  // namespace canopus::plc
