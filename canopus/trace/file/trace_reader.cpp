#include "canopus/trace/file/trace_reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/trace/file/csv_head.hpp"
#include "canopus/trace/file/reader_base.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

using ascii::equal_ignoring_case;

using namespace std::string_view_literals;

/// Beyond this no trace begins.
constexpr std::size_t most_looked_at = 65536;

struct Magic {
  std::string_view bytes;
  FileFormat format;
};
constexpr std::array magics{
    Magic{"\x0A\x0D\x0D\x0A"sv, FileFormat::pcapng}, Magic{"\xA1\xB2\xC3\xD4"sv, FileFormat::pcap},
    Magic{"\xD4\xC3\xB2\xA1"sv, FileFormat::pcap},   Magic{"\xA1\xB2\x3C\x4D"sv, FileFormat::pcap},
    Magic{"\x4D\x3C\xB2\xA1"sv, FileFormat::pcap},   Magic{"LOGG"sv, FileFormat::blf},
    Magic{"@ TEXT @"sv, FileFormat::carbus},
};

/// Files that people have beside their traces, and traces that are not read.
struct OtherFile {
  std::string_view begin;
  std::string_view text;
};
constexpr std::array other_files{
    OtherFile{"\x1F\x8B"sv, "a gzip file; gunzip it first"},
    OtherFile{"PK\x03\x04"sv, "a ZIP archive; unzip it first"},
    OtherFile{"\xFD\x37zXZ"sv, "an xz file; unxz it first"},
    OtherFile{"\x28\xB5\x2F\xFD"sv, "a zstd file; unzstd it first"},
    OtherFile{"BZh"sv, "a bzip2 file; bunzip2 it first"},
    OtherFile{"MDF "sv, "an ASAM MDF file (MF4, MDF), which is not read; export it as ASC, BLF or CSV"},
    OtherFile{
        "UnFinMF"sv,
        "an ASAM MDF file (MF4) whose recording was not finished; it is not read, export it as ASC, BLF or "
        "CSV"},
    OtherFile{"SQLite format 3"sv,
              "an SQLite database; python-can's can.logconvert makes a trace of its own"},
    OtherFile{"\xFF\xFE"sv, "text in UTF-16; save it as UTF-8"},
    OtherFile{"\xFE\xFF"sv, "text in UTF-16; save it as UTF-8"},
    OtherFile{"VERSION \""sv, "a DBC file, which describes messages and has no frames"},
    OtherFile{"BU_:"sv, "a DBC file, which describes messages and has no frames"},
    OtherFile{"NS_ :"sv, "a DBC file, which describes messages and has no frames"},
    OtherFile{"<?xml"sv, "an XML file; device files (XDD, XDC) are none"},
    OtherFile{"[FileInfo]"sv, "a device file (EDS, DCF), which has no frames"},
    OtherFile{"[DeviceInfo]"sv, "a device file (EDS, DCF), which has no frames"},
};

bool is_candump_screen_line(std::string_view line) {
  const std::size_t bracket = line.find('[');
  if (bracket != std::string_view::npos && line.substr(bracket).find(']') < 6) return true;
  const std::size_t brace = line.find('{');  // candump -8
  return brace != std::string_view::npos && line.substr(brace).find('}') == 2 && brace > 0 &&
         ascii::is_blank(line[brace - 1]);
}

/// `0.001000 1  601  Rx   d 8 ...`, or a line of another kind that a frame has.
bool is_asc_line(std::string_view first, Words words) {
  if (first.find('.') == std::string_view::npos || !parse_time(first, nanoseconds_per_second)) return false;
  const std::string_view channel = words.next();
  if (channel == "CANFD" || channel == "CANXL") return true;
  if (!ascii::parse_number<std::uint8_t>(channel)) return false;
  if (equal_ignoring_case(words.next(), "ErrorFrame")) return true;
  const std::string_view direction = words.next();
  return equal_ignoring_case(direction, "Rx") || equal_ignoring_case(direction, "Tx");
}

/// `11,391 601      8 40 00 ...`; the head may be missing.
bool is_canhacker_line(std::string_view first, Words words) {
  if (first.size() < 5 || first.find_first_not_of("0123456789,.") != std::string_view::npos) return false;
  const std::string_view identifier = words.next();
  const std::string_view dlc = words.next();
  return (identifier.size() == 3 || identifier.size() == 8) && ascii::is_hex(identifier) && dlc.size() == 1 &&
         ascii::is_digit(dlc.front()) && (dlc == "0" || words.next().size() >= 2);
}

/// A head line with an identifier and data; or one that begins with the time, so that an error says what is missing.
bool is_csv_head(std::string_view line) {
  const std::string_view first = line.substr(0, line.find_first_of(",;"));
  const bool has_time = equal_ignoring_case(first, "time") || equal_ignoring_case(first, "timestamp");
  return (has_time && first.size() < line.size()) || parse_csv_head(line).has_value();
}

