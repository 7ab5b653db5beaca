#pragma once
// The frame around a request and its reply, without its command data.
//
//   3E request  50 00                | network | PC | module I/O | station | length | timer | command |
//                                      subcommand | data
//      reply    D0 00                | network | PC | module I/O | station | length | end code | data
//   4E request  54 00 | serial | 0 0 | network ... as 3E
//      reply    D4 00 | serial | 0 0 | network ... as 3E
//
// `length` counts everything behind it, in bytes or characters. In ASCII the subheader is the text "5000",
// every other field its hexadecimal text. [SH-080008 4.1]

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/plc/melsec/end_code.hpp"
#include "canopus/plc/melsec/field.hpp"

namespace canopus::plc::melsec {

/// The destination of a message; the reply carries the same route.
struct Route {
  std::uint8_t network = 0x00;
  std::uint8_t pc = 0xFF;
  std::uint16_t module_io = 0x03FF;
  std::uint8_t station = 0x00;

  friend bool operator==(const Route&, const Route&) = default;
};

struct FrameHeader {
  bool is_4e = false;
  std::uint16_t serial = 0;  ///< 4E only
  Route route;
  std::uint16_t length = 0;  ///< of what follows the header
};

/// Command and subcommand behind a request's header.
struct Command {
  std::uint16_t command = 0;
  std::uint16_t subcommand = 0;
};

/// The data code by a connection's first byte, or none when no request begins with it.
[[nodiscard]] std::optional<DataCode> data_code_of(std::uint8_t first_byte) noexcept;

struct HeaderResult {
  enum class State : std::uint8_t { incomplete, complete, malformed } state = State::incomplete;
  FrameHeader header;
  std::size_t size = 0;  ///< of the header
};

/// Reads the header of a request as far as the bytes go. Malformed: not this data code's subheader, or text
/// that is no number; where the next request begins is unknown then.
[[nodiscard]] HeaderResult read_header(std::span<const std::uint8_t> bytes, DataCode code) noexcept;

/// Begins a reply; returns where its length goes.
std::size_t begin_reply(FieldWriter& out, const FrameHeader& request, EndCode end_code) noexcept;
/// Fills the length in.
void end_reply(FieldWriter& out, std::size_t length_at) noexcept;
/// The error information behind an end code: the route of the responding station, and the command that
/// failed.
void write_error_information(FieldWriter& out, const Route& route, const Command& command) noexcept;

}  // namespace canopus::plc::melsec
