#pragma once

#include <chrono>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/app/plant.hpp"
#include "canopus/link/loop_clock.hpp"

namespace canopus::app {

/// Keeps a plant in step with the machine's clock.
class RealTime final : public link::LoopClock {
 public:
  /// `io` is stopped when the plant's time has come to `end`; `observer` hears when the plant is late.
  RealTime(boost::asio::io_context& io, Plant& plant, PlantObserver& observer, can::Time end);

  void start();
  can::Time now() override;
  void touched() override;
  [[nodiscard]] can::Duration largest_lag() const noexcept { return largest_lag_; }
  [[nodiscard]] can::Duration lag() const noexcept { return lag_; }

 private:
  using WallClock = std::chrono::steady_clock;

  [[nodiscard]] can::Time clock() const;
  void arm();
  void wake();
  void advance(can::Time wall);

  can::Timeline& timeline_;
  PlantObserver& observer_;
  boost::asio::steady_timer timer_;
  boost::asio::io_context& io_;
  can::Time end_;
  WallClock::time_point started_{};
  can::Time armed_for_ = can::never;
  can::Duration lag_{};
  can::Duration largest_lag_{};
  can::Time tell_again_{};
};

}  // namespace canopus::app
