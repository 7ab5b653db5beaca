#pragma once
// A bus of this machine's hardware, or of another program, under the soft modules of a plant. The controllers
// of all nodes of the plant share one connection to it: the other nodes of the plant receive a frame when the
// transport confirms that it is on the bus. Bit rate, error state and counters are those of the hardware, as
// far as the transport reports them.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/can/bus_statistics.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/can/transmit_queue.hpp"
#include "canopus/link/bus_client.hpp"
#include "canopus/link/loop_clock.hpp"

namespace canopus::link {

class LinkedBus;

/// The controller of one node of the plant. All ports share the state of the one hardware controller.
class LinkedPort final : public can::Port {
 public:
  LinkedPort(LinkedBus& bus, std::string name);

  bool send(const can::Frame& frame) override;
  void connect(can::Listener& participant) override { participant_ = &participant; }
  void disconnect() override { participant_ = nullptr; }
  void plug(bool plugged) override;
  void set_power(bool on) override;
  [[nodiscard]] bool plugged() const override { return plugged_; }
  [[nodiscard]] const std::string& name() const override { return name_; }
  void accept(const can::Acceptance& acceptance) override { acceptance_ = acceptance; }
  void set_transmit_queue(can::TransmitOrder order, std::size_t capacity) override;
  [[nodiscard]] const can::PortCounters& counters() const override { return counters_; }
  [[nodiscard]] std::size_t waiting() const override { return queue_.size() + under_way_; }
  void set_listen_only(bool listen_only) override;
  void set_automatic_recovery(bool automatic) override;
  void recover() override;
  [[nodiscard]] std::uint16_t transmit_error_counter() const override;
  [[nodiscard]] std::uint16_t receive_error_counter() const override;
  [[nodiscard]] can::ErrorState error_state() const override;
  [[nodiscard]] std::uint32_t bit_rate() const override { return bit_rate_; }
  void restart(std::uint32_t bit_rate) override;
  [[nodiscard]] std::uint32_t transmit_overflows() const override { return refused_; }
  [[nodiscard]] bool has_room() const override;
  void abort_transmissions() override;

 private:
  friend class LinkedBus;
  [[nodiscard]] bool is_on() const noexcept { return powered_ && plugged_ && !has_other_rate_; }
  [[nodiscard]] bool offers() const noexcept { return is_on() && !listen_only_ && !queue_.empty(); }

  LinkedBus& bus_;
  std::string name_;
  can::Listener* participant_ = nullptr;
  can::Acceptance acceptance_;
  can::TransmitQueue queue_;
  can::PortCounters counters_;
  std::uint32_t bit_rate_;
  std::uint32_t refused_ = 0;
  std::size_t under_way_ = 0;  // handed to the transport, not yet on the bus
  bool powered_ = true;
  bool plugged_ = true;
  bool listen_only_ = false;
  bool automatic_recovery_ = true;
  bool has_other_rate_ = false;  // than the bus: receives and sends nothing
};

class LinkedBus final : public can::Bus, public can::Ticker, private BusClientListener {
 public:
  /// Called with a message about this bus for the user.
  using Report = std::function<void(std::string_view text, can::Time now)>;

  /// bit_rate in bit/s: the nodes' bit rate. Adds itself to the timeline, which must outlive the bus.
  LinkedBus(std::string name, std::uint32_t bit_rate, can::Timeline& timeline,
            std::unique_ptr<BusClient> client);
  ~LinkedBus() override;
  LinkedBus(const LinkedBus&) = delete;
  LinkedBus& operator=(const LinkedBus&) = delete;

