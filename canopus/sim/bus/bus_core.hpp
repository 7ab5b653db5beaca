#pragma once
// The inside of the bus: its controllers (BusPort) and what they share (BusCore). Only the sources of the bus
// include this.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/bus_statistics.hpp"
#include "canopus/can/fault_confinement.hpp"
#include "canopus/can/frame_bits.hpp"
#include "canopus/can/transmit_queue.hpp"
#include "canopus/sim/bus/bus.hpp"
#include "canopus/sim/bus/controller/bit_controller.hpp"
#include "canopus/sim/bus/faults/fault_plan.hpp"
#include "canopus/sim/bus/wire/acceptance_table.hpp"
#include "canopus/sim/bus/wire/arbiter.hpp"
#include "canopus/sim/bus/wire/wire_observer.hpp"

namespace canopus::sim {

class BusPort;
class LineClocks;
class Segment;

/// When the bus acts next.
class BusSchedule {
 public:
  virtual void deadline_changed() noexcept = 0;

 protected:
  ~BusSchedule() = default;
};

/// What all controllers of a bus share.
struct BusCore {
  BusCore(std::string bus_name, std::uint32_t bus_bit_rate, can::Timeline& bus_timeline,
          BusSchedule& bus_schedule);
  ~BusCore();
  BusCore(const BusCore&) = delete;
  BusCore& operator=(const BusCore&) = delete;

  /// Somebody outside the bus's own tick changed when the bus has to act.
  void deadline_changed() {
    if (!ticking) schedule.deadline_changed();
  }

  /// Hands the errors of this moment to the observers, and then what became of the controllers.
  void report(can::Time now) {
    if (!error_reports.empty() || !controller_reports.empty()) [[unlikely]]
      report_all(now);
  }
  [[gnu::noinline]] void report_all(can::Time now) {
    if (!error_reports.empty()) {
      for (BusObserver* observer : observers) observer->errors_reported(error_reports, now);
      error_reports.clear();
    }
    for (const can::ControllerReport& one : controller_reports) {
      for (BusObserver* observer : observers) observer->controller_changed(one, now);
    }
    controller_reports.clear();
  }
  /// The port's controller has changed, and was in this state before.
  void note_controller(const BusPort& port, can::ErrorState before);

  /// The bus has done what it does at the timeline's now.
  [[nodiscard]] bool has_ticked() const noexcept {
    return !timeline.is_running() || (!ticking && ticked == timeline.now());
  }

  std::string name;
  std::uint32_t bit_rate;
  can::Time created{};
  can::Timeline& timeline;
  BusSchedule& schedule;
  bool ticking = false;
  can::Time ticked = can::never;  // the last tick's moment
  std::vector<std::unique_ptr<BusPort>> ports;
  std::vector<BusObserver*> observers;
  std::vector<WireObserver*> wire_observers;
  std::vector<can::BusErrorReport> error_reports;  // of the present moment
  std::vector<can::ControllerReport> controller_reports;
  can::BusStatistics statistics;
  AcceptanceTable acceptance;
  FaultPlan plan;
  // Some rule was set: what they do to the bus beside its frames has to be looked for.
  bool had_faults = false;
  std::unique_ptr<LineClocks>
      clocks;  // of a line with length; null: levels are seen at once, and clocks are perfect
  std::uint64_t frame_number = 0;  // of frames that were computed as a whole

  /// A frame that a fault keeps in its controller.
  struct Delayed {
    can::Time until;
    BusPort* port;
    can::Frame frame;
  };
  std::vector<Delayed> delayed;  // in the order of send()
};

class alignas(64) BusPort final : public Port {
 public:
  BusPort(BusCore& bus_core, Segment& port_segment, std::uint32_t port_index, std::string port_name);

  bool send(const can::Frame& frame) override;
  /// send() without faults that delay.
  bool enqueue(const can::Frame& frame);
  [[nodiscard]] std::uint16_t transmit_error_counter() const override;
  [[nodiscard]] std::uint16_t receive_error_counter() const override;
  [[nodiscard]] can::ErrorState error_state() const override { return faults.state(); }
  [[nodiscard]] std::uint32_t bit_rate() const override { return rate; }
  void restart(std::uint32_t bit_rate) override;
  [[nodiscard]] std::uint32_t transmit_overflows() const override { return refused; }
  [[nodiscard]] std::uint32_t receive_overflows() const override { return overrun; }
  [[nodiscard]] bool has_room() const override {
    return powered && !listen_only && queue.size() + (sending ? 1 : 0) < queue.capacity();
  }
  void abort_transmissions() override;

