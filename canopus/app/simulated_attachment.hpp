#pragma once

#include <vector>

#include "canopus/can/timeline.hpp"
#include "canopus/link/socketcand_server.hpp"
#include "canopus/sim/bus.hpp"

namespace canopus::app {

/// A socketcand client's own port on a simulated bus. A bus keeps its ports, so those of clients that left
/// are used again.
class SimulatedAttachment final : public link::BusAttachment {
 public:
  using Ports = std::vector<sim::Port*>;

  SimulatedAttachment(sim::Bus& bus, Ports& free_ports, can::Timeline& timeline, can::Participant& client)
      : free_ports_(free_ports), timeline_(timeline), handle_(timeline.add(client, "socketcand client")) {
    if (free_ports_.empty()) free_ports_.push_back(&bus.add_port("socketcand"));
    port_ = free_ports_.back();
    free_ports_.pop_back();
    port_->set_transmit_queue(sim::TransmitOrder::fifo,
                              queued_frames);  // as sent, and nothing of an earlier client
    port_->connect(client, handle_);
    port_->plug(true);
  }
  ~SimulatedAttachment() override {
    port_->plug(false);
    port_->disconnect();
    timeline_.remove(handle_);
    free_ports_.push_back(port_);
  }
  SimulatedAttachment(const SimulatedAttachment&) = delete;
  SimulatedAttachment& operator=(const SimulatedAttachment&) = delete;

  bool send(const can::Frame& frame) override { return port_->send(frame); }
  void refresh() override { timeline_.refresh(handle_); }

 private:
  static constexpr std::size_t queued_frames = 128;
  Ports& free_ports_;
  can::Timeline& timeline_;
  can::Timeline::Handle handle_;
  sim::Port* port_ = nullptr;
};

}  // namespace canopus::app