/// The format that a line gives away, if any.
std::optional<FileFormat> format_of_line(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  Words words(line);
  const std::string_view first = words.next();
  if (first.empty()) return std::nullopt;
  if (first.front() == ';') return FileFormat::trc;
  if (line.find("***BUSMASTER ") != std::string_view::npos) return FileFormat::busmaster;
  if (line.starts_with("Microchip Technology Inc.")) return FileFormat::microchip;
  if (is_csv_head(line)) return FileFormat::csv;
  if (equal_ignoring_case(first, "time") && Words(words).next() == "ID") return FileFormat::canhacker;
  if ((equal_ignoring_case(first, "date") || equal_ignoring_case(first, "base") ||
       equal_ignoring_case(first, "begin")) &&
      !words.peek().empty()) {
    return FileFormat::asc;
  }
  if (first.front() == '(' || first.starts_with("DROPCOUNT:") || first.front() == escape)
    return FileFormat::candump;  // the last is a colour
  // candump without times: "can0  601   [8]  40 ..."
  if (is_candump_screen_line(line)) return FileFormat::candump;
  if (is_asc_line(first, words)) return FileFormat::asc;
  if (is_canhacker_line(first, words)) return FileFormat::canhacker;
  return std::nullopt;
}

/// Nothing until enough was read to decide the format.
std::optional<FileFormat> format_of(std::string_view begin, bool all) {
  for (const Magic& magic : magics) {
    if (begin.starts_with(magic.bytes)) return magic.format;
  }
  while (!begin.empty()) {
    const std::size_t end = begin.find('\n');
    if (end == std::string_view::npos && !all) return std::nullopt;
    if (const auto format = format_of_line(begin.substr(0, end))) return format;
    begin.remove_prefix(end == std::string_view::npos ? begin.size() : end + 1);
  }
  return std::nullopt;
}

/// What the file is that is no trace that is read; empty: not known.
std::string_view other_file(std::string_view begin) {
  const std::string_view text = begin.substr(std::min(begin.find_first_not_of(" \t\r\n"), begin.size()));
  for (const OtherFile& other : other_files) {
    if (begin.starts_with(other.begin) || text.starts_with(other.begin)) return other.text;
  }
  return {};
}

}  // namespace

OpenedReader open_reader(TraceInput input, std::optional<FileFormat> format) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8; Windows programs write it
  std::string_view begin = input.peek(16);
  if (begin.starts_with(byte_order_mark)) {
    (void)input.skip(byte_order_mark.size());
    begin = input.buffered();
  }
  if (const std::string_view other = other_file(begin); !format && !other.empty())
    return std::unexpected(input.name() + ": expected a trace, found " + std::string(other));
  while (!format) {
    format = format_of(begin, false);
    if (format || begin.size() >= most_looked_at) break;
    const std::size_t before = begin.size();
    begin = input.peek_more();
    if (begin.size() == before) break;
  }
  if (!format) format = format_of(begin, true);
  if (auto failure = input.failure(); failure && begin.empty()) return std::unexpected(std::move(*failure));
  if (!format && begin.empty()) format = FileFormat::candump;  // a log in which nothing happened
  if (!format) {
    return std::unexpected(
        input.name() +
        ": expected a trace: candump log, pcap, pcapng, ASC, TRC, CSV with a head line, BLF, or "
        "a log of BUSMASTER, Microchip's CAN BUS Analyzer, CARBUS Analyzer or CANHacker");
  }
  switch (*format) {
    case FileFormat::candump: return open_candump(std::move(input));
    case FileFormat::pcap: return open_pcap(std::move(input));
    case FileFormat::pcapng: return open_pcapng(std::move(input));
    case FileFormat::asc: return open_asc(std::move(input));
    case FileFormat::trc: return open_trc(std::move(input));
    case FileFormat::csv: return open_csv(std::move(input));
    case FileFormat::blf: return open_blf(std::move(input));
    case FileFormat::busmaster: return open_busmaster(std::move(input));
    case FileFormat::microchip: return open_microchip(std::move(input));
    case FileFormat::carbus: return open_carbus(std::move(input));
    case FileFormat::canhacker: return open_canhacker(std::move(input));
  }
  return std::unexpected(input.name() + ": expected one of the formats");
}

OpenedReader open_trace(const std::string& path, std::optional<FileFormat> format, KeepReading keep_reading) {
  auto input = TraceInput::open(path, std::move(keep_reading));
  if (!input) return std::unexpected(std::move(input.error()));
  return open_reader(std::move(*input), format);
}

}  // namespace canopus::trace
