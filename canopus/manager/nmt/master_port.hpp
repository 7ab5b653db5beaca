#pragma once
// The port of an NMT master to its bus. SDO requests go through a queue (sdo_request_queue.hpp). On a bus that is a
// function call, answers come from inside send(), in the middle of whatever sends: they are deferred until that is
// done.

#include <cstdint>
#include <utility>
#include <vector>

#include "canopus/can/controller.hpp"
#include "canopus/canopen/node/node.hpp"
#include "canopus/manager/sdo/sdo_request_queue.hpp"

namespace canopus::manager {

class MasterPort final : public can::Sink {
 public:
  MasterPort(can::Sink& sink, const canopen::Node& node) : wire_(sink), node_(&node) {}

  /// Swallows what must not be sent: everything while muted; SDO requests of a Stopped node, which sends no SDO and receives none
  /// [CiA 301 7.3.2.2.4; ME3CAN1-Q 4.8.1]. Nothing is reported: the start-up finds no answer and repeats its requests.
  bool send(const can::Frame& frame) override {
    if (muted_) return true;
    if ((frame.identifier & canopen::cob_id::function_code) != canopen::cob_id::sdo_request)
      return wire_.send(frame);
    if (node_->state() == canopen::NmtState::stopped) return true;
    return queue_.send(frame, wire_, now_);
  }
  /// What goes out whatever the node may, at whatever bit rate: LSS.
  [[nodiscard]] can::Sink& wire() noexcept { return wire_; }
  void mute(bool muted) noexcept { muted_ = muted; }
  [[nodiscard]] bool is_muted() const noexcept { return muted_; }
  /// Everything is given up.
  void clear() noexcept {
    queue_.clear();
    deferred_.clear();
    alarm_.cancel();
  }

  /// The time of what is sent from now on.
  void set_time(can::Time now) noexcept { now_ = now; }
  /// The controller has sent an SDO request.
  void request_transmitted(std::uint32_t identifier, can::Time now) {
    queue_.transmitted(identifier, wire_, now);
  }
  /// An SDO request with this identifier is in the queue, and the queue moves.
  [[nodiscard]] bool waits(std::uint32_t identifier, can::Time now) const noexcept {
    return queue_.waits(identifier, now);
  }

  /// Inside send().
  [[nodiscard]] bool is_sending() const noexcept { return wire_.depth != 0; }
  /// process_deferred() is to be called for it in the next tick.
  void defer(const can::Frame& frame, can::Time now) {
    deferred_.push_back(frame);
    alarm_ = now;
  }
  /// Frames are deferred, and none of those before is being processed.
  [[nodiscard]] bool may_process_deferred() const noexcept {
    return !deferred_.empty() && processing_.empty();
  }
  template <typename Process>
  void process_deferred(Process process) {
    if (!may_process_deferred()) return;
    std::swap(deferred_, processing_);  // what is sent now may be answered at once again
    alarm_.cancel();
    for (const can::Frame& frame : processing_) process(frame);
    processing_.clear();
  }
  [[nodiscard]] can::Alarm& alarm() noexcept { return alarm_; }

 private:
  struct Wire final : can::Sink {
    explicit Wire(can::Sink& to) : sink(&to) {}
    bool send(const can::Frame& frame) override {
      ++depth;
      const bool sent = sink->send(frame);
      --depth;
      return sent;
    }
    can::Sink* sink;
    unsigned depth = 0;
  };

  Wire wire_;
  const canopen::Node* node_;
  SdoRequestQueue queue_;
  std::vector<can::Frame> deferred_;
  std::vector<can::Frame> processing_;  // of those, what process_deferred() is at
  can::Time now_{};
  bool muted_ = false;
  can::Alarm alarm_;
};

}  // namespace canopus::manager
