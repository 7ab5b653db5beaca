#pragma once
// The plant file: buses, nodes and PLCs, in TOML. Reading it finds every mistake at once, each with line and
// column, what was found and what was expected; it opens no file but those of projects that buses name, and
// starts nothing. docs/plant-file.md is the reference for people.

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/link/allow_list.hpp"
#include "canopus/link/bus_address.hpp"
#include "canopus/module/interface/module_types.hpp"
#include "canopus/plant/file/lift_section.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/plc/execution/program_tasks.hpp"
#include "canopus/plc/melsec/port_settings.hpp"
#include "canopus/plc/modbus/settings.hpp"
#include "canopus/sim/bus/controller/bit_timing.hpp"
#include "canopus/sim/bus/faults/fault.hpp"
#include "canopus/sim/bus/line/line.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/object_value.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::plant {

/// The download of CANopen Builder for a function card: [plc.module.download] [AS-FCOPM 10.6].
struct DownloadSection {
  text::Place place{};
  bool is_slave = false;                            ///< work_mode = "slave"
  std::optional<std::uint8_t> wrong_node_id{};      ///< node_id: 0, or 128 to 255
  std::optional<can::Duration> again_at{};          ///< when the same is downloaded once more
  std::optional<std::uint16_t> cycle_period{};      ///< ms
  std::optional<std::uint16_t> master_heartbeat{};  ///< ms
  struct Object {
    text::Place place{};
    text::ObjectName object{};
  };
  struct Pdo {
    text::Place place{};
    std::uint16_t number = 1;
    std::uint8_t type = 255;
    std::optional<std::uint16_t> cob_id{};
    std::optional<std::uint16_t> inhibit_time{};  ///< 100 us
    std::optional<std::uint16_t> event_timer{};   ///< ms
    std::vector<Object> objects{};
  };
  /// A slave of the node list: [[plc.module.download.slave]].
  struct Slave {
    text::Place place{};
    text::Place eds_place{};
    std::uint8_t node = 0;
    std::string eds{};  ///< of a node outside of the plant, or of what is expected there
    std::optional<std::uint16_t> heartbeat{};           ///< ms
    std::optional<std::uint16_t> heartbeat_time_out{};  ///< ms
    std::vector<Pdo> rx_pdos{};
    std::vector<Pdo> tx_pdos{};
    std::vector<text::ObjectSetting> auto_sdos{};
  };
  std::vector<Slave> slaves{};
};

/// A buffer memory word and the value it gets before power-on.
struct BufferSetting {
  text::Place place{};
  std::uint32_t address = 0;
  std::uint16_t value = 0;
};

/// A value that moves by itself.
struct BehaviourSection {
  text::Place place{};
  text::ObjectName object{};
  std::string kind{};  ///< sine ramp counter echo noise
  std::optional<double> low{};
  std::optional<double> high{};
  std::optional<double> step{};
  std::optional<can::Duration> period{};
  std::optional<text::ObjectName> source{};  ///< of an echo
  std::optional<std::uint64_t> seed{};
};

/// Something that happens to a device's values once or by a condition; the plant's assembly checks that the
/// device has the objects. Objects are written as an index and sub-index, or by their names.
struct ScriptSection {
  text::Place place{};
  std::optional<can::Duration> at{};  ///< plant time; none: `when`
  std::string when{};                 ///< "6000:01 >= 3"
  text::Place when_place{};
  std::string set{};  ///< object that is forced
  text::Place set_place{};
  text::Scalar value{};
  std::optional<can::Duration> hold{};  ///< `for`; none: until it is released
  std::string release{};                ///< object, or "all"
  text::Place release_place{};
};

/// Values of a device that come from a CSV file.
struct PlaybackSection {
  text::Place place{};
  text::Place file_place{};
  std::string file{};  ///< path, relative to the plant file
  bool repeat = false;
};

/// The drive that a device is: [device.drive].
struct DriveSection {
  text::Place place{};
  double start = 0;                    ///< position of its axis at power-on
  std::optional<double> low_switch{};  ///< where its limit switches act; none: it has none
  std::optional<double> high_switch{};
  double revolution = 10'000;  ///< between two index pulses
  struct Fault {
    can::Duration at{};
    std::uint16_t code = 0;  ///< of 603FH and EMCY
  };
  std::vector<Fault> faults{};
};

