#pragma once
// The formats of traces, by name.

#include <algorithm>
#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>

namespace canopus::trace {

/// The formats that are read or written.
enum class FileFormat : std::uint8_t {
  candump,    ///< text log of can-utils, log form and screen form
  pcap,       ///< link type 227 (CAN over SocketCAN), and 113 with its packets
  pcapng,     ///< the same in blocks; each interface is a channel
  asc,        ///< Vector ASC
  trc,        ///< PEAK TRC, versions 1.0 to 2.1
  csv,        ///< a table with a head line: our own, python-can's, SavvyCAN's (GVRET) and others
  blf,        ///< Vector BLF
  busmaster,  ///< log of BUSMASTER
  microchip,  ///< log of Microchip's CAN BUS Analyzer
  carbus,     ///< trace of CARBUS Analyzer
  canhacker,  ///< trace of CANHacker
};

/// All of them, with the names of options such as --in-format.
struct FormatName {
  FileFormat format;
  std::string_view name;
  bool is_written = false;
};
inline constexpr std::array format_names{FormatName{FileFormat::candump, "candump", true},
                                         FormatName{FileFormat::pcap, "pcap", true},
                                         FormatName{FileFormat::pcapng, "pcapng", true},
                                         FormatName{FileFormat::asc, "asc", true},
                                         FormatName{FileFormat::trc, "trc", true},
                                         FormatName{FileFormat::csv, "csv", true},
                                         FormatName{FileFormat::blf, "blf"},
                                         FormatName{FileFormat::busmaster, "busmaster"},
                                         FormatName{FileFormat::microchip, "microchip"},
                                         FormatName{FileFormat::carbus, "carbus"},
                                         FormatName{FileFormat::canhacker, "canhacker"}};

[[nodiscard]] std::string_view name_of(FileFormat format) noexcept;
[[nodiscard]] std::optional<FileFormat> format_of_name(std::string_view name) noexcept;
/// The others are read alone.
[[nodiscard]] constexpr bool is_written(FileFormat format) noexcept {
  return std::ranges::find(format_names, format, &FormatName::format)->is_written;
}

/// The format a file is written in, by its name: ".pcap", ".pcapng", ".asc", ".trc", ".csv"; ".log",
/// ".candump", ".txt", a number (run.1) or no extension are candump. The error lists the formats that can be
/// written.
[[nodiscard]] std::expected<FileFormat, std::string> trace_format_of(std::string_view path);

}  // namespace canopus::trace
