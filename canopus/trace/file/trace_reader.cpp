#include "canopus/trace/file/trace_reader.hpp"

#include <array>
#include <utility>

#include "canopus/ascii/words.hpp"
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
};

/// The format that a line gives away, if any.
std::optional<FileFormat> format_of_line(std::string_view line) {
  if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  Words words(line);
  const std::string_view first = words.next();
  if (first.empty()) return std::nullopt;
  if (first.front() == ';') return FileFormat::trc;
  const std::string_view name = first.substr(0, first.find_first_of(",;"));
  if (name.size() < first.size() &&
      (equal_ignoring_case(name, "time") || equal_ignoring_case(name, "timestamp"))) {
    return FileFormat::csv;
  }
  if ((equal_ignoring_case(first, "date") || equal_ignoring_case(first, "base") ||
       equal_ignoring_case(first, "begin")) &&
      !words.peek().empty()) {
    return FileFormat::asc;
  }
  if (first.front() == '(') return FileFormat::candump;
  // candump without times: "can0  601   [8]  40 ..."
  const std::size_t bracket = line.find('[');
  if (bracket != std::string_view::npos && line.substr(bracket).find(']') < 4) return FileFormat::candump;
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

}  // namespace

OpenedReader open_reader(TraceInput input, std::optional<FileFormat> format) {
  std::string_view begin = input.peek(4);
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
    const bool gzip = begin.starts_with("\x1F\x8B"sv);
    return std::unexpected(input.name() + (gzip ? ": expected a trace, found a gzip file; gunzip it first"
                                                : ": expected a trace: candump log, pcap, pcapng, ASC, TRC, "
                                                  "CSV or BLF"));
  }
  switch (*format) {
    case FileFormat::candump: return open_candump(std::move(input));
    case FileFormat::pcap: return open_pcap(std::move(input));
    case FileFormat::pcapng: return open_pcapng(std::move(input));
    case FileFormat::asc: return open_asc(std::move(input));
    case FileFormat::trc: return open_trc(std::move(input));
    case FileFormat::csv: return open_csv(std::move(input));
    case FileFormat::blf: return open_blf(std::move(input));
  }
  return std::unexpected(input.name() + ": expected one of the formats");
}

OpenedReader open_trace(const std::string& path, std::optional<FileFormat> format, KeepReading keep_reading) {
  auto input = TraceInput::open(path, std::move(keep_reading));
  if (!input) return std::unexpected(std::move(input.error()));
  return open_reader(std::move(*input), format);
}

}  // namespace canopus::trace
