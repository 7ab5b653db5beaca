#pragma once
// Finds one device by its LSS address at any bit rate, and assigns a node-ID and this network's bit rate [CiA
// 305; ME3CAN1-Q 4.8.11, notes B11]:
//
//   40H-43H at the own rate - no answer: at the next one ... - 44H: 11H node-ID, 13H bit rate, 17H store,
//   15H activate (if the rate differs) - own rate again - 04H waiting state: the device goes on by itself
//
// While it runs at other rates, the own node is off its network; nodes of that network may go bus-off.

#include <algorithm>
#include <cstdint>

#include "canopus/lss/lss_master.hpp"

namespace canopus::lss {

class LssSearchListener {
 public:
  /// Requests a restart of the own controller with this bit rate (bit/s).
  virtual void change_bit_rate(std::uint32_t bit_rate, can::Time now) = 0;
  /// The own rate is in force again. `found`: the device has its node-ID.
  virtual void lss_search_finished(std::uint8_t node_id, bool found, can::Time now) = 0;

 protected:
  ~LssSearchListener() = default;
};

class LssSearch final : private LssMasterListener {
 public:
  struct Options {
    /// Silence before and after a device changes its bit rate.
    std::chrono::milliseconds activation_delay{100};
    /// Pause after a change of the own bit rate, before the first frame.
    can::Duration settle_time = std::chrono::milliseconds(10);
    can::Duration time_out = std::chrono::milliseconds(100);  ///< for each answer
    /// Before each selection all devices are switched to waiting state (04H): one that another master, or a lost frame, left
    /// in configuration state ignores a selection.
    bool to_waiting_first = false;
  };

  LssSearch(can::Sink& sink, LssSearchListener& listener) : LssSearch(sink, listener, Options{}) {}
  LssSearch(can::Sink& sink, LssSearchListener& listener, Options options)
      : listener_(&listener), options_(options), master_(sink, *this, {.time_out = options.time_out}) {
    alarm_.add_part(deadline_);
    alarm_.add_part(master_.alarm());
  }

  /// False while running(). `own_bit_rate` must be one of table 0, or 100 kbit/s, which had index 5 before
  /// that was reserved: it is tried; a device without it refuses it.
  bool start(std::uint8_t node_id, const LssAddress& address, std::uint32_t own_bit_rate, can::Time now);
  /// Ends without a report; the controller may be left at another bit rate.
  void cancel() noexcept;
  [[nodiscard]] bool running() const noexcept { return state_ != State::idle; }
  /// The bit rate that is being tried, bit/s.
  [[nodiscard]] std::uint32_t bit_rate() const noexcept { return bit_rate_; }

  /// For each answer, from the next question on.
  void set_time_out(can::Duration time_out) noexcept { master_.set_time_out(time_out); }

  void receive(const can::Frame& frame, can::Time now) { master_.receive(frame, now); }
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return alarm_.deadline(); }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  enum class State : std::uint8_t {
    idle,
    settling,   ///< the bit rate was changed
    preparing,  ///< all to waiting state
    selecting,
    setting_node_id,
    setting_bit_rate,
    storing,
    activating,     ///< 15H was sent
    before_change,  ///< the device is silent, then both change
    after_change,
    leaving,  ///< back to waiting state
    left,     ///< the last frame at another rate goes out
  };

  void lss_finished(LssMaster& master, LssResult result, can::Time now) override;
  void select(can::Time now);
  void try_rate(std::uint32_t bit_rate, can::Time now);
  void try_next_rate(can::Time now);
  void leave(bool found, can::Time now);
  void wait(State state, can::Duration duration, can::Time now);
  void end(bool found, can::Time now);

  LssSearchListener* listener_;
  Options options_;
  LssMaster master_;
  State state_ = State::idle;
  LssAddress address_;
  std::uint8_t node_id_ = 0;
  std::uint32_t own_bit_rate_ = 0;
  std::uint32_t bit_rate_ = 0;
  unsigned next_index_ = 0;
  bool found_ = false;
  can::Alarm alarm_;  // with the master's
  can::Alarm deadline_;
};

}  // namespace canopus::lss
