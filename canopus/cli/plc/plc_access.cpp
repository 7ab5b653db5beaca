#include "canopus/cli/plc/plc_access.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/cli/output/print.hpp"
#include "canopus/cli/plc/module_words.hpp"
#include "canopus/cli/plc/transfer_setups.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

using client::PlcPoint;
using Frame = client::PlcConnection::Frame;

namespace {

std::string shown(std::uint16_t word, const PlcArguments& arguments) {
  const int decimal = arguments.as_signed ? static_cast<std::int16_t>(word) : static_cast<int>(word);
  if (arguments.format == "dec") return fmt::format("{}", decimal);
  if (arguments.format == "hex") return fmt::format("{:04X}H", word);
  return fmt::format("{:>6}  {:04X}H", decimal, word);
}

std::string shown_bit(bool on) { return on ? "ON" : "OFF"; }

/// Why a point may show something else than what was written to it: a CPU answers 0000H all the same.
std::string_view why_not_written(const PlcPoint& point) {
  if (point.at.is_buffer) return "the module does not let it be written, or changes it as well";
  if (point.kind == PlcPoint::Kind::rack && point.at.device == plc::Device::x)
    return "an input shows what its module says";
  return "the PLC does not let it be written, or writes it as well";
}

/// Reads back what was written, unless the arguments disable that. Prints an error for the first point that
/// differs; `same` compares, `shown` formats.
template <typename Value, typename Read, typename Show>
int verify(const PlcPoint& point, const PlcArguments& arguments, std::span<const Value> written, Read read,
           Show show) {
  if (arguments.no_verify) return done;
  const auto found = read(static_cast<std::uint32_t>(written.size()));
  if (!found) return plc_failed(refused, "written, but it cannot be read back: " + found.error());
  const auto [wanted, other] = std::ranges::mismatch(written, *found);
  if (wanted == written.end()) return done;
  const auto offset = static_cast<std::uint32_t>(wanted - written.begin());
  return plc_failed(
      refused, fmt::format("{} was written with {} and shows {}: {}", shown_address(point, arguments, offset),
                           show(*wanted), show(*other), why_not_written(point)));
}

/// Options of a connection that make no sense beside each other.
std::string why_not_together(const PlcArguments& arguments) {
  const int frames = arguments.frame_3e + arguments.frame_4e + arguments.frame_1e + arguments.modbus;
  if (frames > 1) return "--3e, --4e, --1e and --modbus do not go together; expected one of them";
  if (arguments.unit && !arguments.modbus) return "--unit is for --modbus";
  const bool names_no_cpu = frame_of(arguments) == Frame::frame_1e || frame_of(arguments) == Frame::modbus;
  if (arguments.cpu != "none" && names_no_cpu)
    return "--cpu: only 3E and 4E frames name a CPU of a multiple CPU system";
  if (!arguments.modbus) return {};
  if (arguments.connection.ascii) return "--ascii does not go with --modbus";
  if (arguments.connection.udp) return "--udp does not go with --modbus";
  return arguments.octal ? "--octal does not go with --modbus" : "";
}

}  // namespace

int plc_failed(int exit_code, const std::string& message) {
  print_error("canopus plc: {}", message);
  return exit_code;
}

std::expected<PlcPlace, std::string> parse_plc_place(std::string_view text) {
  const auto refuse = [text](std::string_view why) {
    return std::unexpected(
        fmt::format("\"{}\" {}; expected for example 192.168.3.39, 192.168.3.39:5007 or 5007", text, why));
  };
  std::string_view host = text;
  std::string_view port;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) return refuse("is no address of a PLC");
    host = text.substr(1, end - 1);
    const std::string_view behind = text.substr(end + 1);
    if (!behind.empty() && !behind.starts_with(':')) return refuse("is no address of a PLC");
    port = behind.empty() ? behind : behind.substr(1);
    if (!behind.empty() && port.empty()) return refuse("has no port behind the colon");
  } else if (std::ranges::count(text, ':') == 1) {  // more of them: an address of IPv6
    host = text.substr(0, text.find(':'));
    port = text.substr(host.size() + 1);
    if (port.empty()) return refuse("has no port behind the colon");
  } else if (std::ranges::all_of(text, ascii::is_digit)) {
    host = {};
    port = text;
  }
  PlcPlace place;
  if (!host.empty()) place.host = std::string(host);
  if (!port.empty()) {
    const auto number = ascii::parse_number<std::uint32_t>(port);
    if (!number || *number == 0 || *number > 65535) return refuse("has no port from 1 to 65535");
    place.port = static_cast<std::uint16_t>(*number);
  }
  if (!place.host && !place.port) return refuse("is no address of a PLC");
  return place;
}

std::string plc_place_text(const std::string& host, std::optional<std::uint16_t> port) {
  if (!port) return host;
  return fmt::format("{}:{}", host.contains(':') ? "[" + host + "]" : host, *port);
}

void use_setup(const TransferSetup& setup, PlcArguments& arguments) {
  arguments.connection.host = setup.host;
  arguments.connection.ascii = setup.ascii;
  arguments.connection.udp = setup.udp;
  arguments.connection.frame = setup.frame == "1E"   ? Frame::frame_1e
                               : setup.frame == "4E" ? Frame::frame_4e
                                                     : Frame::frame_3e;
  if (setup.port != 0) arguments.port = setup.port;
  arguments.timeout = setup.timeout;
  arguments.cpu = setup.cpu == 0 ? "none" : std::to_string(setup.cpu);
  arguments.module = setup.model;
}

