#pragma once
// The network file of `canopus master`: which slaves a network has, and how its NMT master treats them, in
// TOML. Reading it finds every mistake at once, each with line and column; it opens no file but those of a project.
// docs/commands.md is the reference for people.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/manager/boot/master_options.hpp"
#include "canopus/manager/nmt/flying_master.hpp"
#include "canopus/text/file_error.hpp"
#include "canopus/text/object_value.hpp"
#include "canopus/text/output.hpp"
#include "canopus/trace/decode/names.hpp"

namespace canopus::master {

/// A slave: an entry of 1F81H, and what is expected of it and downloaded to it.
struct NetworkSlave {
  text::Place place{};
  text::Place eds_place{};
  text::Place objects_place{};
  std::uint8_t node = 0;  ///< 1..127
  std::string name{};
  bool mandatory = true;
  bool keep_alive = false;  ///< not reset while it is Operational
  std::string eds{};        ///< EDS or DCF, relative to the network file; empty = none
  /// Expected identity, 1F84H-1F88H; instead of the device file's. 0 = not compared.
  std::optional<std::uint32_t> device_type{};
  std::optional<std::uint32_t> vendor{};
  std::optional<std::uint32_t> product{};
  std::optional<std::uint32_t> revision{};
  std::optional<std::uint32_t> serial{};
  can::Duration consumer_heartbeat_time{};  ///< 1016H, whole ms up to 65535; 0 = its heartbeat is not watched
  can::Duration guard_time{};               ///< whole ms up to 65535; 0 = not guarded
  std::uint8_t retry_factor = 3;
  std::vector<text::ObjectSetting> objects{};       ///< written to it besides its DCF's configured values
  std::optional<std::uint32_t> software_version{};  ///< 1F55H: what its 1F56:01 must read
  text::Place program_place{};
  std::string program{};     ///< file that it is given when its version is another; empty = none
  std::uint8_t restore = 0;  ///< 1F8AH: 1011H sub-index written before its configuration; 0 = none
};

/// The reaction to an error control event of a mandatory slave.
enum class ErrorReaction : std::uint8_t {
  reset_slave,
  reset_all,  ///< 1F80H bit 4
  stop_all,   ///< 1F80H bit 6
};

struct NetworkFile {
  std::string path{};
  std::string name{};
  std::string project{};  ///< path of a CiA 306 nodelist.cpj, relative to the network file; empty: none
  std::size_t project_network = 1;           ///< which of its networks
  std::uint8_t node = 127;                   ///< of the master
  can::Duration heartbeat{};                 ///< the master's own, 1017H; 0 = none
  std::optional<can::Duration> boot_time{};  ///< 1F89H: mandatory slaves must have booted by then
  bool start_slaves = true;                  ///< slaves are started as they are booted
  bool start_together = false;               ///< 1F80H bit 1: all at once, when all mandatory ones are booted
  ErrorReaction on_error = ErrorReaction::reset_slave;
  can::Duration nmt_inhibit_time{};                     ///< 102AH, whole 100 us
  std::optional<manager::FlyingMasterTiming> flying{};  ///< 1F80H bit 5 and 1F90H
  manager::MasterOptions options{};                     ///< times and attempts of the start-up
  std::vector<NetworkSlave> slaves{};
};

struct NetworkReading {
  NetworkFile network;
  std::vector<text::FileError> errors{};
};
[[nodiscard]] NetworkReading read_network(std::string_view text, std::string path);
/// The network of a CiA 306 project: a mandatory slave for each node that is present, watched by nothing. The manager of the
/// project, if it has one, is the master.
[[nodiscard]] NetworkReading read_project(std::string path);

/// Adds the names of the nodes and objects of this network file, for the decoder. False after its mistakes were printed on `err`.
[[nodiscard]] bool add_network_names(const std::string& path, trace::Names& names, text::Output& err);

}  // namespace canopus::master
