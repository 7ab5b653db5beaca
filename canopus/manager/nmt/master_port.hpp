#pragma once
// The way between an NMT master and its bus. SDO requests wait in line (sdo_request_queue.hpp). On a bus that is a
// function call, answers come from inside send(), in the middle of whatever sends: they are kept until that
// is done.

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

  /// Swallows what must not be sent: everything while muted; SDO requests of a Stopped node.
  bool send(const can::Frame& frame) override;
  /// What goes out whatever the node may, at whatever bit rate: LSS.
  [[nodiscard]] can::Sink& wire() noexcept { return wire_; }
  void mute(bool muted) noexcept { muted_ = muted; }
  [[nodiscard]] bool is_muted() const noexcept { return muted_; }
  /// Everything is given up.
  void clear() noexcept {
    line_.clear();
    kept_.clear();
  }

  /// The time of what is sent from now on.
  void set_time(can::Time now) noexcept { now_ = now; }
  /// The controller has sent an SDO request.
  void request_transmitted(std::uint32_t identifier, can::Time now) {
    line_.transmitted(identifier, wire_, now);
  }
  /// An SDO request with this identifier is in line, and the line moves.
  [[nodiscard]] bool waits(std::uint32_t identifier, can::Time now) const noexcept {
    return line_.waits(identifier, now);
  }

  /// Inside send().
  [[nodiscard]] bool is_sending() const noexcept { return wire_.depth != 0; }
  void keep(const can::Frame& frame) { kept_.push_back(frame); }
  /// Frames are kept, and none of those before is being heard.
  [[nodiscard]] bool may_hear_kept() const noexcept { return !kept_.empty() && hearing_.empty(); }
  [[nodiscard]] bool has_kept() const noexcept { return !kept_.empty(); }
  template <typename Hear>
  void process_deferred(Hear hear) {
    if (!may_hear_kept()) return;
    std::swap(kept_, hearing_);  // what is sent now may be answered at once again
    for (const can::Frame& frame : hearing_) hear(frame);
    hearing_.clear();
  }

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
  SdoRequestQueue line_;
  std::vector<can::Frame> kept_;
  std::vector<can::Frame> hearing_;  // of those, what is being heard
  can::Time now_{};
  bool muted_ = false;
};

}  // namespace canopus::manager