Frame frame_of(const PlcArguments& arguments) noexcept {
  if (arguments.modbus) return Frame::modbus;
  if (arguments.frame_1e) return Frame::frame_1e;
  if (arguments.frame_4e) return Frame::frame_4e;
  return arguments.frame_3e ? Frame::frame_3e : arguments.connection.frame;
}

client::PlcNotation notation_of(const PlcArguments& arguments) noexcept {
  if (arguments.modbus) return client::PlcNotation::modbus;
  return arguments.octal ? client::PlcNotation::melsec_octal : client::PlcNotation::melsec;
}

/// Connects, then does it. Everything on the command line has been understood by then.
int with_client(const PlcArguments& arguments, const std::function<int(client::PlcClient&)>& action) {
  constexpr std::uint16_t default_port = 5007;
  constexpr std::uint16_t default_modbus_port = 502;
  constexpr std::size_t longest_password = 32;
  if (const std::string why = why_not_together(arguments); !why.empty()) return plc_failed(usage, why);
  const auto timeout = text::parse_duration(arguments.timeout);
  if (!timeout) return plc_failed(usage, "--timeout: " + timeout.error());
  if (*timeout < std::chrono::milliseconds(1)) return plc_failed(usage, "--timeout: expected at least 1ms");
  client::PlcConnection connection = arguments.connection;
  connection.frame = frame_of(arguments);
  connection.octal = arguments.octal;
  if (arguments.cpu != "none") {
    constexpr std::uint16_t before_first_cpu = 0x03E0 - 1;  // No.1 is 03E0H
    connection.module_io = static_cast<std::uint16_t>(before_first_cpu + std::stoul(arguments.cpu));
  }
  connection.unit = static_cast<std::uint8_t>(arguments.unit.value_or(connection.unit));
  connection.port = arguments.port.value_or(arguments.modbus ? default_modbus_port : default_port);
  connection.timeout = std::chrono::ceil<std::chrono::milliseconds>(*timeout);
  if (!connection.remote_password.empty()) {
    if (connection.frame != Frame::frame_3e && connection.frame != Frame::frame_4e)
      return plc_failed(usage, "--password: only 3E and 4E frames can bring a remote password");
    if (connection.remote_password.size() > longest_password)
      return plc_failed(usage, "--password: a remote password has at most 32 characters");
  }
  auto client = client::PlcClient::connect(connection);
  if (!client) return plc_failed(refused, client.error());
  const int code = action(*client);
  const auto left = client->leave();
  return left || code != done
             ? code
             : plc_failed(refused, "it is done, but the port stays unlocked: " + left.error());
}

std::expected<PlcPoint, std::string> plc_point(std::string_view text, const PlcArguments& arguments) {
  const client::PlcNotation notation = notation_of(arguments);
  const std::size_t colon = arguments.modbus ? std::string_view::npos : text.find(':');
  if (colon == std::string_view::npos) {
    auto point = client::parse_plc_point(text, notation);
    if (!point) return point;
    if (auto why = client::why_not_reached(*point, frame_of(arguments), arguments.octal); !why.empty())
      return std::unexpected(std::move(why));
    return point;
  }
  auto point = client::parse_plc_point(std::string(text.substr(0, colon)) + "/G0", notation);
  if (!point) {
    return std::unexpected(
        fmt::format("'{}' has no unit before the name; expected for example U0:error_status", text));
  }
  const auto address = find_word(text.substr(colon + 1), arguments.module);
  if (!address) return std::unexpected(address.error());
  point->at.number = *address;
  return point;
}

std::string shown_address(const PlcPoint& point, const PlcArguments& arguments, std::uint32_t offset) {
  return client::to_text(point, offset, notation_of(arguments));
}

client::PlcClient::Result<std::vector<std::uint16_t>> read_values(client::PlcClient& client,
                                                                  const PlcPoint& point,
                                                                  std::uint32_t count) {
  if (!point.is_bit()) return client.read_words(point, count);
  const auto bits = client.read_bits(point, count);
  if (!bits) return std::unexpected(bits.error());
  return std::vector<std::uint16_t>(bits->begin(), bits->end());
}

client::PlcClient::Result<std::vector<std::string>> read_points(client::PlcClient& client,
                                                                const PlcPoint& point,
                                                                const PlcArguments& arguments) {
  const auto values = read_values(client, point, arguments.count);
  if (!values) return std::unexpected(values.error());
  std::vector<std::string> texts;
  for (const std::uint16_t value : *values) {
    texts.push_back(point.is_bit() ? shown_bit(value != 0) : shown(value, arguments));
  }
  return texts;
}

int write_and_verify(client::PlcClient& client, const PlcPoint& point, const PlcArguments& arguments,
                     std::span<const std::uint8_t> bits) {
  const auto written = client.write_bits(point, bits);
  if (!written) return plc_failed(refused, written.error());
  return verify(
      point, arguments, bits, [&](std::uint32_t count) { return client.read_bits(point, count); },
      [](std::uint8_t bit) { return shown_bit(bit != 0); });
}

int write_and_verify(client::PlcClient& client, const PlcPoint& point, const PlcArguments& arguments,
                     std::span<const std::uint16_t> words) {
  const auto written = client.write_words(point, words);
  if (!written) return plc_failed(refused, written.error());
  return verify(
      point, arguments, words, [&](std::uint32_t count) { return client.read_words(point, count); },
      [](std::uint16_t word) { return fmt::format("{} ({:04X}H)", word, word); });
}

}  // namespace canopus::cli
