#pragma once
// The contents of the live table at one moment: plain data, so that its layout is a function of it.

#include <cstdint>
#include <string>
#include <vector>

#include "canopus/can/bus.hpp"
#include "canopus/cli/run/run_messages.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plant/slave_boot.hpp"

namespace canopus::cli {

/// The size of a terminal.
struct TableSize {
  unsigned rows = 24;
  unsigned columns = 80;
};

struct TableState {
  struct Bus {
    std::string name{};
    std::uint32_t bit_rate = 0;  ///< bit/s
    can::BusLoad load{};
    std::string last_error{};  ///< "0.125 s: stuff error in data ..."; empty: none yet
  };
  struct Node {
    plant::NodeStatus status{};
    double pdo_rate = 0;  ///< PDOs (in a Layer 2 mode frames) sent per second
  };

  std::string plant{};
  can::Time now{};
  can::Duration lag{};
  std::vector<Bus> buses{};
  std::vector<Node> nodes{};                     ///< in the order of the plant file, modules first
  std::vector<plant::SlaveBoot> boots{};         ///< booted ones, too
  std::vector<plant::ModuleTrouble> troubles{};  ///< modules that exchange no process data
  std::vector<plant::ForcedObject> forced{};     ///< forced values of devices
  std::vector<plant::ModuleStatus> modules{};    ///< signals and watched words
  std::vector<RunMessage> messages{};            ///< the latest errors and warnings, newest last
  std::uint64_t errors = 0;                      ///< total number
  std::uint64_t warnings = 0;
  std::vector<std::string> events{};   ///< the latest other events, newest last
  std::vector<std::string> servers{};  ///< "MC protocol 127.0.0.1:5007": where clients connect
  bool has_keys = false;               ///< the table can be scrolled
};

}  // namespace canopus::cli
