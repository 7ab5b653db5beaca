#pragma once
// A simulated slave: behaves as the CANopen device its EDS or DCF describes, and moves the values that it has
// to move.

#include <algorithm>
#include <array>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/eds/device_file.hpp"
#include "canopus/sim/device/application.hpp"
#include "canopus/sim/device/behaviour.hpp"
#include "canopus/sim/device/device_lss.hpp"
#include "canopus/sim/device/forcing.hpp"
#include "canopus/sim/device/playback.hpp"
#include "canopus/sim/device/script.hpp"

namespace canopus::sim {

struct DeviceOptions {
  /// Moving values change at multiples of this, from when the device became Operational on. Between them, and as
  /// long as no value can change, nothing is done.
  can::Duration sample_interval = std::chrono::milliseconds(10);
  canopen::NodeOptions node{};
};

/// Callbacks when values are forced and released.
class ForceListener {
 public:
  virtual void value_forced(const Forcing::Force&, can::Time) {}
  virtual void value_released(const canopen::Entry&, can::Time) {}

 protected:
  ~ForceListener() = default;
};

class alignas(64) Device final : public can::Participant, private canopen::NodeListener {
 public:
  /// Off until power_on(). `sink` must outlive the device. node_id 1..127, or FFH: none until an LSS master
  /// gives it one.
  Device(std::shared_ptr<const eds::DeviceFile> file, std::uint8_t node_id, can::Sink& sink,
         DeviceOptions options = {});

  /// Generates the values of an object from now on. Returns an error message for the plant file's author
  /// instead: no such object, a string, high below low, a period of 0, an echo of another type.
  [[nodiscard]] std::optional<std::string> add_behaviour(const Behaviour& behaviour);

  /// Plays these values from now on. Returns what is wrong instead: an object that moves already, or is no
  /// process value.
  [[nodiscard]] std::optional<std::string> add_playback(Playback playback);
  /// Call it before power_on(); the entries are those of process_value().
  void add_script_step(const ScriptStep& step) {
    if (script_.empty()) alarm().add_part(script_.alarm());
    script_.add(step);
    update_fast_path();
  }

  /// Adds an application. Call it once, before add_behaviour() and add_playback(), which refuse the objects
  /// that it owns, and before power_on().
  void set_application(std::unique_ptr<DeviceApplication> application) noexcept {
    application_ = std::move(application);
    update_fast_path();
  }
  /// Writes a value of the application, a bit pattern as wide as the entry; beneath, while the entry is
  /// forced. True when the effective value changed.
  bool put(const canopen::Entry& entry, std::uint64_t value) { return forcing_.put(entry, value); }

  /// A number from 2000H on, which may be forced and played back; or an error message.
  [[nodiscard]] std::expected<canopen::Entry, std::string> process_value(std::uint16_t index,
                                                                         std::uint8_t sub) const;
  /// Forces an entry of process_value() to this value (bit pattern, as wide as the entry) over writes of the
  /// device, RPDOs and SDOs until it is released: at `until`, or never by itself. It outlives resets and
  /// power_off().
  void force(const canopen::Entry& entry, std::uint64_t value, can::Time until, can::Time now);
  /// False: it was not forced.
  bool release(const canopen::Entry& entry, can::Time now);
  /// In order of index and sub-index.
  [[nodiscard]] std::span<const Forcing::Force> forced() const noexcept { return forcing_.all(); }
  void set_force_listener(ForceListener* listener) noexcept { force_listener_ = listener; }

  /// In place of node().set_listener(), which is the device's own. It gets requests of a reset, unless the device is an LSS
  /// slave, which resets its controller by itself.
  void set_listener(canopen::NodeListener* listener) noexcept { listener_ = listener; }

  /// Makes it an LSS slave, whose LSS address is its 1018H and which can be set to the bit rates that its
  /// file names. Call it once, before power_on(). `controller` is the one that `sink` belongs to; its bit
  /// rate now is the one of the factory settings. `store`: see DeviceLss.
  void enable_lss(can::Controller& controller, canopen::ParameterStore* store = nullptr);
  /// nullptr: it is no LSS slave.
  [[nodiscard]] const lss::LssSlave* lss() const noexcept { return lss_ ? &lss_->slave() : nullptr; }

  void power_on(can::Time now);
  void power_off();

  /// True when it would do something with a frame of this base identifier (see Node::wants).
  [[nodiscard]] bool wants(std::uint32_t base_identifier) const {
    return node_.wants(base_identifier) || (lss_ && base_identifier == lss::from_master);
  }

