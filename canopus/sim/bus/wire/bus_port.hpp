#pragma once
// A controller of the simulated bus. Only the sources of the bus include this.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/can/fault_confinement.hpp"
#include "canopus/can/frame_bits.hpp"
#include "canopus/can/transmit_queue.hpp"
#include "canopus/sim/bus/controller/bit_controller.hpp"
#include "canopus/sim/bus/wire/arbiter.hpp"
#include "canopus/sim/bus/wire/bus_core.hpp"
#include "canopus/sim/bus/wire/wire_observer.hpp"

namespace canopus::sim {

class Wire;

class alignas(64) BusPort final : public can::Port {
 public:
  BusPort(BusCore& bus_core, Wire& port_wire, std::uint32_t port_index, std::string port_name);

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
  void accept(const can::Acceptance& acceptance) override;
  void set_transmit_queue(can::TransmitOrder order, std::size_t capacity) override;
  [[nodiscard]] const can::PortCounters& counters() const override { return counted; }
  [[nodiscard]] std::size_t waiting() const override {
    return queue.size() + (sending && !sends_babble ? 1 : 0);
  }
  void set_listen_only(bool new_listen_only) override;
  void set_automatic_recovery(bool automatic) override;
  void recover() override;

  /// What it offers in arbitration, for the arbiter.
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
  /// It is on the wire, and neither its settings nor bus-off keep it from sending.
  [[nodiscard]] bool may_transmit() const noexcept {
    return on_wire && !listen_only && faults.state() != can::ErrorState::bus_off;
  }
  /// On the wire, and not switched off for good.
  [[nodiscard]] bool present() const noexcept {
    return on_wire && (faults.state() != can::ErrorState::bus_off || recovering);
  }
  /// Bit by bit: it drives the wire dominant.
  [[nodiscard]] bool drives_wire() const noexcept { return on_wire && (stuck_dominant || phase.output); }
  /// It has a fault whose effects only single bits show.
  [[nodiscard]] bool has_bit_fault() const noexcept {
    return stuck_recessive || inverted || single_shot || overload_frames > 0 || early_bits > 0 ||
           lateness > can::Duration{};
  }
  /// The next waiting frame goes onto the wire.
  void begin_next() noexcept {
    sends_babble = babble_goes_first();
    current = sends_babble ? babble : queue.pop();
    babble_due = babble_due && !sends_babble;
    sending = true;
    last_attempt = single_shot;
  }
  /// Keeps what it offers now, which is what it offered when the frame with this number began.
  void snapshot_pending(std::uint64_t frame_number) noexcept {
    pending = {.frame_number = frame_number, .offered = offers()};
    if (!pending.offered) return;
    pending.is_babble = babble_goes_first();
    pending.frame = pending.is_babble ? babble : queue.front();
  }
  /// In the frame with this number it takes no part, whatever it offers.
  void take_no_part(std::uint64_t frame_number) noexcept {
    pending = {.frame_number = frame_number, .offered = false};
  }
  /// It is on the wire with what it offered then.
  void restore_pending() noexcept {
    sends_babble = pending.is_babble;
    current = pending.frame;
    sending = true;
    last_attempt = pending.is_aborted || single_shot;
    if (sends_babble) {
      babble_due = false;
    } else if (!pending.is_aborted) {
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
  /// A frame that it accepts is complete.
  void receive(const can::Frame& frame, can::Time now) {
    if (jammed) {
      if (held.size() < held_capacity) {
        held.push_back(frame);
      } else {
        ++overrun;
        ++counted.receive_overflows;
        if (participant != nullptr) participant->controller_changed(now);
      }
      return;
    }
    ++counted.received;
    if (participant != nullptr) participant->receive(frame, now);
  }

  // Only between Wire::before_change() and Wire::after_change():
  /// Its controller leaves the wire.
  void leave_wire();
  /// Its controller starts anew and has to integrate.
  void start_controller();

  // Reports to the observers of the bus and of its wire.
  /// An error that its controller found now, with its counters as they are.
  void report_error(can::BusErrorReport report) const;
  /// Its controller has changed, and was in this state before.
  void report_controller(can::ErrorState before) const;
  /// It drives nothing any more and takes part in no frame.
  void report_silence();
  /// What it drives: one that is stuck is dominant even when its controller is bus-off.
  void report_output(can::Time now);
  void report_activity(can::Time now);
  void report_field(can::Time now) const;
  void report_counters(can::Time now) const;

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
  Wire* wire;
  std::uint32_t index;
  can::FaultConfinement faults;  // of a frame computed as a whole, as before it: see Wire::counters_of()
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
  PendingSnapshot pending;
  can::Listener* participant = nullptr;
  can::Duration bit_length;  // at this rate
  std::uint32_t rate;
  can::PortCounters counted;

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
  bool stuck_dominant = false;
  bool stuck_recessive = false;
  bool inverted = false;           // noise: what it sees
  bool reported_dominant = false;  // its output, as last reported to wire observers
  unsigned overload_frames = 0;    // asked for after each frame
  unsigned early_bits = 0;         // before the bus is idle it may begin a frame
  can::Duration lateness{};        // of what it drives
  std::size_t held_capacity = 0;
  std::vector<can::Frame> held;  // received while jammed
  can::Frame babble;

  can::Acceptance accepted{.base = {}, .extended = false};  // as in core.acceptance

  // For the wire, while it works bit by bit.
  struct BitPhase {
    can::Time bit_start{};
    can::Time next = can::never;            // sample point or start of the next bit
    bool sampling = false;                  // `next` is a sample point
    bool sampled = false;                   // dominant at the last sample point
    bool synchronised = false;              // since the last sample point
    bool driving = false;                   // the controller means this bit to be dominant
    bool output = false;                    // dominant: what it drives, as it is on the wire
    bool next_output = false;               // the same of a late driver ...
    can::Time output_changes = can::never;  // ... from here on
    void set_output(bool dominant) noexcept {
      output = dominant;
      output_changes = can::never;
    }
    bool flagging = false;     // as last reported to observers
    bool arbitrating = false;  // likewise
    bool received = false;     // complete at the end of this bit
    bool transmitted = false;  // likewise
    bool counted = false;      // `received` or `transmitted` came to this wire from one that reports it
    bool changed = false;      // error state or warning: the participant is to be notified
    can::Time frame_start{};   // of the present or last frame
    unsigned lost_at = WireFrame::Sender::won;  // where it lost arbitration to the frame that it receives now
  };
  BitController bits{faults};
  BitPhase phase;
  /// See class Lockstep.
  struct LockstepState {
    BusPort* leader = nullptr;  // simulates the bits of this port, too
    unsigned followers = 0;     // of this port
    // Of the recovery from bus-off: a follower's, more than its leader's; a leader's, the most that one of them has more, or 0.
    int more_sequences = 0;
    struct Report {
      bool dominant;
      bool flagging;
      can::FrameField field;
      friend bool operator==(const Report&, const Report&) = default;
    };
    std::optional<Report> reported;  // last, of the bits of its followers; none: some have just joined
  };
  LockstepState lockstep;

 private:
  bool send_with_faults(const can::Frame& frame);
  [[nodiscard]] std::uint64_t offer_of_babbler() const noexcept;
  void abort_pending();
  void reset();
  void update_on_wire();

  std::string port_name_;
};

}  // namespace canopus::sim
