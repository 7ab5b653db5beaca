#pragma once
// What happens in a plant: one type for each kind, and the variant of them that a PlantObserver gets. docs/events.md describes
// the lines made of them. Views are of texts that live as long as the plant.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "canopus/can/bus.hpp"
#include "canopus/can/controller.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/canopen/service/node_listener.hpp"
#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/module/interface/event_records.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/sim/lift/lift_report.hpp"

namespace canopus::plant {

/// A boot-up message.
struct BootUp {
  NodeLabel node;
};
struct NmtStateChange {
  NodeLabel node;
  canopen::NmtState state;
};
/// LSS gave a device of the plant its node-ID (the label has it already; FFH: took it away) or bit rate, or the device came up
/// with what it had stored.
struct LssSetting {
  NodeLabel node;
  std::uint32_t bit_rate;  ///< bit/s
};
struct EmergencySent {
  NodeLabel node;
  canopen::Emergency message;
};
/// No other node acknowledges the frames of this one. Once, until a frame on its bus is acknowledged again.
struct MissingAck {
  NodeLabel node;
};
/// The error state of a node's controller changed, or a counter passed the warning limit.
struct ControllerChange {
  NodeLabel node;
  can::ControllerReport report;
};
/// A module of the plant boots this slave as its NMT master and came to another step, or repeats the request of a step.
struct SlaveBootStep {
  NodeLabel slave;
  NodeLabel master;
  manager::BootRecord record;
};
struct SignalChange {
  std::string_view plc;
  char device;  ///< 'X' or 'Y'
  unsigned number;
  bool on;
};
/// A buffer memory word got another value: written by the CPU, or a watched one changed by the module.
struct BufferChange {
  std::string_view plc;
  unsigned head;  ///< head I/O number of the module, in points
  std::uint32_t address;
  std::uint16_t value;
  bool by_cpu;
};
/// A value of a device is forced from now on, or with another value or end than before.
struct ObjectForced {
  ForcedObject object;
};
/// The value shows what the device itself has again.
struct ObjectReleased {
  ForcedObject object;
};
struct LiftChange {
  std::string_view bus;
  sim::lift::LiftEvent event;
};
/// Once a second, of each bus.
struct LoadMeasured {
  std::string_view bus;
  can::BusLoad load;
};
/// Something that was probably not meant: at the start of the plant file, later of a drive that is to move and cannot.
struct Warning {
  std::string source;  ///< its place in the file; a node
  std::string message;
};
/// A module reported an event to its CPU, for the event history.
struct ModuleEvent {
  std::string_view plc;
  std::string_view module;  ///< "RJ71CN91 U0"
  module::ModuleEventRecord record;
};
/// A module reported an error to its CPU, which module diagnostics show from now on.
struct ModuleError {
  std::string_view plc;
  std::string_view module;
  module::ModuleErrorRecord record;
};
struct Failure {
  std::string source;
  std::string message;
};

struct Event {
  can::Time time;
  std::variant<BootUp, NmtStateChange, LssSetting, EmergencySent, MissingAck, BusErrorEvent, ControllerChange,
               SlaveBootStep, SignalChange, BufferChange, ObjectForced, ObjectReleased, LiftChange,
               LoadMeasured, Warning, ModuleEvent, ModuleError, Failure>
      what;
};

// Kinds of events by their names in docs/events.md.

/// In the order of the alternatives of Event::what.
inline constexpr std::array<std::string_view, std::variant_size_v<decltype(Event::what)>> event_names{
    "boot",       "nmt",        "lss",     "emcy",         "unacknowledged", "bus error",
    "controller", "boot slave", "signal",  "buffer",       "forced",         "released",
    "lift",       "load",       "warning", "module event", "module error",   "error"};
static_assert(!event_names.back().empty());

/// "error", "lift".
[[nodiscard]] inline std::string_view name_of(const Event& event) noexcept {
  return event_names[event.what.index()];
}

}  // namespace canopus::plant
