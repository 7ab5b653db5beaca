#pragma once
// A command that runs in this process as a client of a bus, in plant time: what those of SDO, NMT and of single frames share.

#include <chrono>
#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "canopus/can/controller.hpp"
#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/link/loop_clock.hpp"
#include "canopus/link/socketcand_server.hpp"
#include "canopus/serve/client_ports.hpp"
#include "canopus/text/json.hpp"
#include "canopus/text/output.hpp"
#include "canopus/web/commands/running_command.hpp"

namespace canopus::web {

/// As long as its command runs, and until what it sent is on the bus.
class BusCommand : public RunningCommand,
                   public link::AttachedClient,
                   public std::enable_shared_from_this<BusCommand>,
                   protected can::Sink {
 public:
  // Exit codes.
  static constexpr int done = 0;
  static constexpr int failed = 1;  ///< the bus or a node refused, or does not answer
  static constexpr int usage = 2;
  /// What is not on the bus by then is dropped.
  static constexpr can::Duration linger = std::chrono::seconds(1);

  /// `standstill`: of the machine's clock; when plant time has not gone on in that time the command fails.
  BusCommand(boost::asio::io_context& io, link::LoopClock& clock, std::chrono::milliseconds standstill,
             Use use);

  /// Not from inside of the timeline.
  void start(serve::ClientPorts& ports);

  // RunningCommand
  void interrupt() final;
  void kill() final;
  void stop() noexcept final;

  // link::AttachedClient
  void receive(const can::Frame& frame, can::Time now) final;
  void transmitted(const can::Frame& frame, can::Time now) final;
  void tick(can::Time now) final;
  void unacknowledged(can::Time now) final;
  void controller_error(std::uint32_t error_class, can::Time now) final;

 protected:
  virtual void begin(can::Time now) = 0;
  virtual void received(const can::Frame& frame, can::Time now) = 0;
  virtual void ticked(can::Time now) = 0;
  /// One of the frames that were sent is on the bus.
  virtual void frame_sent(can::Time /*now*/) {}
  /// Ends without a result, for this reason.
  virtual void give_up(std::string_view why, can::Time now) = 0;

  bool send(const can::Frame& frame) final;
  void print(const text::Json& row) { out_.json(row); }
  /// Each sentence once.
  void complain(const text::Line& sentence);
  /// Its result is there.
  void conclude(int code, can::Time now);

 private:
  void answer(int code);
  void leave_soon();
  void watch_standstill();
  void check_standstill();

  boost::asio::io_context& io_;
  link::LoopClock& clock_;
  std::chrono::milliseconds standstill_;
  boost::asio::steady_timer standstill_timer_;
  Use use_;
  std::unique_ptr<link::BusAttachment> attachment_;
  std::shared_ptr<BusCommand> self_;  // as long as it is on the bus
  text::TextOutput out_;
  text::TextOutput errors_;
  can::Time last_time_{};
  can::Alarm leave_at_;
  std::size_t on_the_way_ = 0;
  bool is_over_ = false;
  bool is_leaving_ = false;
};

}  // namespace canopus::web
