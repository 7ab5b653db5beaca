#pragma once
// Libraries of Structured Text that are part of the program: program = ["main.st", "lib:canopen"].

#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/structured_text/compiler.hpp"

namespace canopus::plant {

struct PlcSection;

/// A file of canopus/plant/libraries. Its name says which modules it is for: "canopen/cia405.st" is for all,
/// "canopen/lift.fx3u-can.st" for one. It is written for a module at the first place of a rack: U0\G, X00 and Y00.
struct LibraryFile {
  std::string_view path{};
  std::string_view content{};
};
[[nodiscard]] std::span<const LibraryFile> library_files() noexcept;

/// The sources of "lib:canopen" for the PLC's module, or of "lib:canopen@U4" for that one of several. The error says what was
/// expected.
///
/// `before`: those of the program's other modules. Then all names but types end with the unit, as CIA405_NMT_U4, and types that
/// `before` has are left out.
[[nodiscard]] std::expected<std::vector<structured_text::Source>, std::string> library_sources(
    std::string_view file, const PlcSection& plc, std::span<const structured_text::Source> before = {});

}  // namespace canopus::plant