  /// From outside, values are written by dictionary().write(), as from the bus: it is seen, and moving values move on. What dictionary().set()
  /// puts there stays until the value moves by itself.
  [[nodiscard]] canopen::Node& node() noexcept { return node_; }
  [[nodiscard]] const canopen::Node& node() const noexcept { return node_; }
  [[nodiscard]] const eds::DeviceFile& file() const noexcept { return *file_; }

  /// Sends an emergency, as an error inside the device would. False when the node may not send now.
  bool emergency(std::uint16_t code, std::uint8_t error_register,
                 const std::array<std::uint8_t, 5>& manufacturer, can::Time now);
  /// The error is gone.
  bool emergency_reset(can::Time now);

  void receive(const can::Frame& frame, can::Time now) override;
  void controller_changed(can::Time now) override;
  void tick(can::Time now) override;

 private:
  struct alignas(64) Motion {
    // Members that each sample needs come first.
    canopen::Entry target{};
    // The target's value after its last update, and the time of its next change: no update before, unless
    // another writer changed it.
    std::uint64_t moved_to = 0;
    can::Time next_change{};
    std::uint64_t mask = 0;  // of the target's bytes
    canopen::ValueMask places = 0;
    ValueGenerator generator;
    canopen::Entry source{};  // echo

    [[nodiscard]] bool is_echo() const noexcept {
      return generator.behaviour().kind == Behaviour::Kind::echo;
    }
  };
  // NodeListener
  void reset_requested(canopen::NmtCommand which, can::Time now) override;
  void reset_done(canopen::NmtCommand which, can::Time now) override;
  void rpdo_received(std::uint16_t number, can::Time now) override;
  void object_written(const canopen::Entry& entry, can::Time now) override;

  [[nodiscard]] bool is_passive() const noexcept {
    return !application_ && motions_.empty() && playbacks_.empty() && script_.empty() &&
           forcing_.all().empty();
  }
  void update_fast_path() noexcept;
  [[nodiscard]] static bool same(const canopen::Entry& a, const canopen::Entry& b) noexcept {
    return a.index == b.index && a.sub == b.sub;
  }
  // Updates generated values. True: an effective value changed.
  bool move_values(can::Time now);
  template <bool is_simple>
  canopen::ValueMask sample(can::Time now);
  [[nodiscard]] std::uint64_t value_of(const Motion& motion) const noexcept;
  [[nodiscard]] bool is_moved(const Motion& motion, can::Time now) const noexcept;
  void plan_sample(can::Time now) noexcept;
  [[nodiscard]] can::Time next_change_seen(can::Time now) const noexcept;
  bool echo_values() { return echoes_ && move_echoes(); }
  bool move_echoes();
  bool act(can::Time now) { return application_ && application_->act(*this, now); }
  bool play(can::Time now);
  bool force_value(const canopen::Entry& entry, std::uint64_t value, can::Time until, can::Time now);
  bool release_value(const canopen::Entry& entry, can::Time now);
  bool release_due(can::Time now);
  bool carry_out(const ScriptStep& step, can::Time now);
  bool evaluate_conditions(can::Time now);

  // Its parts (node, LSS slave, application, script, forced values) have alarms of their own. The fast path does without the cache
  // line of next_row_.
  void set_alarm() noexcept { alarm() = has_fast_path_ ? next_sample_ : std::min(next_sample_, next_row_); }
  void settle(can::Time now, bool moved);
  void after_event(can::Time now, canopen::ValueMask moved);

  std::shared_ptr<const eds::DeviceFile> file_;
  canopen::NodeListener* listener_ = nullptr;
  ForceListener* force_listener_ = nullptr;
  can::Time sampled_from_{};         // while it samples: at multiples of the interval after this
  can::Time next_row_ = can::never;  // of the playbacks
  std::unique_ptr<DeviceApplication> application_;
  std::vector<Playback> playbacks_;
  // A device with generated values only needs one cache line for a sample: from the end of the node, where
  // its context and its services are, to where its motions begin and end.
  canopen::Node node_;
  can::Duration sample_interval_;
  can::Time next_sample_ = can::never;
  can::Time next_change_{};     // earliest of the motions, as of the last sample
  bool has_fast_path_ = false;  // it has values to sample, none is forced, and it does nothing else by itself
  bool samples_ = false;        // something else than constants and echoes
  bool is_sampling_ = false;    // Operational, and it samples
  bool echoes_ = false;         // some of them
  bool written_ = false;        // perhaps a generated value, from outside, since the last sample
  bool was_written_ = false;    // perhaps any value, from outside, since TPDOs were checked
  bool is_watched_ = false;     // all writes from outside are detected
  bool is_on_ = false;
  std::vector<Motion> motions_;
  std::unique_ptr<DeviceLss> lss_;
  Forcing forcing_{node_};
  Script script_;
};

}  // namespace canopus::sim
