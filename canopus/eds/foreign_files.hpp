#pragma once
// Files that are no device files of CANopen, named for the person who opened the wrong one.

#include <string_view>

#include "canopus/eds/ini.hpp"

namespace canopus::eds {

/// "an EtherNet/IP device file", "a PROFIBUS GSD file" ... of a text that is no XML; empty: not known. `file`: its
/// sections.
[[nodiscard]] std::string_view foreign_kind(std::string_view text, const IniFile& file);

}  // namespace canopus::eds
