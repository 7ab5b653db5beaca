#pragma once
// The formats of traces, by name.

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>

namespace canopus::trace {

/// The formats that are read or written.
enum class FileFormat : std::uint8_t {
  candump,  ///< text log of can-utils, log form and screen form
  pcap,     ///< link type 227 (CAN over SocketCAN), and 113 with its packets
  pcapng,   ///< the same in blocks; each interface is a channel
  asc,      ///< Vector ASC
  trc,      ///< PEAK TRC, versions 1.0 to 2.1
  csv,      ///< as python-can writes it, and our own with a head line
  blf,      ///< Vector BLF, read only
};

/// All of them, with the names of options such as --to.
struct FormatName {
  FileFormat format;
  std::string_view name;
};
inline constexpr std::array format_names{
    FormatName{FileFormat::candump, "candump"}, FormatName{FileFormat::pcap, "pcap"},
    FormatName{FileFormat::pcapng, "pcapng"},   FormatName{FileFormat::asc, "asc"},
    FormatName{FileFormat::trc, "trc"},         FormatName{FileFormat::csv, "csv"},
    FormatName{FileFormat::blf, "blf"}};

[[nodiscard]] std::string_view name_of(FileFormat format) noexcept;
[[nodiscard]] std::optional<FileFormat> format_of_name(std::string_view name) noexcept;

/// The format a file is written in, by its name: ".pcap", ".pcapng", ".asc", ".trc", ".csv"; ".log",
/// ".candump", ".txt", a number (run.1) or no extension are candump. The error lists the formats that can be
/// written.
[[nodiscard]] std::expected<FileFormat, std::string> trace_format_of(std::string_view path);

}  // namespace canopus::trace
