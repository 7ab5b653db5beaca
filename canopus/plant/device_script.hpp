#pragma once
// Scripts and playbacks of a plant file for a device: their objects are looked up in the device, and every
// mistake is reported.

#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/plant/file/plant_file.hpp"
#include "canopus/sim/device/device.hpp"

namespace canopus::plant {

/// "6000:01 >= 3": a process value of the device by object or name, one of == != < <= > >=, and a constant.
[[nodiscard]] std::expected<sim::Condition, std::string> parse_condition(const sim::Device& device,
                                                                         std::string_view text);

/// Gives the device the scripts that are good; the others are errors.
[[nodiscard]] std::vector<text::FileError> add_scripts(sim::Device& device,
                                                       const std::vector<ScriptSection>& scripts);

/// The mistake of a CSV text, and its place.
struct CsvProblem {
  unsigned line = 0;    ///< from 1
  unsigned column = 0;  ///< in octets, from 1
  std::string message;
};

/// The most that a file may have, so that a mistake does not fill the memory.
struct CsvLimits {
  std::size_t bytes = 64U << 20U;
  std::size_t columns = 256;       ///< objects
  std::size_t values = 4'000'000;  ///< rows times objects
};

/// A CSV text as a playback of the device. Header row: anything for the time, then objects or parameters'
/// names; then rows of the time in seconds, rising, and values, an empty one to keep the value before. Fields
/// are separated by what the header row has first of comma, semicolon and tabulator; quotes as in RFC 4180, but
/// no line break in them.
[[nodiscard]] std::expected<sim::Playback, CsvProblem> read_playback_csv(std::string_view text,
                                                                         const sim::Device& device,
                                                                         const CsvLimits& limits = {});

}  // namespace canopus::plant
