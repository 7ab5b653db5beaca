#pragma once
// LSS slave [CiA 305]: by which an LSS master sets this device's node-ID and bit rate. Requests come on 7E5H,
// answers go on 7E4H. Two states: waiting, where only switch state, identify and fastscan are obeyed, and
// configuration, where node-ID and bit timing can be set and stored.
//
// A node-ID that was set is pending until the next reset communication; a device without one (FFH) that has a
// valid pending node-ID goes on by itself when it is switched to waiting. A bit rate is pending until it is
// activated: silence, switch over, silence again; or until the next reset communication.

#include <cstdint>

#include "canopus/can/controller.hpp"
#include "canopus/lss/lss.hpp"

namespace canopus::lss {

class LssSlaveListener {
 public:
  /// An unconfigured device got its node-ID, and must initialize itself with it.
  virtual void node_id_assigned(std::uint8_t node_id, can::Time now) = 0;
  /// Can the device run at this bit rate (bit/s)?
  virtual bool supports_bit_rate(std::uint32_t bit_rate) { return bit_rate != 0; }
  /// The bus runs at another rate from now on.
  virtual void change_bit_rate(std::uint32_t /*bit_rate*/, can::Time) {}
  enum class Stored : std::uint8_t { done = 0, not_supported = 1, failed = 2 };
  /// Stores node-ID (FFH: none) and bit rate in non-volatile memory.
  virtual Stored store(std::uint8_t /*node_id*/, std::uint32_t /*bit_rate*/) { return Stored::not_supported; }

 protected:
  ~LssSlaveListener() = default;
};

class LssSlave {
 public:
  enum class State : std::uint8_t { waiting, configuration };

  LssSlave(can::Sink& sink, LssSlaveListener& listener, const LssAddress& address)
      : sink_(&sink), listener_(&listener), address_(address) {}

  /// After power-on or reset communication: the node-ID now in force (FFH: none) and the bit rate.
  void start(std::uint8_t node_id, std::uint32_t bit_rate) noexcept;
  void receive(const can::Frame& frame, can::Time now);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return alarm_.deadline(); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

  [[nodiscard]] State state() const noexcept { return state_; }
  /// The node-ID that is in force after the next reset communication.
  [[nodiscard]] std::uint8_t pending_node_id() const noexcept { return pending_node_id_; }
  /// The bit rate that is in force then, or when it is activated; bit/s.
  [[nodiscard]] std::uint32_t pending_bit_rate() const noexcept { return pending_bit_rate_; }
  /// While the bit rate is being changed the device must not send anything.
  [[nodiscard]] bool silent() const noexcept { return switching_ != Switching::no; }

 private:
  enum class Switching : std::uint8_t { no, before, after };

  void switch_global(std::uint8_t mode, can::Time now);
  void select(const can::Frame& frame);
  void identify(const can::Frame& frame);
  void fastscan(const can::Frame& frame);
  void configure(const can::Frame& frame, can::Time now);
  void answer(std::uint8_t command, std::uint32_t value = 0);

  can::Sink* sink_;
  LssSlaveListener* listener_;
  LssAddress address_;
  State state_ = State::waiting;
  Switching switching_ = Switching::no;
  std::uint8_t node_id_ = lss::unconfigured;
  std::uint8_t pending_node_id_ = lss::unconfigured;
  std::uint32_t bit_rate_ = 0;
  std::uint32_t pending_bit_rate_ = 0;
  std::uint8_t selected_parts_ = 0;    // of 40H..43H, in their order
  std::uint8_t identified_parts_ = 0;  // of 46H..4BH
  std::uint8_t fastscan_part_ = 0;
  can::Duration switch_delay_{};
  can::Alarm alarm_;
};

}  // namespace canopus::lss
