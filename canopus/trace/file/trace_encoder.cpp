#include "canopus/trace/file/trace_encoder.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/trace/file/candump_log.hpp"
#include "canopus/trace/file/capture_packet.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

using std::chrono::floor;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::string_view csv_head = "time,channel,direction,id,extended,remote,error,dlc,data\n";

char* put_bytes(char* p, const can::Frame& frame) noexcept {
  const char* separator = "";
  for (const std::uint8_t byte : frame.bytes()) {
    p = fmt::format_to(p, "{}{:02X}", separator, byte);
    separator = " ";
  }
  return p;
}

/// A SocketCAN error frame as a row of TRC has it [PEAK CAN TRC File Format]: the terms are those of the SJA1000.
struct TrcError {
  unsigned kind;  ///< 1 bit, 2 form, 4 stuff error, 8 another one
  unsigned received;
  unsigned place, rec, tec;
};

TrcError trc_error(const can::Frame& frame) noexcept {
  constexpr std::uint32_t protocol_error = 0x08;
  const bool has_place = (frame.identifier & protocol_error) != 0;
  const unsigned kind = has_place ? frame.data[2] & 7U : 0U;
  return {.kind = kind != 0 ? kind : 8U,
          .received = has_place && (frame.data[2] & 0x80U) != 0 ? 0U : 1U,
          .place = has_place ? frame.data[3] : 0U,
          .rec = frame.data[7],
          .tec = frame.data[6]};
}

const char* direction_of(const TraceRecord& record) noexcept { return record.transmitted ? "Tx" : "Rx"; }

/// `12.000345`, `-0.000001`: `count` of which `per_unit` make one of what is written.
char* put_decimal(char* p, std::int64_t count, std::int64_t per_unit, int digits, int width) noexcept {
  const bool negative = count < 0;
  const std::uint64_t size =
      negative ? 0 - static_cast<std::uint64_t>(count) : static_cast<std::uint64_t>(count);
  const auto unit = static_cast<std::uint64_t>(per_unit);
  std::array<char, 24> whole{};
  char* end = whole.data();
  if (negative) *end++ = '-';
  end = std::to_chars(end, whole.data() + whole.size(), size / unit).ptr;
  return fmt::format_to(p, "{:>{}}.{:0{}}", std::string_view(whole.data(), end), width, size % unit, digits);
}

/// The start that a head names, to the millisecond; 1970 where it cannot name it.
can::Time start_of(can::Time first) noexcept {
  constexpr can::Time latest(std::chrono::sys_days(std::chrono::year(2261) / 1 / 1).time_since_epoch());
  if (first < can::Time{} || first >= latest) return {};
  return can::Time(floor<milliseconds>(first.time_since_epoch()));
}

struct Clock {
  std::chrono::year_month_day date;
  std::chrono::weekday day;
  std::int64_t hour, minute, second, millisecond;
};

Clock clock_of(can::Time time) noexcept {
  const auto since = floor<milliseconds>(time.time_since_epoch());
  const auto days = floor<std::chrono::days>(since);
  const std::int64_t of_day = (since - days).count();
  const std::chrono::sys_days date(days);
  return {.date = date,
          .day = std::chrono::weekday(date),
          .hour = of_day / 3'600'000,
          .minute = of_day / 60'000 % 60,
          .second = of_day / 1000 % 60,
          .millisecond = of_day % 1000};
}