/// A fault of a bus. Fields that its kind does not use are refused.
struct FaultSection {
  text::Place place{};
  sim::Fault fault{};
  std::string text{};  ///< its keys, as TOML
};

/// A bus's length and its nodes' timing, [bus.line]. canopus check reckons with it.
struct LineSection {
  text::Place place{};
  bool is_exact = false;  ///< the simulated bus has it, too; else no length, and clocks are perfect
  double length = 0;      ///< m, between the two nodes furthest apart
  double stub = 0;        ///< m, the longest
  double nanoseconds_per_metre = 5;      ///< 5: copper with polyethylene
  can::Duration transceiver_delay{120};  ///< of a node's driver and another one's receiver together
  double clock_ppm = 100;                ///< the most a node's clock is off, either way
  sim::BitTiming timing{};               ///< of every node, without problem()
  struct Node {
    text::Place place{};
    sim::Line::Node node{};
  };
  std::vector<Node> nodes{};
};

struct BusSection {
  text::Place place{};
  text::Place serve_place{};
  std::string name{};
  std::uint32_t bit_rate = 0;                     ///< bit/s
  std::optional<text::HostAndPort> socketcand{};  ///< from serve = "socketcand:127.0.0.1:29536"
  link::AllowList allowed{};                      ///< clients that may connect there
  bool announced = false;                         ///< by socketcand's service discovery
  std::vector<FaultSection> faults{};
  std::optional<LineSection> line{};
  text::Place project_place{};
  std::string project{};  ///< path of a CiA 306 nodelist.cpj, relative to the plant file; empty: none
  std::size_t project_network = 1;  ///< which of its networks
  text::Place link_place{};
  std::string link{};  ///< as written: "socketcan:can0", "replay:run.log"; empty or "sim": simulated
  std::optional<link::BusAddress> address{};  ///< of a bus of this machine or of another program
  std::string replay{};                       ///< path of a trace, relative to the plant file
  std::string replay_channel{};               ///< of that trace; empty: all of them

  bool link_by_option = false;  ///< of the command line, in place of the file's
  bool is_bridged = false;      ///< with another bus of the plant

  [[nodiscard]] bool is_linked() const noexcept { return address.has_value() || !replay.empty(); }
  /// The bus may have nodes that the plant file does not list.
  [[nodiscard]] bool may_have_others() const noexcept {
    return socketcand.has_value() || is_linked() || is_bridged;
  }
};

/// `link` of a bus, as a plant file has it. The error is a sentence.
[[nodiscard]] std::expected<void, std::string> set_link(BusSection& bus, std::string_view text);

/// In place of a node-ID: an LSS master will give it one.
inline constexpr std::uint8_t no_node_id = 0xFF;

/// Identifiers from `first` to `last`, both included.
struct IdentifierRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// Frames of one bus that come to another.
struct BridgeSection {
  bool usable = true;
  text::Place place{};
  std::string from{};
  std::string to{};
  bool both_ways = false;
  std::vector<IdentifierRange> identifiers{};  ///< of 11 bits; with those of 29 bits empty: everything
  std::vector<IdentifierRange> extended{};     ///< of 29 bits

  [[nodiscard]] bool passes(const can::Frame& frame) const noexcept;
};

struct DeviceSection {
  bool usable = true;  ///< false: a mistake is reported that leaves nothing to build
  text::Place place{};
  text::Place eds_place{};
  text::Place store_place{};
  std::string bus{};
  std::string name{};
  std::string eds{};                 ///< path, relative to the plant file
  std::uint8_t node = 0;             ///< 1..127; 0 = from the DCF; or no_node_id
  std::optional<bool> lss{};         ///< is an LSS slave; default: LSS_Supported of the device file
  can::Duration start{};             ///< powers up this long after the run's start
  std::string store{};               ///< folder for what 1010H saves; empty = it does not survive the run
  std::uint32_t bit_rate = 0;        ///< bit/s; 0 = the bus's. Another one than the bus's destroys frames
  bool listen_only = false;          ///< its controller receives, but drives no bit
  bool transmit_fifo = false;        ///< its controller sends in the order of queueing, not of identifiers
  std::size_t transmit_queue = 128;  ///< frames that may wait in it
  bool short_sdo_requests = false;   ///< its SDO server accepts requests with a DLC below 8
  std::vector<text::ObjectSetting> objects{};
  std::vector<BehaviourSection> behaviours{};
  std::vector<ScriptSection> scripts{};
  std::vector<PlaybackSection> playbacks{};
  std::optional<DriveSection> drive{};
  std::optional<LiftUnitSection> lift{};  ///< it is a device of a [[lift]], and has no file
};

