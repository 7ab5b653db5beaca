#pragma once
// The LSS slave of a simulated device [CiA 305]: the settings of an LSS master (node-ID, bit rate), and their
// non-volatile memory.

#include <cstdint>
#include <optional>
#include <vector>

#include "canopus/can/gate.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/lss/lss_slave.hpp"

namespace canopus::sim {

class DeviceLss final : private lss::LssSlaveListener, private canopen::NodeListener {
 public:
  struct Settings {
    std::uint8_t node_id = lss::unconfigured;
    std::uint32_t bit_rate = 0;  ///< bit/s
    friend bool operator==(const Settings&, const Settings&) = default;
  };

  /// The contents of the store, or nothing.
  [[nodiscard]] static std::optional<Settings> stored(canopen::ParameterStore& store);

  /// The node, which is off, must report to listener(). The LSS address is the node's 1018H. The node's
  /// frames go to `controller`, except while the device must be silent; `bit_rates` (bit/s): supported ones,
  /// empty: all; `store`: its non-volatile memory, nullptr: kept for the lifetime of this object. All must
  /// outlive it.
  DeviceLss(canopen::Node& node, can::Controller& controller, Settings factory,
            std::vector<std::uint32_t> bit_rates, canopen::ParameterStore* store);

  /// Node-ID and bit rate are what was stored, or the factory settings; switch the node on next.
  void power_on(can::Time now);
  void power_off() noexcept;

  [[nodiscard]] canopen::NodeListener& listener() noexcept { return *this; }
  [[nodiscard]] const lss::LssSlave& slave() const noexcept { return slave_; }

  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return slave_.deadline(); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return slave_.alarm(); }

 private:
  // LssSlaveListener
  void node_id_assigned(std::uint8_t node_id, can::Time now) override;
  bool supports_bit_rate(std::uint32_t bit_rate) override;
  void change_bit_rate(std::uint32_t bit_rate, can::Time now) override;
  Stored store(std::uint8_t node_id, std::uint32_t bit_rate) override;
  // NodeListener
  void reset_requested(canopen::NmtCommand which, can::Time now) override;
  void reset_done(canopen::NmtCommand which, can::Time now) override;

  canopen::Node& node_;
  can::Controller& controller_;
  can::Gate gate_{controller_};  // between the node and the controller
  std::vector<std::uint32_t> bit_rates_;
  canopen::ParameterStore* store_;
  Settings stored_;
  lss::LssSlave slave_;
  bool is_on_ = false;
};

}  // namespace canopus::sim
