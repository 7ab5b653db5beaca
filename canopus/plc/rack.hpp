#pragma once
// The PLC around the modules: a rack with slots, the CPU's devices (X Y M D W R SM SD ...) and its RUN/STOP
// state. One Rack lives on one event loop; every access is a direct call.

#include <cstdint>
#include <memory>
#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/module/module.hpp"

namespace canopus::plc {

class Rack {
 public:
  explicit Rack(can::Timeline& timeline);

  /// Puts a module at a head I/O number (0, 10H, 20H ... FF0H, in points; a multiple of 16) and adds it to
  /// the timeline. False when the points overlap another module's.
  bool insert(std::uint16_t head_address, module::Module& module, can::Timeline::Handle handle);
  /// The module whose points begin at head_address, or nullptr.
  [[nodiscard]] module::Module* module_at(std::uint16_t head_address) const noexcept;
};

}  // namespace canopus::plc
