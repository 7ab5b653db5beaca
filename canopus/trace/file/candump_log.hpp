#pragma once
// The text log of can-utils, one frame per line. Written and read: the log form of `candump -l`
//
//   (0000000012.000345) line1 601#4018100100000000     data frame, base identifier
//   (0000000012.000345) line1 00000601#4018            data frame, extended identifier: 8 digits
//   (0000000012.000345) line1 601#R                    remote frame; `R4` asks for 4 bytes
//   (0000000012.000345) line1 601#0011223344556677_F   8 bytes with the raw DLC 15
//   (0000000012.000345) line1 20000004#0001000000000000   error frame: class and data
//   (0000000012.000345) line1 601#40 T                 sent by the recorder
//
// Read only: the screen form of candump, `(12.000345)  line1  601   [8]  40 18 10 01 00 00 00 00`, with or
// without the ASCII column (-a), the direction (-x) and the time, and `remote request` in place of the data; a
// time as date and time of day (-tA), `(2024-02-29 12:00:00.000345)`, which is taken as UTC; the raw DLC (-8),
// `{F}`; data in binary (-i), `01000000`; the last byte first (-S), with a grave accent between bytes.

#include <cstddef>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "canopus/can/frame.hpp"
#include "canopus/can/time.hpp"
#include "canopus/trace/file/left_out.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::trace {

/// Longest channel name that is written; a longer one is cut.
inline constexpr std::size_t candump_max_channel = 32;
/// Room that write_candump_line() needs at most, line end included.
inline constexpr std::size_t candump_max_line = 96;

/// Writes one line of the log form, '\n' included, and returns its length. `out` holds at least
/// candump_max_line characters. Characters of `channel` that would break the line (blanks, control
/// characters, non-ASCII) become '_'; an empty channel becomes "_". Nanoseconds are cut to microseconds.
std::size_t write_candump_line(std::span<char> out, std::string_view channel, const can::Frame& frame,
                               can::Time time) noexcept;
/// The same of a record: an error frame has 2 on top of its class, what was transmitted a T behind it.
std::size_t write_candump_line(std::span<char> out, std::string_view channel,
                               const TraceRecord& record) noexcept;

/// One line of a log.
struct CandumpEntry {
  can::Time time{};  ///< as in the file: seconds since its own zero (often 1970), 0..9223372035.999999999
  std::string channel{};  ///< never empty
  can::Frame frame{};
  bool error_frame = false;  ///< a SocketCAN error frame: `frame` holds its class and data, and is no frame
  bool transmitted = false;  ///< "T" or "TX": sent by the recorder
  bool log_form = false;     ///< `601#40`, not `601 [1] 40`

  friend bool operator==(const CandumpEntry&, const CandumpEntry&) = default;
};

/// The mistake of a line.
struct CandumpError {
  std::size_t line = 0;    ///< as the caller counts them
  std::size_t column = 0;  ///< 1 = first character
  std::string expected{};
  std::string found{};
  std::optional<LeftOutKind> left_out{};  ///< nothing wrong, but a CAN FD or CAN XL frame

  /// `12:22: expected a hexadecimal digit, found 'G'`, to follow the file's name and a colon.
  [[nodiscard]] std::string message() const;
};

/// Reads one line (a trailing "\r", "\n" or both is allowed). `number` is for the error alone.
[[nodiscard]] std::expected<CandumpEntry, CandumpError> read_candump_line(std::string_view line,
                                                                          std::size_t number = 1);

}  // namespace canopus::trace
