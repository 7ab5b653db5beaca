#include "canopus/plc/melsec/frame.hpp"

#include <array>
#include <string_view>

namespace canopus::plc::melsec {

namespace {

constexpr std::uint8_t subheader_3e = 0x50;
constexpr std::uint8_t subheader_4e = 0x54;

/// 3 or 4 after a subheader's bytes, 0 when they are none; `known` of them have arrived.
enum class Subheader : std::uint8_t { unknown_yet, is_3e, is_4e, none };

Subheader subheader_of(std::span<const std::uint8_t> bytes, DataCode code) {
  const std::string_view end = code == DataCode::ascii ? std::string_view("00") : std::string_view("\0", 1);
  const std::size_t type_at = code == DataCode::ascii ? 1 : 0;
  if (code == DataCode::ascii && !bytes.empty() && bytes[0] != '5') return Subheader::none;
  if (bytes.size() <= type_at) return Subheader::unknown_yet;
  const std::uint8_t type = code == DataCode::ascii
                                ? static_cast<std::uint8_t>(bytes[type_at] - '0' + subheader_3e)
                                : bytes[type_at];
  if (type != subheader_3e && type != subheader_4e) return Subheader::none;
  for (std::size_t i = 0; i < end.size(); ++i) {
    if (bytes.size() <= type_at + 1 + i) return Subheader::unknown_yet;
    if (bytes[type_at + 1 + i] != static_cast<std::uint8_t>(end[i])) return Subheader::none;
  }
  return type == subheader_4e ? Subheader::is_4e : Subheader::is_3e;
}

}  // namespace

std::optional<DataCode> data_code_of(std::uint8_t first_byte) noexcept {
  if (first_byte == subheader_3e || first_byte == subheader_4e) return DataCode::binary;
  if (first_byte == '5') return DataCode::ascii;
  return std::nullopt;
}

HeaderResult read_header(std::span<const std::uint8_t> bytes, DataCode code) noexcept {
  HeaderResult result;
  // The form that nearly all clients use.
  constexpr std::size_t binary_3e = 9;
  if (code == DataCode::binary && bytes.size() >= binary_3e && bytes[0] == subheader_3e && bytes[1] == 0) {
    result.state = HeaderResult::State::complete;
    result.header.route = {bytes[2], bytes[3], can::load_as<std::uint16_t>(&bytes[4]), bytes[6]};
    result.header.length = can::load_as<std::uint16_t>(&bytes[7]);
    result.size = binary_3e;
    return result;
  }
  const Subheader subheader = subheader_of(bytes, code);
  if (subheader == Subheader::none) {
    result.state = HeaderResult::State::malformed;
    return result;
  }
  if (subheader == Subheader::unknown_yet) return result;
  const std::size_t scale = code == DataCode::ascii ? 2 : 1;
  result.header.is_4e = subheader == Subheader::is_4e;
  result.size = scale * (result.header.is_4e ? 13 : 9);
  if (bytes.size() < result.size) return result;

  FieldReader reader(bytes.subspan(2 * scale, result.size - 2 * scale), code);
  if (result.header.is_4e) {
    result.header.serial = reader.u16();
    (void)reader.u16();  // 0000, not checked
  }
  result.header.route.network = reader.u8();
  result.header.route.pc = reader.u8();
  result.header.route.module_io = reader.u16();
  result.header.route.station = reader.u8();
  result.header.length = reader.u16();
  result.state = reader.fault() == FieldReader::Fault::none ? HeaderResult::State::complete
                                                            : HeaderResult::State::malformed;
  return result;
}

std::size_t begin_reply(FieldWriter& out, const FrameHeader& request, EndCode end_code) noexcept {
  const bool ascii = out.code() == DataCode::ascii;
  if (!ascii && !request.is_4e) {  // what nearly every client gets
    const Route& route = request.route;
    const std::size_t begin = out.size();
    const auto low = [](unsigned value) { return static_cast<std::uint8_t>(value); };
    const auto code = static_cast<unsigned>(end_code);
    out.raw(std::array<std::uint8_t, 11>{0xD0, 0, route.network, route.pc, low(route.module_io),
                                         low(unsigned{route.module_io} >> 8U), route.station, 0, 0, low(code),
                                         low(code >> 8U)});
    return begin + 7;
  }
  if (request.is_4e) {
    out.text(ascii ? std::string_view("D400") : std::string_view("\xD4\0", 2));
    out.u16(request.serial);
    out.u16(0);
  } else {
    out.text(ascii ? std::string_view("D000") : std::string_view("\xD0\0", 2));
  }
  out.u8(request.route.network);
  out.u8(request.route.pc);
  out.u16(request.route.module_io);
  out.u8(request.route.station);
  const std::size_t length_at = out.size();
  out.u16(0);
  out.u16(static_cast<std::uint16_t>(end_code));
  return length_at;
}

void end_reply(FieldWriter& out, std::size_t length_at) noexcept {
  const std::size_t end = out.size();
  const std::size_t field = out.code() == DataCode::ascii ? 4 : 2;
  out.rewind(length_at);
  out.u16(static_cast<std::uint16_t>(end - length_at - field));
  out.rewind(end);
}

void write_error_information(FieldWriter& out, const Route& route, const Command& command) noexcept {
  out.u8(route.network);
  out.u8(route.pc);
  out.u16(route.module_io);
  out.u8(route.station);
  out.u16(command.command);
  out.u16(command.subcommand);
}

}  // namespace canopus::plc::melsec