char* put_asc_head(char* p, can::Time start) noexcept {
  constexpr std::array days{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array months{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                              "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const Clock clock = clock_of(start);
  p = fmt::format_to(p, "date {} {} {:02} {:02}:{:02}:{:02}.{:03} {} {}\n", days[clock.day.c_encoding()],
                     months[static_cast<unsigned>(clock.date.month()) - 1],
                     static_cast<unsigned>(clock.date.day()), (clock.hour + 11) % 12 + 1, clock.minute,
                     clock.second, clock.millisecond, clock.hour < 12 ? "am" : "pm",
                     static_cast<int>(clock.date.year()));
  return fmt::format_to(p, "base hex  timestamps absolute\nno internal events logged\n");
}

/// What stands above the rows of a version.
struct TrcHead {
  std::string_view version;  ///< "" has neither this line nor that of the start
  std::string_view columns;
  std::string_view table;
};

constexpr std::array<TrcHead, trc_version_names.size()> trc_heads{
    TrcHead{"", "",
            ";\r\n;   Message Number\r\n"
            ";   |         Time Offset (ms)\r\n"
            ";   |         |         ID (hex)\r\n"
            ";   |         |         |     Data Length Code\r\n"
            ";   |         |         |     |   Data Bytes (hex) ...\r\n"
            ";----+-   ---+---  ----+---  +  -+ -- -- -- -- -- -- --\r\n"},
    TrcHead{";$FILEVERSION=1.1\r\n", "",
            ";\r\n;   Message Number\r\n"
            ";   |         Time Offset (ms)\r\n"
            ";   |         |        Type\r\n"
            ";   |         |        |        ID (hex)\r\n"
            ";   |         |        |        |     Data Length Code\r\n"
            ";   |         |        |        |     |   Data Bytes (hex) ...\r\n"
            ";---+--   ----+----  --+--  ----+---  +  -+ -- -- -- -- -- -- --\r\n"},
    TrcHead{";$FILEVERSION=2.0\r\n", ";$COLUMNS=N,O,T,I,d,l,D\r\n",
            ";-------------------------------------------------------------------------------\r\n"
            ";   Message   Time    Type ID     Rx/Tx\r\n"
            ";   Number    Offset  |    [hex]  |  Data Length\r\n"
            ";   |         [ms]    |    |      |  |  Data [hex] ...\r\n"
            ";   |         |       |    |      |  |  |\r\n"
            ";---+-- ------+------ +- --+----- +- +- +- -- -- -- -- -- -- --\r\n"},
    TrcHead{";$FILEVERSION=2.1\r\n", ";$COLUMNS=N,O,T,B,I,d,R,L,D\r\n",
            ";-------------------------------------------------------------------------------\r\n"
            ";   Message   Time    Type    ID     Rx/Tx\r\n"
            ";   Number    Offset  |  Bus  [hex]  |  Reserved\r\n"
            ";   |         [ms]    |  |    |      |  |  Data Length Code\r\n"
            ";   |         |       |  |    |      |  |  |    Data [hex] ...\r\n"
            ";   |         |       |  |    |      |  |  |    |\r\n"
            ";---+-- ------+------ +- +- --+----- +- +- +--- +- -- -- -- -- -- -- --\r\n"}};

/// Days since 1899-12-30 as ;$STARTTIME has them.
char* put_trc_start(char* p, can::Time start) noexcept {
  constexpr std::int64_t days_before_1970 = 25569;
  const std::int64_t since = floor<milliseconds>(start.time_since_epoch()).count();
  // a day has 86.4 million ms: 15 decimals of a day are exact to far below 1 us
  __extension__ using Wide = unsigned __int128;
  const auto of_day = static_cast<std::uint64_t>(since % 86'400'000);
  const auto fraction =
      static_cast<std::uint64_t>((Wide{of_day} * 1'000'000'000'000'000U + 43'200'000U) / 86'400'000U);
  return fmt::format_to(p, ";$STARTTIME={}.{:015}\r\n", since / 86'400'000 + days_before_1970, fraction);
}

char* put_trc_head(char* p, can::Time start, TrcVersion version) noexcept {
  const TrcHead& head = trc_heads[static_cast<std::size_t>(version)];
  const Clock clock = clock_of(start);
  if (!head.version.empty()) p = put_trc_start(fmt::format_to(p, "{}", head.version), start);
  p = fmt::format_to(
      p, "{};\r\n;   Start time: {:02}.{:02}.{} {:02}:{:02}:{:02}.{:03}{}\r\n;   Generated by Canopus\r\n",
      head.columns, static_cast<unsigned>(clock.date.day()), static_cast<unsigned>(clock.date.month()),
      static_cast<int>(clock.date.year()), clock.hour, clock.minute, clock.second, clock.millisecond,
      head.version.empty() ? "" : ".000");
  return fmt::format_to(p, "{}", head.table);
}

}  // namespace

std::string_view TraceEncoder::begin() noexcept {
  switch (format_) {
    case FileFormat::pcap:
      std::ranges::copy(pcap_header(), octets(0).begin());
      return {buffer_.data(), pcap_header_size};
    case FileFormat::pcapng:
      std::ranges::copy(pcapng_header(), octets(0).begin());
      return {buffer_.data(), pcapng_header_size};
    case FileFormat::csv: return csv_head;
    default: return {};
  }
}

std::string_view TraceEncoder::encode(std::string_view channel, const TraceRecord& record) noexcept {
  std::size_t size = 0;
  char* const out = buffer_.data();
  switch (format_) {
    case FileFormat::candump: size = write_candump_line(buffer_, channel, record); break;
    case FileFormat::pcap: size = write_pcap_record(octets(0), record); break;
    case FileFormat::pcapng: {
      const std::size_t before = channels_.size();
      const std::uint16_t interface = channels_.number_of(channel).value_or(0);
      if (channels_.size() > before) size = write_pcapng_interface(octets(0), channel);
      size += write_pcapng_packet(octets(size), interface, record);
      break;
    }
    case FileFormat::asc:
      size = put_head(record.time);
      size += put_asc(out + size, number_of(channel), record);
      break;
    case FileFormat::trc:
      size = put_head(record.time);
      size += trc_version_ == TrcVersion::v1_0   ? put_trc_1_0(out + size, record)
              : trc_version_ == TrcVersion::v1_1 ? put_trc_1_1(out + size, record)
                                                 : put_trc(out + size, number_of(channel), record);
      break;
    case FileFormat::csv: size = put_csv(out, channel, record); break;
    default: break;  // formats that are read only
  }
  return {out, size};
}

std::string_view TraceEncoder::end() noexcept {
  if (format_ != FileFormat::asc && format_ != FileFormat::trc) return {};
  return {buffer_.data(), put_head(can::Time{})};
}

/// can0 is 1, can1 is 2 ..., other names get the numbers that are free.
std::uint32_t TraceEncoder::number_of(std::string_view channel) noexcept {
  const std::size_t before = channels_.size();
  const std::uint16_t index = channels_.number_of(channel).value_or(0);
  if (channels_.size() == before) return numbers_[index];
  const auto wanted =
      channel.starts_with("can") ? ascii::parse_number<std::uint32_t>(channel.substr(3)) : std::nullopt;
  std::uint32_t number = wanted && *wanted < 255 ? *wanted + 1 : 1;
  while (number < 255 && std::ranges::find(numbers_, number) != numbers_.end()) ++number;
  numbers_.push_back(number);
  return number;
}

std::size_t TraceEncoder::put_head(can::Time first) noexcept {
  if (start_) return 0;
  start_ = start_of(first);
  char* const out = buffer_.data();
  const char* end =
      format_ == FileFormat::asc ? put_asc_head(out, *start_) : put_trc_head(out, *start_, trc_version_);
  return static_cast<std::size_t>(end - out);
}

std::size_t TraceEncoder::put_asc(char* out, std::uint32_t channel, const TraceRecord& record) noexcept {
  const can::Frame& frame = record.frame;
  const auto since =
      floor<microseconds>(record.time.time_since_epoch()) - floor<microseconds>(start_->time_since_epoch());
  char* p = put_decimal(out, since.count(), 1'000'000, 6, 4);
  if (record.error_frame) {
    p = fmt::format_to(p, " {}  ErrorFrame\n", channel);
    return static_cast<std::size_t>(p - out);
  }
  std::array<char, 12> identifier{};
  const char* end = fmt::format_to(identifier.data(), "{:X}{}", frame.identifier, frame.extended ? "x" : "");
  p = fmt::format_to(p, " {}  {:<15} {}   {} {:x}", channel, std::string_view(identifier.data(), end),
                     direction_of(record), frame.remote ? 'r' : 'd', frame.dlc);
  if (frame.length() > 0) *p++ = ' ';
  p = put_bytes(p, frame);
  *p++ = '\n';
  return static_cast<std::size_t>(p - out);
}

std::size_t TraceEncoder::put_trc(char* out, std::uint32_t channel, const TraceRecord& record) noexcept {
  const can::Frame& frame = record.frame;
  const bool has_bus = trc_version_ == TrcVersion::v2_1;
  const auto since =
      floor<microseconds>(record.time.time_since_epoch()) - floor<microseconds>(start_->time_since_epoch());
  char* p = fmt::format_to(out, "{:>7} ", ++messages_);
  p = put_decimal(p, since.count(), 1000, 3, 9);
  p = fmt::format_to(p, " {}", record.error_frame ? "ER" : frame.remote ? "RR" : "DT");
  if (has_bus) p = fmt::format_to(p, " {:>2}", channel);
  if (record.error_frame) {
    const TrcError error = trc_error(frame);
    p = has_bus ? fmt::format_to(p, "         - {} -  5    ", direction_of(record))
                : fmt::format_to(p, "          {}    ", direction_of(record));
    p = fmt::format_to(p, "{:02X} {:02X} {:02X} {:02X} {:02X}\r\n", error.kind, error.received, error.place,
                       error.rec, error.tec);
    return static_cast<std::size_t>(p - out);
  }
  p = frame.extended ? fmt::format_to(p, " {:08X}", frame.identifier)
                     : fmt::format_to(p, "     {:04X}", frame.identifier);
  p = has_bus ? fmt::format_to(p, " {} -  {:<4} ", direction_of(record), frame.dlc)
              : fmt::format_to(p, " {} {:<2} ", direction_of(record), frame.dlc);
  p = put_bytes(p, frame);
  *p++ = '\r';
  *p++ = '\n';
  return static_cast<std::size_t>(p - out);
}

/// `     2)      1841      0123  2  01 02`; errors have their kind as identifier, and ERROR before four bytes.
std::size_t TraceEncoder::put_trc_1_0(char* out, const TraceRecord& record) noexcept {
  const can::Frame& frame = record.frame;
  const auto since =
      floor<milliseconds>(record.time.time_since_epoch()) - floor<milliseconds>(start_->time_since_epoch());
  char* p = fmt::format_to(out, "{:>6}) {:>9}  ", ++messages_, since.count());
  if (record.error_frame) {
    const TrcError error = trc_error(frame);
    p = fmt::format_to(p, "    {:04X}  4  ERROR {:02X} {:02X} {:02X} {:02X}\r\n", error.kind, error.received,
                       error.place, error.rec, error.tec);
    return static_cast<std::size_t>(p - out);
  }
  p = frame.extended ? fmt::format_to(p, "{:08X}", frame.identifier)
                     : fmt::format_to(p, "    {:04X}", frame.identifier);
  p = fmt::format_to(p, "  {}  {}", frame.dlc, frame.remote ? "RTR" : "");
  p = put_bytes(p, frame);
  *p++ = '\r';
  *p++ = '\n';
  return static_cast<std::size_t>(p - out);
}

/// `     2)      1841.5  Rx         0123  2  01 02`; errors have their kind as identifier and four bytes.
std::size_t TraceEncoder::put_trc_1_1(char* out, const TraceRecord& record) noexcept {
  using TenthsOfAMillisecond = std::chrono::duration<std::int64_t, std::ratio<1, 10'000>>;
  const can::Frame& frame = record.frame;
  const auto since = floor<TenthsOfAMillisecond>(record.time.time_since_epoch()) -
                     floor<TenthsOfAMillisecond>(start_->time_since_epoch());
  char* p = fmt::format_to(out, "{:>6}) ", ++messages_);
  p = put_decimal(p, since.count(), 10, 1, 9);
  if (record.error_frame) {
    const TrcError error = trc_error(frame);
    p = fmt::format_to(p, "  Error      {:04X}  4  {:02X} {:02X} {:02X} {:02X}\r\n", error.kind,
                       error.received, error.place, error.rec, error.tec);
    return static_cast<std::size_t>(p - out);
  }
  p = frame.extended ? fmt::format_to(p, "  {}     {:08X}", direction_of(record), frame.identifier)
                     : fmt::format_to(p, "  {}         {:04X}", direction_of(record), frame.identifier);
  p = fmt::format_to(p, "  {}  {}", frame.dlc, frame.remote ? "RTR" : "");
  p = put_bytes(p, frame);
  *p++ = '\r';
  *p++ = '\n';
  return static_cast<std::size_t>(p - out);
}

std::size_t TraceEncoder::put_csv(char* out, std::string_view channel, const TraceRecord& record) noexcept {
  const can::Frame& frame = record.frame;
  char* p = put_decimal(out, record.time.time_since_epoch().count(), 1'000'000'000, 9, 1);
  *p++ = ',';
  const bool quoted = channel.find_first_of(",;\"") != std::string_view::npos;
  if (quoted) *p++ = '"';
  for (const char c : channel.substr(0, ChannelNames::max_name)) {
    if (c == '"') *p++ = '"';
    *p++ = static_cast<unsigned char>(c) < ' ' ? '_' : c;
  }
  if (quoted) *p++ = '"';
  p = fmt::format_to(p, ",{},0x{:X},{:d},{:d},{:d},{},", direction_of(record), frame.identifier,
                     frame.extended, frame.remote, record.error_frame, frame.dlc);
  p = put_bytes(p, frame);
  *p++ = '\n';
  return static_cast<std::size_t>(p - out);
}

}  // namespace canopus::trace
