#pragma once
// A plant that runs: the buses, devices, racks and modules of a plant file, on one timeline. The driver of
// the timeline (run_loop.hpp) decides whether time is virtual or real; the plant does not depend on it.

#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/bus_error.hpp"
#include "canopus/can/controller.hpp"
#include "canopus/can/time.hpp"
#include "canopus/canopen/dictionary/data_type.hpp"
#include "canopus/canopen/service/nmt.hpp"
#include "canopus/module/interface/led.hpp"
#include "canopus/module/interface/module_information.hpp"
#include "canopus/module/interface/module_types.hpp"

namespace canopus::can {
class Bus;
struct BusLoad;
class Timeline;
}  // namespace canopus::can
namespace canopus::canopen {
struct Emergency;
}
namespace canopus::manager {
struct BootRecord;
}
namespace canopus::module {
class CommunicationModule;
struct ModuleErrorRecord;
struct ModuleEventRecord;
}  // namespace canopus::module
namespace canopus::plc {
class ProgramExecution;
class Rack;
}  // namespace canopus::plc
namespace canopus::sim {
class Bus;
}
namespace canopus::sim::lift {
struct LiftEvent;
}
namespace canopus::text {
struct FileError;
struct FileWarning;
}  // namespace canopus::text

namespace canopus::plant {

struct BusSection;
struct ModuleSection;
struct PlantFile;
struct PlcSection;
struct SlaveBoot;

/// The designation of a node in messages.
struct NodeLabel {
  std::string_view bus;
  std::string_view name;  ///< from the plant file, or the product's; empty for a node outside of the plant
  /// 0: has none (a module in a Layer 2 mode). FFH: has none yet (an LSS slave that waits for one).
  std::uint8_t node_id = 0;
};

/// A forced value of a device.
struct ForcedObject {
  NodeLabel device;
  std::string object;     ///< "6000:01"
  std::string_view name;  ///< of the parameter, from the device file
  canopen::DataType type = canopen::DataType::none;
  std::uint64_t value = 0;       ///< effective bit pattern
  can::Time until = can::never;  ///< released then; never: not by itself
};

/// An error on a bus, and the nodes that found it at one moment in one place of the frame.
struct BusErrorEvent {
  struct Node {
    NodeLabel label;
    can::BusErrorReport report;
  };
  std::string_view bus;
  can::BusError error = can::BusError::none;
  can::FrameField field = can::FrameField::idle;
  unsigned bit = 0;  ///< as BusErrorReport::bit
  std::vector<Node> nodes{};
};

struct Event;  // event.hpp

/// Gets what happens in a plant, as it happens.
class PlantObserver {
 public:
  virtual void on(const Event&) {}

 protected:
  ~PlantObserver() = default;
};

/// A node as the live table and the summary show it.
struct NodeStatus {
  // Members that are read for each frame come first.
  canopen::NmtState state = canopen::NmtState::initialising;
  bool is_on = false;
  bool is_module = false;
  module::Layer2State layer2 = module::Layer2State::inactive;
  bool is_cut_off = false;  ///< on, but receives nothing from its simulated bus: sim::Bus::is_cut_off()
  can::ErrorState error_state = can::ErrorState::error_active;  ///< of its controller
  std::uint16_t transmit_errors = 0;                            ///< TEC
  std::uint16_t receive_errors = 0;                             ///< REC
  std::uint16_t last_emergency = 0;                             ///< code
  std::uint64_t pdos = 0;    ///< sent so far; in a Layer 2 mode every frame counts
  std::uint64_t frames = 0;  ///< that its controller has sent
  std::size_t waiting = 0;   ///< frames in its transmit queue
  std::uint64_t emergencies = 0;
  NodeLabel label;
};

/// The status of a module that a PLC program can read.
struct ModuleStatus {
  struct Word {
    std::uint32_t address = 0;
    std::uint16_t value = 0;
  };
  NodeLabel label;
  std::string_view plc;
  std::uint16_t head = 0;  ///< head I/O number, in points
  bool is_on = false;
  module::CpuState cpu = module::CpuState::stop;
  /// X and Y that are ON, bit n = X(head+n), without those of the built-in program's data exchange.
  std::uint32_t inputs = 0;
  std::uint32_t outputs = 0;
  std::vector<Word> words{};  ///< watched, in the order of the plant file
  std::vector<module::Led> leds{};
  module::ModuleInformation information{};
  module::StartUp start_up = module::StartUp::none;  ///< of its network, as the active NMT master
};

/// The reason why a module of the plant does not exchange process data, although its NMT state may be
/// Operational.
struct ModuleTrouble {
  NodeLabel module;
  std::string text;  ///< what is wrong, since when, and the way back; for a person
};

/// Opens the buses of a plant that are not simulated (`link` in the plant file).
class BusOpener {
 public:
  /// The error is a sentence that names the link and what to do.
  virtual std::expected<std::unique_ptr<can::Bus>, std::string> open(const BusSection& section,
                                                                     can::Timeline& timeline) = 0;

