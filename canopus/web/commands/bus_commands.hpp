#pragma once
// Commands of the page on nodes of a simulated bus of this process: an SDO transfer or an NMT command, by a client with a port of its
// own on that bus, in plant time. Frames, answers and errors are those of `canopus sdo` and `canopus nmt`.

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "canopus/link/loop_clock.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/serve/client_ports.hpp"
#include "canopus/web/commands/arguments.hpp"
#include "canopus/web/commands/running_command.hpp"

namespace canopus::web {

class BusCommands {
 public:
  /// All must outlive this. `standstill`: of the machine's clock; a command for which plant time has not gone on
  /// in that time fails, as it would hold up the others.
  BusCommands(boost::asio::io_context& io, plant::Plant& plant, link::LoopClock& clock,
              std::chrono::milliseconds standstill = std::chrono::milliseconds(500))
      : io_(io), plant_(plant), clock_(clock), standstill_(standstill) {}
  ~BusCommands();
  BusCommands(const BusCommands&) = delete;
  BusCommands& operator=(const BusCommands&) = delete;

  /// Starts `sdo read`, `sdo write` or `nmt ...` on a simulated bus; nullptr: it is another command, or another bus. Not from inside of
  /// the timeline.
  [[nodiscard]] std::shared_ptr<RunningCommand> start(const WebCommandLine& line, RunningCommand::Use use);

 private:
  [[nodiscard]] serve::ClientPorts* ports_of(const std::string& bus);

  boost::asio::io_context& io_;
  plant::Plant& plant_;
  link::LoopClock& clock_;
  std::chrono::milliseconds standstill_;
  std::map<std::size_t, serve::ClientPorts>
      ports_;  // by bus, those of commands that have ended for the next ones
  std::vector<std::weak_ptr<RunningCommand>> started_;
};

}  // namespace canopus::web
