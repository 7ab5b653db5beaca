#include "canopus/trace/file/file_format.hpp"

#include <algorithm>

#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {

std::string_view name_of(FileFormat format) noexcept {
  return std::ranges::find(format_names, format, &FormatName::format)->name;
}

std::optional<FileFormat> format_of_name(std::string_view name) noexcept {
  const auto* found = std::ranges::find(format_names, name, &FormatName::name);
  if (found == format_names.end()) return std::nullopt;
  return found->format;
}

std::expected<FileFormat, std::string> trace_format_of(std::string_view path) {
  const std::string_view name = path.substr(path.rfind('/') + 1);
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return FileFormat::candump;
  const std::string_view extension = name.substr(dot + 1);
  for (const FormatName& entry : format_names) {
    if (entry.is_written && ascii::equal_ignoring_case(entry.name, extension)) return entry.format;
  }
  const bool number = extension.find_first_not_of("0123456789") == std::string_view::npos;
  if (number || ascii::equal_ignoring_case(extension, "log") || ascii::equal_ignoring_case(extension, "txt"))
    return FileFormat::candump;
  const std::string_view hint =
      ascii::equal_ignoring_case(extension, "blf")   ? "; python-can's can.logconvert makes a BLF file of "
                                                       "an ASC file"
      : ascii::equal_ignoring_case(extension, "vcd") ? "; --vcd records the wire as a waveform"
                                                     : "";
  return std::unexpected(
      std::string(path) +
      ": traces are written as candump log (name.log, or a name without extension), .pcap, "
      ".pcapng, .asc, .trc or .csv, not as ." +
      std::string(extension) + std::string(hint));
}

}  // namespace canopus::trace