 protected:
  ~BusOpener() = default;
};

class DeviceOnBus;
class LiftOnBus;

class Plant {
 public:
  /// Opens the device files and builds everything that is usable, switched off. Errors name the line of the
  /// plant file; notes of device files that were repaired are not among them (`canopus eds check` shows
  /// those). `seed` replaces the file's. Without an opener every bus is simulated, which is enough to inspect
  /// a plant.
  [[nodiscard]] static std::expected<std::unique_ptr<Plant>, std::vector<text::FileError>> build(
      PlantFile file, PlantObserver& observer, std::optional<std::uint64_t> seed = std::nullopt,
      BusOpener* opener = nullptr);
  ~Plant();
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  /// Locks the `store` folders for this plant until it ends. Call it before power_on() to run a plant; not
  /// needed to inspect one. Errors name the line of the plant file.
  [[nodiscard]] std::vector<text::FileError> open_stores();

  /// Switches everything on at the timeline's now; devices with a later start follow by themselves.
  void power_on();

  /// The timeline of the whole plant. Parts that share nothing (buses that no rack and no bridge joins) are
  /// its partitions (can::Timeline::add_partition), and may run independently up to a moment; then call
  /// parts_met().
  [[nodiscard]] can::Timeline& timeline() noexcept;
  /// The timeline of the nodes on this bus: that of its partition.
  [[nodiscard]] can::Timeline& timeline_of_bus(std::size_t number) noexcept;
  /// The observer for events of this bus: they reach the plant's observer in the order of all partitions.
  [[nodiscard]] PlantObserver& observer_of_bus(std::size_t number) noexcept;
  /// All partitions have run up to `now`: delivers their events to the observer in order of time, as if they
  /// had run together.
  void parts_met(can::Time now);
  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] const PlantFile& file() const noexcept;
  /// Warnings about the plant file, in its order.
  [[nodiscard]] const std::vector<text::FileWarning>& warnings() const noexcept;
  [[nodiscard]] std::size_t bus_count() const noexcept;
  [[nodiscard]] can::Bus& bus(std::size_t number) noexcept;
  /// The same, if it is simulated; else null.
  [[nodiscard]] sim::Bus* simulated_bus(std::size_t number) noexcept;
  [[nodiscard]] const BusSection& bus_section(std::size_t number) const noexcept;
  [[nodiscard]] std::size_t plc_count() const noexcept;
  [[nodiscard]] plc::Rack& rack(std::size_t number) noexcept;
  /// The program that the CPU runs; null: it has none of the user's.
  [[nodiscard]] plc::ProgramExecution* program(std::size_t plc) noexcept;
  [[nodiscard]] const PlcSection& plc_section(std::size_t number) const noexcept;
  /// The simulated devices, in the plant file's order.
  [[nodiscard]] std::size_t device_count() const noexcept;
  [[nodiscard]] DeviceOnBus& device(std::size_t number) noexcept;
  /// The lifts, in the plant file's order.
  [[nodiscard]] std::size_t lift_count() const noexcept;
  [[nodiscard]] LiftOnBus& lift(std::size_t number) noexcept;
  /// Every value that is forced now, device by device.
  [[nodiscard]] std::vector<ForcedObject> forced() const;
  /// All nodes, in the order of the plant file, modules first.
  [[nodiscard]] std::vector<NodeStatus> nodes() const;
  /// All modules, in the order of the plant file.
  [[nodiscard]] std::vector<ModuleStatus> modules() const;
  /// The module of that number there, to inspect it.
  [[nodiscard]] module::CommunicationModule& module(std::size_t number) noexcept;
  [[nodiscard]] const ModuleSection& module_section(std::size_t number) const noexcept;
  /// The errors of the module of that number in module diagnostics.
  [[nodiscard]] std::vector<module::ModuleErrorRecord> module_errors(std::size_t module) const;
  /// Every slave that an active NMT master of the plant boots or has booted, by master and node-ID.
  [[nodiscard]] std::vector<SlaveBoot> boots() const;
  /// A participant requested ticks at one moment endlessly and was stopped (can::Timeline::Stall): the
  /// results of the run from there on are invalid. The observer has had its error().
  [[nodiscard]] bool has_stalled() const noexcept;
  /// Modules that do not exchange process data.
  [[nodiscard]] std::vector<ModuleTrouble> troubles() const;
  /// "U0\G10000 <- node 3 (encoder) TPDO1, 2 words": how process data are connected.
  [[nodiscard]] const std::vector<std::string>& connections() const noexcept;

  struct Parts;  // defined in plant.cpp

 private:
  Plant();
  std::unique_ptr<Parts> parts_;
};

}  // namespace canopus::plant
