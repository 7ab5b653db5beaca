#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/can/error_frame.hpp"
#include "canopus/can/timeline.hpp"
#include "canopus/link/socketcand_server.hpp"
#include "canopus/plant/missing_ack_detector.hpp"

namespace canopus::serve {

/// A port of a simulated bus for one socketcand client after the other. A bus keeps its ports and a timeline
/// its places, so those of clients that left are used again.
class ClientPort final : public can::Participant, private can::BusObserver {
 public:
  ClientPort(can::Bus& bus, can::Timeline& timeline) : bus_(bus), port_(bus.add_port("socketcand")) {
    timeline.add(*this, "socketcand client");
    port_.connect(*this);
    bus_.add_observer(*this);
  }
  ~ClientPort() override {
    bus_.remove_observer(*this);
    port_.disconnect();
  }
  ClientPort(const ClientPort&) = delete;
  ClientPort& operator=(const ClientPort&) = delete;

  void join(link::AttachedClient& client) {
    unacknowledged_ = {};
    client_ = &client;
    port_.set_transmit_queue(can::TransmitOrder::fifo,
                             queued_frames);  // as sent, and nothing of an earlier client
    port_.plug(true);
    alarm().add_part(client.alarm());
  }
  void leave() {
    port_.abort_transmissions();
    port_.plug(false);
    alarm().remove_part(client_->alarm());
    client_ = nullptr;
    if (port_.bit_rate() != bus_.bit_rate()) port_.restart(bus_.bit_rate());
  }
  bool send(const can::Frame& frame) { return port_.send(frame); }
  void restart(std::uint32_t bit_rate) { port_.restart(bit_rate); }

  void receive(const can::Frame& frame, can::Time now) override {
    if (client_ != nullptr) client_->receive(frame, now);
  }
  void transmitted(const can::Frame& frame, can::Time now) override {
    if (client_ != nullptr) client_->transmitted(frame, now);
  }
  void controller_changed(can::Time now) override {
    if (client_ != nullptr) client_->controller_changed(now);
  }
  void tick(can::Time now) override {
    if (client_ != nullptr) client_->tick(now);
  }

 private:
  // can::BusObserver
  void frame_completed(const can::Frame&, can::Time, can::Time) override {
    unacknowledged_.frame_completed();
    last_class_ = 0;
  }
  void error_detected(const can::Port& port, can::BusError error, can::Time now) override {
    if (&port != &port_ || client_ == nullptr) return;
    if (unacknowledged_.error_detected(port, error)) client_->unacknowledged(now);
  }
  void errors_reported(std::span<const can::BusErrorReport> reports, can::Time now) override {
    if (client_ == nullptr) return;
    const auto own = std::ranges::find(reports, &port_, &can::BusErrorReport::port);
    // Missing acknowledgements are reported once, as above.
    if (own == reports.end() || own->error == can::BusError::acknowledgement) return;
    report_class(can::error_frame(*own).identifier, now);
  }
  void controller_changed(const can::ControllerReport& report, can::Time now) override {
    if (client_ != nullptr && report.port == &port_) report_class(can::error_frame(report).identifier, now);
  }
  /// Not the same again and again, as long as no frame is completed.
  void report_class(std::uint32_t error_class, can::Time now) {
    if (std::exchange(last_class_, error_class) != error_class) client_->controller_error(error_class, now);
  }

  static constexpr std::size_t queued_frames = 128;
  std::uint32_t last_class_ = 0;
  link::AttachedClient* client_ = nullptr;
  plant::MissingAckDetector unacknowledged_;
  can::Bus& bus_;
  can::Port& port_;
};

/// The ports that socketcand clients of one bus have or had.
class ClientPorts {
 public:
  /// `own_bit_rates`: each client is a controller of its own, as on a simulated bus, and may have another bit rate.
  ClientPorts(can::Bus& bus, can::Timeline& timeline, bool own_bit_rates)
      : bus_(bus), timeline_(timeline), own_bit_rates_(own_bit_rates) {}

  /// A client's place until it is destroyed.
  [[nodiscard]] std::unique_ptr<link::BusAttachment> attach(link::AttachedClient& client) {
    if (free_.empty()) free_.push_back(std::make_unique<ClientPort>(bus_, timeline_));
    auto port = std::move(free_.back());
    free_.pop_back();
    port->join(client);
    return std::make_unique<Attachment>(free_, std::move(port), own_bit_rates_);
  }

 private:
  using Free = std::vector<std::unique_ptr<ClientPort>>;

  class Attachment final : public link::BusAttachment {
   public:
    Attachment(Free& free, std::unique_ptr<ClientPort> port, bool own_bit_rate)
        : free_(free), port_(std::move(port)), own_bit_rate_(own_bit_rate) {}
    ~Attachment() override {
      port_->leave();
      free_.push_back(std::move(port_));
    }
    Attachment(const Attachment&) = delete;
    Attachment& operator=(const Attachment&) = delete;

    bool send(const can::Frame& frame) override { return port_->send(frame); }
    bool restart(std::uint32_t bit_rate) override {
      if (own_bit_rate_) port_->restart(bit_rate);
      return own_bit_rate_;
    }

   private:
    Free& free_;
    std::unique_ptr<ClientPort> port_;
    bool own_bit_rate_;
  };

  can::Bus& bus_;
  can::Timeline& timeline_;
  bool own_bit_rates_;
  Free free_;
};

}  // namespace canopus::serve