  /// From now on frames are received and sent. The clock brings the timeline up to the moment of a frame;
  /// null: the transport runs in the timeline itself.
  void start(LoopClock* clock, Report report);
  /// Waits up to `time_out` for pending transmissions; nothing is received any more. False: frames were left.
  bool close(std::chrono::milliseconds time_out);

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] std::uint32_t bit_rate() const noexcept override { return bit_rate_; }
  [[nodiscard]] bool is_there() const noexcept override { return !is_lost_ && !is_interrupted_; }
  can::Port& add_port(std::string name) override;
  [[nodiscard]] std::vector<const can::Port*> ports() const override;
  void add_observer(can::BusObserver& observer) override;
  void remove_observer(can::BusObserver& observer) override;
  [[nodiscard]] can::BusLoad load(can::Time now) const override { return statistics_.load(now); }
  [[nodiscard]] std::uint64_t frames_of(std::uint32_t identifier, bool extended) const override {
    return statistics_.frames_of(identifier, extended);
  }
  /// For an observer inside its frame callback: when the frame was complete by the time stamp of the kernel
  /// or the hardware, or the present moment where there is none. Not before the frame before it, not after
  /// now.
  [[nodiscard]] can::Time stamp() const noexcept { return stamp_; }
  /// A source of the time since 1970 (UTC), for a test.
  using WallClock = std::function<std::chrono::nanoseconds()>;
  void set_wall_clock(WallClock clock) { wall_clock_ = std::move(clock); }
  /// The hardware's last reported status.
  [[nodiscard]] const ControllerStatus& status() const noexcept { return status_; }

  void tick(can::Time now) override;

 private:
  friend class LinkedPort;
  /// Most frames in the transport at a time. Frames that wait here can still be overtaken or taken back, as
  /// in a controller; too few would leave gaps between the frames. A transport that never reports
  /// frame_sent() gets no more than these.
  static constexpr std::size_t window = 4;
  struct UnderWay {
    LinkedPort* port = nullptr;  // null: its node was restarted or switched off meanwhile
    can::Frame frame{};
  };

  // BusClientListener
  using Stamp = std::optional<std::chrono::nanoseconds>;
  void frame_received(const can::Frame& frame) override { frame_received_at(frame, std::nullopt); }
  void frame_received_at(const can::Frame& frame, Stamp received_at) override;
  void frame_sent(const can::Frame& frame) override { frame_sent_at(frame, std::nullopt); }
  void frame_sent_at(const can::Frame& frame, Stamp sent_at) override;
  void controller_changed(const ControllerStatus& status) override;
  void bus_interrupted(const std::string& reason) override;
  void bus_resumed() override;
  void bus_lost(const std::string& reason) override;
  void bus_complains(std::string_view text) override;

  /// Brings the timeline up to now, unless this call comes out of it.
  can::Time arrive();
  void leave();
  void completed(const can::Frame& frame, LinkedPort* sender, can::Time now, Stamp stamp);
  [[nodiscard]] can::Time time_of(Stamp stamp, can::Time now) const;
  void hand_over();
  void offer_changed();
  void forget(LinkedPort& port) noexcept;
  void lose_what_is_under_way() noexcept;
  void want_bit_rate(LinkedPort& port, std::uint32_t bit_rate);
  void want_recovery();
  void report(std::string_view text);
  void report_controllers(can::Time now);
  LinkedPort* first_in_arbitration() noexcept;

  std::string name_;
  std::uint32_t bit_rate_;
  can::Timeline& timeline_;
  std::unique_ptr<BusClient> client_;
  LoopClock* clock_ = nullptr;
  Report report_;
  ControllerStatus status_;
  std::vector<std::unique_ptr<LinkedPort>> ports_;
  std::vector<can::BusObserver*> observers_;
  can::BusStatistics statistics_;
  std::array<UnderWay, window> under_way_{};  // in the order of sending
  std::size_t under_way_count_ = 0;
  can::Time busy_until_{};
  can::Time stamp_{};  // of the last frame
  WallClock wall_clock_;
  can::Alarm hand_over_at_;
  can::Alarm recover_at_;
  bool is_started_ = false;
  bool is_lost_ = false;
  bool is_interrupted_ = false;  // it is tried again
};

}  // namespace canopus::link
