#pragma once
// Module refresh, as a parameter of the engineering tool sets it up: at the END of each scan the CPU copies blocks of its own
// devices into a module's transmit words, has the module exchange its process data, and copies blocks of the receive words
// into its devices [RJ71CN91 2.2, 2.3]. It goes on in STOP. What the buffer memory held is overwritten each time.

#include <cstdint>
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
    Device device = Device::d;        ///< a bit device: 16 points for each word
    std::uint32_t number = 0;
    bool to_module = false;
  };

  /// Listens to the rack, which must hold the module at `head`; all must outlive it. Nothing is exchanged without a block in
  /// each direction.
  ModuleRefresh(Rack& rack, can::Timeline& timeline, std::uint16_t head, module::CommunicationModule& module,
                can::Timeline::Handle module_handle, std::vector<Block> blocks, const std::string& name);
  ~ModuleRefresh();
  ModuleRefresh(const ModuleRefresh&) = delete;
  ModuleRefresh& operator=(const ModuleRefresh&) = delete;

 private:
  void tick(can::Time now) override;
  [[nodiscard]] can::Time deadline() const noexcept override { return next_; }
  void supply_changed(bool on, can::Time now) override;
  void cpu_changed(module::CpuState, can::Time) override {}
  void scan_ended(can::Time now) override;
  void exchange(can::Time now);
  /// Writes what differs.
  void copy_to_module(const Block& block, can::Time now);

  Rack& rack_;
  can::Timeline& timeline_;
  std::uint16_t head_;
  module::CommunicationModule& module_;
  can::Timeline::Handle module_handle_;
  std::vector<Block> blocks_;
  can::Timeline::Handle handle_;
  bool is_on_ = false;           // there is something to exchange, and supply
  can::Time next_ = can::never;  // of a rack without a scan of its own
};

}  // namespace canopus::plc
