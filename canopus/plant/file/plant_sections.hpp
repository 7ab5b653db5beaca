#pragma once
// Sections of a plant file that have a source of their own.

#include <optional>
#include <string_view>
#include <vector>

#include "canopus/link/allow_list.hpp"
#include "canopus/plant/file/plant_file.hpp"
#include "canopus/text/table_reader.hpp"

namespace canopus::plant {

/// `allow` of a section whose server listens at the address of its key `key`; none: it has no server. A
/// server that other machines can reach needs a list, or a password; with a password alone all clients may
/// connect.
[[nodiscard]] link::AllowList read_allowed(text::TableReader& table, std::string_view key,
                                           std::string_view protocol,
                                           const std::optional<text::HostAndPort>& place,
                                           bool has_password = false);
/// A list of networks as `allow` is one; none: the key is not there.
[[nodiscard]] std::optional<link::AllowList> read_networks(text::TableReader& table, std::string_view key);

/// `listen` of a [[plc]] and its [[plc.port]]: the ports of the MC protocol.
[[nodiscard]] std::vector<MelsecPortSection> read_melsec_ports(text::TableReader& table,
                                                               const plc::CpuModel& model);

/// [[plc.modbus]] of a [[plc]].
[[nodiscard]] std::vector<ModbusPortSection> read_modbus_ports(text::TableReader& table,
                                                               const plc::CpuModel& model);
/// Whether what they map is there.
void check_modbus_modules(const PlcSection& plc, std::vector<text::FileError>& errors);

/// `family`, `cpu_model` and `devices` of a [[plc]].
[[nodiscard]] plc::CpuModel read_cpu_model(text::TableReader& table);
/// The address of a module in a rack of this CPU's family, and a check that it fits; its model has been read.
void read_place(text::TableReader& table, const plc::CpuModel& cpu, ModuleSection& module);

/// Objects { "1017:00" = 100 } and words { G70 = 1000 } of a section.
[[nodiscard]] std::vector<text::ObjectSetting> read_objects(text::TableReader& table, std::string_view key);
[[nodiscard]] std::vector<BufferSetting> read_words(text::TableReader& table, std::string_view key);
/// [plc.module.parameters]; the module's model has been read.
[[nodiscard]] ParametersSection read_parameters(text::TableReader& table, const plc::CpuModel& cpu);
/// [plc.module.download].
[[nodiscard]] DownloadSection read_download(text::TableReader& table);
/// program = ["main.st"] of a [[plc]], and whether it is written so, and not as [[plc.program]].
[[nodiscard]] bool has_program_files(text::TableReader& table);
[[nodiscard]] std::vector<ProgramFile> read_program_files(text::TableReader& table);
/// labels = ["labels.csv"] of a [[plc]] with a program.
[[nodiscard]] std::vector<ProgramFile> read_label_files(text::TableReader& table);
/// [[plc.task]] of a [[plc]] with program = ["main.st"].
[[nodiscard]] std::vector<TaskSection> read_tasks(text::TableReader& table, const plc::CpuModel& cpu);
/// [[plc.program]] of a [[plc]].
[[nodiscard]] std::vector<ProgramSection> read_programs(text::TableReader& table, const plc::CpuModel& cpu);

/// A [[lift]].
[[nodiscard]] LiftSection read_lift(text::TableReader& table);
/// Puts a lift without mistakes, and its devices, into the plant.
void add_lift(PlantFile& plant, LiftSection lift);

/// `link` of a [[bus]], whose other keys have been read.
void read_line(text::TableReader& table, BusSection& bus);
void read_link(text::TableReader& table, BusSection& bus);
/// Adds the nodes of the projects that buses name, and gives devices of such buses the DCFs of theirs. Opens those files.
void add_projects(PlantFile& plant, std::vector<text::FileError>& errors);
/// A [[bridge]].
[[nodiscard]] BridgeSection read_bridge(text::TableReader& table);

/// A [[bus.fault]].
[[nodiscard]] FaultSection read_fault(text::TableReader& table);
/// A [[device.script]].
[[nodiscard]] ScriptSection read_script(text::TableReader& table);
/// [device.drive].
[[nodiscard]] DriveSection read_drive(text::TableReader& table);
/// A [[device.playback]].
[[nodiscard]] PlaybackSection read_playback(text::TableReader& table);

}  // namespace canopus::plant