  void connect(can::Listener& new_participant) override { participant = &new_participant; }
  void disconnect() override { participant = nullptr; }
  void plug(bool plugged) override;
  [[nodiscard]] bool plugged() const override { return is_plugged; }
  void set_power(bool on) override;
  [[nodiscard]] const std::string& name() const override { return port_name_; }
  void accept(const Acceptance& acceptance) override;
  void set_transmit_queue(TransmitOrder order, std::size_t capacity) override;
  [[nodiscard]] const PortCounters& counters() const override { return counted; }
  [[nodiscard]] std::size_t waiting() const override {
    return queue.size() + (sending && !sends_babble ? 1 : 0);
  }
  void set_listen_only(bool new_listen_only) override;
  void set_automatic_recovery(bool automatic) override;
  void recover() override;

  /// What it offers in arbitration, for Arbiter.
  [[nodiscard, gnu::always_inline]] std::uint64_t offer() const noexcept {
    if (babble_due) [[unlikely]]
      return offer_of_babbler();
    if (queue.empty() || !may_transmit()) return Arbiter::none;
    return Arbiter::key(arbitration(queue.front()), index);
  }
  [[nodiscard]] bool offers() const noexcept { return (!queue.empty() || babble_due) && may_transmit(); }
  [[nodiscard]] bool babble_goes_first() const noexcept {
    return babble_due && (queue.empty() || arbitration(babble) < arbitration(queue.front()));
  }
  [[nodiscard]] bool may_transmit() const noexcept {
    return on_wire && !listen_only && faults.state() != can::ErrorState::bus_off;
  }
  /// On the wire, and not switched off for good.
  [[nodiscard]] bool present() const noexcept {
    return on_wire && (faults.state() != can::ErrorState::bus_off || recovering);
  }
  /// By a fault it does what only bits can tell.
  [[nodiscard]] bool has_bit_fault() const noexcept {
    return mute || inverted || single_shot || overload_frames > 0 || early_bits > 0 ||
           lateness > can::Duration{};
  }
  /// The next waiting frame goes onto the wire.
  void take_next() noexcept {
    sends_babble = babble_goes_first();
    current = sends_babble ? babble : queue.pop();
    babble_due = babble_due && !sends_babble;
    sending = true;
    last_attempt = single_shot;
  }
  /// Keeps what it offers now, which is what it offered when the frame with this number began.
  void snapshot_pending(std::uint64_t frame_number) noexcept {
    kept = {.frame_number = frame_number, .offered = offers()};
    if (!kept.offered) return;
    kept.is_babble = babble_goes_first();
    kept.frame = kept.is_babble ? babble : queue.front();
  }
  /// It is on the wire with what it offered then.
  void restore_pending() noexcept {
    sends_babble = kept.is_babble;
    current = kept.frame;
    sending = true;
    last_attempt = kept.is_aborted || single_shot;
    if (sends_babble) {
      babble_due = false;
    } else if (!kept.is_aborted) {
      queue.remove(current);
    }
  }
  /// What was on the wire has failed or lost and waits again.
  void requeue() noexcept {
    if (sends_babble) {
      babble_due = babbling;
    } else if (!last_attempt) {
      queue.push_back_again(current);
    }
    sending = false;
  }
  /// What was on the wire is complete. False: the participant has not sent it.
  bool complete() noexcept {
    ++counted.transmitted;
    sending = false;
    if (sends_babble) babble_due = babbling && babble_always;
    return !sends_babble;
  }
  void notify_transmitted(const can::Frame& frame, can::Time now) {
    if (participant != nullptr) participant->transmitted(frame, now);
  }
  void hear(const can::Frame& frame, can::Time now) {
    if (jammed) {
      if (held.size() < held_capacity) {
        held.push_back(frame);
      } else {
        ++overrun;
        ++counted.receive_overflows;
      }
      return;
    }
    ++counted.received;
    if (participant != nullptr) participant->receive(frame, now);
  }
  [[nodiscard]] can::Duration bit() const noexcept { return bit_length; }
  /// can::bit_time() at its rate, without a division where a bit has whole nanoseconds.
  [[nodiscard]] can::Duration time_of(std::uint64_t count) const noexcept {
    if (bit_length.count() * rate == 1'000'000'000)
      return bit_length * static_cast<can::Duration::rep>(count);
    return can::bit_time(count, rate);
  }

  // What a frame needs on its way lies in the first three cache lines.
  can::TransmitQueue queue;
  can::Frame current;
  BusCore& core;
  Segment* segment;
  std::uint32_t index;
  can::FaultConfinement faults;  // of a frame computed as a whole, as before it: see Segment::counters_of()
  bool powered = true;
  bool on_wire = true;  // plugged and powered
  bool listen_only = false;
  bool sending = false;  // `current` is on the wire; it counts as waiting
  bool babble_due = false;
  bool sends_babble = false;  // `current` is one
  bool jammed = false;        // by a fault: received frames are held
  // What it offered when a frame of others began that was computed as a whole, if that has changed since.
  struct PendingSnapshot {
    std::uint64_t frame_number = 0;
    bool offered = false;
    bool is_babble = false;
    bool is_aborted = false;
    can::Frame frame{};
  };
  PendingSnapshot kept;
  can::Listener* participant = nullptr;
  can::Duration bit_length;  // at this rate
  std::uint32_t rate;
  PortCounters counted;

  bool last_attempt = false;  // `current` was aborted: it does not wait again
  bool single_shot = false;   // by a fault
  bool babbling = false;
  bool babble_always = false;
  bool is_plugged = true;
  bool automatic_recovery = true;
  bool recovering = false;
  bool confirm = false;  // `current` is complete, its participant has to be notified
  std::uint32_t refused = 0;
  std::uint32_t overrun = 0;

  // Faults at work.
  bool stuck = false;            // dominant
  bool mute = false;             // stuck recessive
  bool inverted = false;         // noise: what it sees
  bool shown_dominant = false;   // as last reported to wire observers
  unsigned overload_frames = 0;  // asked for after each frame
  unsigned early_bits = 0;       // before the bus is idle it may begin a frame
  can::Duration lateness{};      // of what it drives
  std::size_t held_capacity = 0;
  std::vector<can::Frame> held;  // received while jammed
  can::Frame babble;

  Acceptance accepted{.base = {}, .extended = false};  // as in core.acceptance

  // For the segment, while it works bit by bit.
  struct BitPhase {
    can::Time bit_start{};
    can::Time next = can::never;     // sample point or start of the next bit
    bool sampling = false;           // `next` is a sample point
    bool sampled = false;            // dominant at the last sample point
    bool synchronised = false;       // since the last sample point
    bool driving = false;            // dominant
    bool reaching = false;           // what it drives, on the wire
    bool reaching_next = false;      // the same of a late one ...
    can::Time reaches = can::never;  // ... from here on
    void reach(bool dominant) noexcept {
      reaching = dominant;
      reaches = can::never;
    }
    bool flagging = false;     // as last reported to observers
    bool arbitrating = false;  // likewise
    bool received = false;     // complete at the end of this bit
    bool transmitted = false;  // likewise
    bool counted = false;      // `received` or `transmitted` came to this wire from one that reports it
    bool changed = false;      // error state or warning
    can::Time frame_start{};   // of the present or last frame
    unsigned lost_at = WireFrame::Sender::won;  // where it lost arbitration to the frame that it receives now
  };
  BitController bits{faults};
  BitPhase tap;
  BusPort* spokesman = nullptr;  // goes through the bits for this one, see segment_together.cpp

 private:
  bool send_with_faults(const can::Frame& frame);
  [[nodiscard]] std::uint64_t offer_of_babbler() const noexcept;
  void forget_queue();
  void start_anew();
  void be_on_wire();

  std::string port_name_;
};

inline void BusCore::note_controller(const BusPort& port, can::ErrorState before) {
  if (observers.empty()) return;
  controller_reports.push_back({.port = &port,
                                .before = before,
                                .state = port.faults.state(),
                                .warning = port.faults.warning(),
                                .transmit_errors = port.faults.transmit_errors(),
                                .receive_errors = port.faults.receive_errors()});
}

}  // namespace canopus::sim
