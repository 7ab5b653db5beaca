#pragma once
// What a simulated device is beside its communication and the values that move by themselves: a drive, the door of a
// lift. It sees its objects as everybody does, and puts its own values beneath those that are forced.

#include <cstdint>

#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"

namespace canopus::sim {

class Device;

/// Made for one device, which owns it. It answers at once and allocates nothing once it has started.
class DeviceApplication {
 public:
  virtual ~DeviceApplication() = default;

  /// It alone puts this object: no behaviour and no file may move it.
  [[nodiscard]] virtual bool owns(std::uint16_t /*index*/, std::uint8_t /*sub*/) const noexcept {
    return false;
  }

  /// The supply came, or the node was reset: objects hold their defaults, or what is stored.
  virtual void start(Device& device, can::Time now) = 0;
  /// Before a frame is served, after everything that happens to the device, and at deadline(): looks at the objects and
  /// puts what follows from them (Device::put). Again at the same moment, it changes nothing.
  /// Returns true when somebody sees another value than before.
  virtual bool act(Device& device, can::Time now) = 0;
  /// When it has something to do by itself; can::never without.
  [[nodiscard]] virtual can::Time deadline() const noexcept = 0;
};

}  // namespace canopus::sim