/// A slave of a master module, and the PDOs that connect the two: a device or another module of the plant, or
/// a node outside of it.
struct SlaveSection {
  bool usable = true;  ///< false: a mistake is reported
  text::Place place{};
  text::Place eds_place{};
  std::uint8_t node = 0;  ///< 0: by `name`, of a device that has it from its DCF
  std::string name{};     ///< of a device or module, instead of `node`
  std::string eds{};      ///< of a node outside of the plant: path, relative to the plant file
  bool mandatory = true;
  struct Link {
    text::Place place{};
    std::uint16_t pdo = 1;                   ///< PDO number of the slave, from 1
    std::optional<std::uint32_t> address{};  ///< first buffer memory word; none = the next free one
  };
  std::vector<Link> receive{};  ///< TPDOs of the slave into the module's receive words
  std::vector<Link> send{};     ///< RPDOs of the slave from the module's transmit words
};

/// Parameters that the engineering tools have written to the CPU for a module: [plc.module.parameters].
struct ParametersSection {
  text::Place place{};
  std::vector<BufferSetting> buffer{};
  std::vector<text::ObjectSetting> objects{};
  /// Settings of another node, which become its concise DCF: [[plc.module.parameters.node]].
  struct Node {
    text::Place place{};
    std::uint8_t node = 0;
    text::Place eds_place{};
    std::string eds{};  ///< of a node outside of the plant
    std::vector<text::ObjectSetting> objects{};
  };
  std::vector<Node> nodes{};
  bool refresh = false;  ///< data_exchange = "refresh"
  text::Place refresh_place{};
  /// refresh = { G10000 = "D1000" }: 64 words each.
  struct Block {
    text::Place place{};
    std::uint32_t address = 0;
    std::optional<plc::Device> device{};  ///< none: a module label
    std::uint32_t number = 0;
  };
  /// 1 to 64: when the programs of this group are executed; none: at the END of each scan.
  std::optional<std::uint8_t> refresh_group{};
  text::Place refresh_group_place{};
  std::vector<Block> blocks{};
};

struct ModuleSection {
  bool usable = true;  ///< false: a mistake is reported that leaves nothing to build
  text::Place place{};
  text::Place name_place{};
  std::string name{};  ///< for people; empty: model and slot
  std::string model{};
  std::uint16_t head = 0;  ///< head I/O number, in points; FX, AS300: 16 times the module's number
  std::string bus{};
  std::uint8_t node = 0;
  bool master = false;
  text::Place slaves_place{};
  /// slaves = "all": every device and every other module of the bus, first TPDO and RPDO of each
  bool all_slaves = false;
  std::vector<SlaveSection> slaves{};
  std::optional<can::Duration> exchange{};      ///< cycle of the built-in program's data exchange
  bool recover = true;                          ///< it does what keeps process data going
  std::optional<can::Duration> restart_time{};  ///< instead of the module's own 6 s
  std::vector<text::ObjectSetting> objects{};
  std::vector<BufferSetting> buffer{};
  bool online = false;  ///< the built-in program takes the module online whenever it has started (Layer 2)
  std::optional<ParametersSection> parameters{};
  std::optional<DownloadSection> download{};
  std::vector<BufferSetting> writes{};  ///< and writes these words before, by address
  module::ModuleFault fault = module::ModuleFault::hardware_error;
  std::optional<can::Duration> fault_at{};  ///< when the module gets this fault
  std::vector<std::uint32_t> watch{};       ///< buffer memory words whose changes are reported
};

