#pragma once
// Stands between a protocol object and its sink: while it is closed, what is sent is lost, as with a
// controller that is off.

#include "canopus/can/controller.hpp"

namespace canopus::can {

class Gate final : public Sink {
 public:
  /// Open. `sink` must outlive it.
  explicit Gate(Sink& sink) : sink_(&sink) {}
  void open(bool is_open) noexcept { open_ = is_open; }
  [[nodiscard]] bool is_open() const noexcept { return open_; }
  bool send(const Frame& frame) override { return open_ && sink_->send(frame); }

 private:
  Sink* sink_;
  bool open_ = true;
};

}  // namespace canopus::can
