#pragma once
// The function of a simulated device beside its communication and its generated values: a drive, the door of
// a lift. It reads the effective values of its objects, and puts its own values beneath those that are
// forced.

#include <cstdint>

#include "canopus/can/alarm.hpp"
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
  /// Before a frame is served, after everything that happens to the device, and when its alarm is due: reads the
  /// objects and writes what follows from them (Device::put). A second call at the same moment changes
  /// nothing. Returns true when an effective value changed.
  virtual bool act(Device& device, can::Time now) = 0;
  /// When it has something to do by itself. It sets it whenever that changes, also outside of the calls above. Without effect while the
  /// device is off.
  [[nodiscard]] virtual can::Alarm& alarm() noexcept = 0;
};

}  // namespace canopus::sim