/// A port of a PLC for the MC protocol: [[plc.port]], or the key listen of a [[plc]].
struct MelsecPortSection {
  text::Place place{};  ///< where its address is written
  text::HostAndPort listen{};
  link::AllowList allowed{};  ///< clients that may connect
  bool udp = false;
  plc::melsec::PortSettings settings{};
  std::optional<link::AllowList> writers{};  ///< clients that may write; none: all that may connect
};

/// A port of a PLC for Modbus TCP: [[plc.modbus]].
struct ModbusPortSection {
  text::Place place{};  ///< where its address is written
  text::HostAndPort listen{};
  link::AllowList allowed{};  ///< clients that may connect
  plc::modbus::Settings settings{};
  std::optional<link::AllowList> writers{};  ///< clients that may write; none: all that may connect
  struct BufferRange {
    text::Place place{};
    std::uint16_t head = 0;
  };
  std::vector<BufferRange> buffer_ranges{};  ///< those of its ranges that need a module
};

/// A program of the CPU, as its parameters have it: [[plc.program]]. It does nothing but refresh the modules of its group.
struct ProgramSection {
  text::Place place{};
  std::string name{};
  std::uint8_t refresh_group = 0;           ///< 1 to 64
  std::optional<can::Duration> interval{};  ///< fixed scan execution type; none: executed once a scan
};

/// A source file of the program that the CPU runs, or a library: program = ["main.st", "lib:canopen"].
struct ProgramFile {
  static constexpr std::string_view library = "lib:";  ///< what the name of a library begins with
  text::Place place{};
  std::string path{};  ///< as written: relative to the plant file
};

/// When some of its PROGRAMs are executed: [[plc.task]].
struct TaskSection {
  text::Place place{};
  std::vector<text::Place> program_places{};  ///< of each name in task.programs
  plc::ProgramTask task{};
};

struct PlcSection {
  text::Place place{};
  text::Place store_place{};
  std::string name{};
  std::vector<MelsecPortSection> ports{};
  std::vector<ModbusPortSection> modbus_ports{};
  plc::CpuModel cpu_model = plc::r04cpu();  ///< with the points of the devices that the file sets
  /// X and Y are refreshed once a scan of this length; none: at once, or with a program in an estimated time
  std::optional<can::Duration> scan{};
  bool run = true;
  std::string store{};  ///< folder for what the modules save; empty = nothing survives the run
  std::optional<can::Duration> cpu_error{};  ///< when the CPU stops with an error
  std::vector<ProgramSection> programs{};
  std::vector<ProgramFile> program_files{};
  std::vector<ProgramFile> label_files{};  ///< labels = ["labels.csv"]
  std::vector<TaskSection> tasks{};
  std::optional<can::Duration>
      watchdog{};  ///< the longest execution of a scan's programs; none: the family's
  bool allows_native_code =
      false;  ///< no key of the file: the user of the run permits programs as shared objects
  std::vector<ModuleSection> modules{};
};

struct PlantFile {
  std::string path{};  ///< as given
  std::string name{};
  std::uint64_t seed = 1;
  text::Place control_place{};
  std::optional<text::HostAndPort> control{};  ///< where the control server listens
  link::AllowList control_allowed{};           ///< clients that may connect there
  std::vector<BusSection> buses{};
  std::vector<BridgeSection> bridges{};
  std::vector<DeviceSection> devices{};
  std::vector<PlcSection> plcs{};
  std::vector<LiftSection> lifts{};  ///< their devices are among the others, behind them
};

/// The name of a port's protocol: "MC protocol", "MC protocol 1E UDP".
[[nodiscard]] std::string protocol_name(const MelsecPortSection& port);

/// Reads a plant file's text. With errors, `plant` holds what could be read: it may be built, to find what
/// else is wrong, and must not be started.
struct PlantReading {
  PlantFile plant;
  std::vector<text::FileError> errors{};
};
[[nodiscard]] PlantReading read_plant(std::string_view text, std::string path);

/// "ME3CAN1-Q U0", or the name it has in the plant file.
[[nodiscard]] std::string shown_name(const ModuleSection& module);

}  // namespace canopus::plant
