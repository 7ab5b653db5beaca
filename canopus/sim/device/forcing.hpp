#pragma once
// Values of a device that a person, a test or a script forces. What the device itself, its master or a client
// writes there while they are forced is kept beneath, and is restored when they are released.

#include <cstdint>
#include <span>
#include <vector>

#include "canopus/can/alarm.hpp"
#include "canopus/canopen/node/node.hpp"

namespace canopus::sim {

class Forcing final : public canopen::ObjectHandler {
 public:
  struct Force {
    canopen::Entry entry{};
    std::uint64_t value = 0;    ///< bit pattern, as wide as the entry
    std::uint64_t beneath = 0;  ///< what it would hold
    can::Time until = can::never;
  };

  /// Of the values of this node, which must outlive it.
  explicit Forcing(canopen::Node& node) : node_(node) {}

  /// An entry of fixed length. Again for one that is forced: the new value and end count. True when the
  /// effective value changed.
  bool force(const canopen::Entry& entry, std::uint64_t value, can::Time until);
  /// Restores the value beneath. True when the effective value changed. No effect on an entry that is not
  /// forced.
  bool release(const canopen::Entry& entry);

  /// Writes a value of the device itself. True when the effective value changed.
  bool put(const canopen::Entry& entry, std::uint64_t value);
  /// RPDO `number` (0..511) has put its values into the dictionary.
  void rpdo_received(std::uint16_t number);
  /// The dictionary has other values of 2000H and above: their defaults, or stored ones.
  void values_loaded();

  /// In order of index and sub-index.
  [[nodiscard]] std::span<const Force> all() const noexcept { return forces_; }
  [[nodiscard]] bool is_forced(const canopen::Entry& entry) const noexcept;
  /// When the next one ends by itself.
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  void after_write(canopen::ObjectDictionary& dictionary, const canopen::Entry& entry,
                   can::Time now) override;
  std::vector<Force>::iterator find(const canopen::Entry& entry) noexcept;
  void keep_beneath(Force& force);
  void set_alarm() noexcept;

  [[nodiscard]] canopen::ObjectDictionary& dictionary() noexcept { return node_.dictionary(); }

  canopen::Node& node_;
  std::vector<Force> forces_;
  can::Alarm alarm_;
};

}  // namespace canopus::sim
