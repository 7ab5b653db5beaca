#pragma once
// The inside of the bus: its controllers (BusPort), what they share (BusCore), and the wire they are on
// (Segment). Only the sources of the bus include this.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopus/can/fault_confinement.hpp"
#include "canopus/can/frame_bits.hpp"
#include "canopus/sim/bus.hpp"
#include "canopus/sim/bus_statistics.hpp"
#include "canopus/sim/port_table.hpp"
#include "canopus/sim/transmit_queue.hpp"

namespace canopus::sim {

class BusPort;
class Segment;

/// What all controllers of a bus share.
struct BusCore {
  BusCore(std::string bus_name, std::uint32_t bus_bit_rate, can::Timeline& bus_timeline)
      : name(std::move(bus_name)), bit_rate(bus_bit_rate), timeline(bus_timeline) {}

  /// Somebody outside the bus's own tick changed when the bus has to act.
  void refresh() {
    if (!ticking) timeline.refresh(handle);
  }

  std::string name;
  std::uint32_t bit_rate;
  can::Timeline& timeline;
  can::Timeline::Handle handle = 0;
  bool ticking = false;
  std::vector<std::unique_ptr<BusPort>> ports;
  std::vector<BusObserver*> observers;
  BusStatistics statistics;
  AcceptanceTable acceptance;
};

class BusPort final : public Port {
 public:
  BusPort(BusCore& bus_core, Segment& port_segment, std::size_t port_index, std::string port_name);

  bool send(const can::Frame& frame) override;
  [[nodiscard]] std::uint16_t transmit_error_counter() const override { return faults.transmit_errors(); }
  [[nodiscard]] std::uint16_t receive_error_counter() const override { return faults.receive_errors(); }
  [[nodiscard]] can::ErrorState error_state() const override { return faults.state(); }
  [[nodiscard]] std::uint32_t bit_rate() const override { return rate; }
  void restart(std::uint32_t bit_rate) override;
  [[nodiscard]] std::uint32_t transmit_overflows() const override { return refused; }
  [[nodiscard]] std::uint32_t receive_overflows() const override { return overrun; }

  void connect(can::Participant& new_participant, can::Timeline::Handle new_handle) override;
  void disconnect() override { participant = nullptr; }
  void plug(bool plugged) override;
  [[nodiscard]] bool plugged() const override { return on_wire; }
  [[nodiscard]] const std::string& name() const override { return port_name_; }
  void accept(const Acceptance& acceptance) override;
  void set_transmit_queue(TransmitOrder order, std::size_t capacity) override;
  [[nodiscard]] const PortCounters& counters() const override { return counted; }

  /// What it offers in arbitration, for Arbiter.
  [[nodiscard]] std::uint64_t offer() const noexcept {
    if (queue.empty() || !may_transmit()) return Arbiter::none;
    return Arbiter::key(arbitration(queue.front()), index);
  }
  [[nodiscard]] bool may_transmit() const noexcept {
    return on_wire && faults.state() != can::ErrorState::bus_off;
  }
  /// Tells the participant and reads its deadline again.
  template <typename Call>
  void tell(Call call) {
    if (participant == nullptr) return;
    call(*participant);
    core.timeline.refresh(handle);
  }

  BusCore& core;
  Segment* segment;
  std::size_t index;
  can::Participant* participant = nullptr;
  can::Timeline::Handle handle = 0;
  std::uint32_t rate;
  bool on_wire = true;
  bool sending = false;  // `current` is on the wire; it counts as waiting
  can::Frame current;
  TransmitQueue queue;
  can::FaultConfinement faults;
  std::uint32_t refused = 0;
  std::uint32_t overrun = 0;
  PortCounters counted;

 private:
  std::string port_name_;
};

/// One electrically connected piece of wire. While nothing is wrong a frame costs two steps: its start, where
/// arbitration and its length are computed, and its end, where it is delivered.
class Segment {
 public:
  explicit Segment(BusCore& core) : core_(core) {}

  void add(BusPort& port);
  /// What the port offers, or whether it takes part, changed.
  void port_changed(BusPort& port);
  void tick(can::Time now);
  [[nodiscard]] can::Time deadline() const noexcept { return deadline_; }

 private:
  enum class State : std::uint8_t {
    idle,        // nothing on the wire; deadline_ is the next start, or never
    frame,       // deadline_ is the end of EOF
    lone_frame,  // nobody acknowledges; deadline_ is the end of the ACK slot
  };

  void start(can::Time now);
  void finish(can::Time now);
  void fail_lone(can::Time now);
  void deliver(const can::Frame& frame, const BusPort& from, can::Time now);
  /// Ready for the next frame at `from`.
  void become_idle(can::Time from);
  [[nodiscard]] bool somebody_acknowledges(const BusPort& transmitter) const;

  BusCore& core_;
  State state_ = State::idle;
  can::Time deadline_ = can::never;
  can::Time free_from_{};  // end of the last intermission
  can::Time start_{};      // of the frame on the wire
  unsigned bits_ = 0;      // of the frame on the wire
  BusPort* transmitter_ = nullptr;
  Arbiter arbiter_;
  std::vector<std::uint64_t> hearing_;  // set of ports, as in AcceptanceTable
  std::size_t hearing_count_ = 0;
};

}  // namespace canopus::sim
