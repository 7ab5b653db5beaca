#pragma once
// The running program of a PLC as JSON, for those who watch it: its state, its text with the values in it, its variables. Looking
// changes nothing, and is no access of the program.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "canopus/plant/plant.hpp"
#include "canopus/serve/control_message.hpp"

namespace canopus::serve {

/// "main.st" of "/plants/line1/main.st": as it is written in the plant file.
[[nodiscard]] std::string shown_file(const plant::Plant& plant, std::string_view file);
/// The file of the program that is meant by a name as it is shown, or by its path; the error names what was expected.
[[nodiscard]] Result<std::string> program_file(plant::Plant& plant, std::size_t plc, std::string_view shown);

/// "run", "stop", "pause", "off", "halted", "error".
[[nodiscard]] std::string_view program_state(plant::Plant& plant, std::size_t plc);

/// `plc cpu state`, and as far as they apply `halted_at error scan breaks forced tasks files`.
[[nodiscard]] Json program_status(plant::Plant& plant, std::size_t plc);

inline constexpr std::uint32_t most_program_lines = 400;
/// `file from of blocks block lines`: at most `most_program_lines` lines of a source, by its number, from line `from` on.
[[nodiscard]] Json program_lines(plant::Plant& plant, std::size_t plc, std::size_t file, std::uint32_t from,
                                 std::uint32_t count, std::string_view block);

inline constexpr std::size_t most_variables = 256;
/// `from of rows`: single variables whose name, type or comment holds the text, whatever the case of letters.
[[nodiscard]] Json program_variables(plant::Plant& plant, std::size_t plc, std::string_view find,
                                     std::size_t from, std::size_t count);

}  // namespace canopus::serve
