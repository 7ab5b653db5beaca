#pragma once
// The frames of a trace, sent at their times.

#include <cstdint>
#include <functional>
#include <optional>

#include "canopus/can/controller.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/can/timeline.hpp"

namespace canopus::cli {

class TracePlayer final : public can::Participant {
 public:
  struct Step {
    can::Duration time{};  ///< since the first frame of the trace
    can::Frame frame{};
  };
  /// The next frame; nothing at the end of the trace. A time before the one of the last frame is as late as that.
  using Source = std::function<std::optional<Step>()>;

  /// `speed`: 2 is twice as fast; 0: as fast as the bus takes them.
  TracePlayer(can::Sink& bus, Source source, double speed)
      : bus_(bus), source_(std::move(source)), speed_(speed) {}

  /// The first frame, whose time is `first`, is sent at `now`.
  void start(can::Time now, can::Duration first);
  [[nodiscard]] bool is_done() const noexcept { return done_; }
  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
  /// The bus did not accept the last frame; it is tried again.
  [[nodiscard]] bool is_held() const noexcept { return held_; }
  /// The position in the trace.
  [[nodiscard]] can::Duration position() const noexcept { return position_; }

  void receive(const can::Frame& /*frame*/, can::Time /*now*/) override {}
  void tick(can::Time now) override;

 private:
  void load_next();

  can::Sink& bus_;
  Source source_;
  double speed_;
  can::Time started_{};
  can::Duration first_{};
  can::Duration position_{};
  std::optional<Step> next_;
  std::uint64_t sent_ = 0;
  bool held_ = false;
  bool done_ = false;
};

}  // namespace canopus::cli
