#pragma once
// Sections of a plant file that have a source of their own.

#include <optional>
#include <string_view>

#include "canopus/app/plant_file.hpp"
#include "canopus/app/table_reader.hpp"
#include "canopus/link/allow_list.hpp"

namespace canopus::app {

/// `allow` of a section whose server listens where its key `key` says; none: it has no server. A server that
/// other machines can reach needs a list.
[[nodiscard]] link::AllowList read_allowed(TableReader& table, std::string_view key,
                                           std::string_view protocol,
                                           const std::optional<HostAndPort>& place);

/// `cpu_model` and `devices` of a [[plc]].
[[nodiscard]] plc::CpuModel read_cpu_model(TableReader& table);

/// A [[bus.fault]].
[[nodiscard]] FaultSection read_fault(TableReader& table);
/// A [[device.script]].
[[nodiscard]] ScriptSection read_script(TableReader& table);
/// A [[device.playback]].
[[nodiscard]] PlaybackSection read_playback(TableReader& table);

}  // namespace canopus::app
