#include "canopus/cli/commands/plc_access.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "canopus/cli/commands/module_words.hpp"
#include "canopus/cli/terminal/print.hpp"
#include "canopus/client/plc_address.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::cli {

using plc::melsec::Target;
using Arguments = PlcArguments;

namespace {

unsigned io_base(const Arguments& arguments) { return arguments.octal ? 8 : 16; }

std::string shown(std::uint16_t word, const Arguments& arguments) {
  const int decimal = arguments.as_signed ? static_cast<std::int16_t>(word) : static_cast<int>(word);
  if (arguments.format == "dec") return fmt::format("{}", decimal);
  if (arguments.format == "hex") return fmt::format("{:04X}H", word);
  return fmt::format("{:>6}  {:04X}H", decimal, word);
}

std::string shown_bit(bool on) { return on ? "ON" : "OFF"; }

/// Why a point may show something else than what was written to it: a CPU answers 0000H all the same.
std::string_view why_not_written(const Target& target) {
  if (target.is_buffer) return "the module does not let it be written, or changes it as well";
  if (target.device == plc::Device::x) return "an input shows what its module says";
  return "the PLC does not let it be written, or writes it as well";
}

/// Reads back what was written, unless that is not wanted. Complains of the first point that shows something
/// else; `same` compares, `shown` shows.
template <typename Value, typename Read, typename Show>
int verify(const Target& target, const Arguments& arguments, std::span<const Value> written, Read read,
           Show show) {
  if (arguments.no_verify) return done;
  const auto found = read(static_cast<std::uint32_t>(written.size()));
  if (!found) return complain(refused, "written, but it cannot be read back: " + found.error());
  const auto [wanted, other] = std::ranges::mismatch(written, *found);
  if (wanted == written.end()) return done;
  const auto offset = static_cast<std::uint32_t>(wanted - written.begin());
  return complain(refused, fmt::format("{} was written with {} and shows {}: {}",
                                       shown_address(target, arguments, offset), show(*wanted), show(*other),
                                       why_not_written(target)));
}

}  // namespace

int complain(int exit_code, const std::string& message) {
  print_error("canopus plc: {}", message);
  return exit_code;
}

/// Connects, then does it. Everything on the command line has been understood by then.
int with_client(const Arguments& arguments, const std::function<int(client::PlcClient&)>& action) {
  const auto timeout = text::parse_duration(arguments.timeout);
  if (!timeout) return complain(usage, "--timeout: " + timeout.error());
  if (*timeout < std::chrono::milliseconds(1)) return complain(usage, "--timeout: expected at least 1ms");
  client::PlcConnection connection = arguments.connection;
  connection.timeout = std::chrono::ceil<std::chrono::milliseconds>(*timeout);
  auto client = client::PlcClient::connect(connection);
  if (!client) return complain(refused, client.error());
  return action(*client);
}

bool is_bit(const Target& target) { return !target.is_buffer && plc::device_info(target.device).is_bit; }

std::expected<Target, std::string> plc_target(std::string_view text, const Arguments& arguments) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return client::parse_plc_address(text, io_base(arguments));
  auto target = client::parse_plc_address(std::string(text.substr(0, colon)) + "/G0");
  if (!target) {
    return std::unexpected(
        fmt::format("'{}' has no unit before the name; expected for example U0:error_status", text));
  }
  const auto address = find_word(text.substr(colon + 1), arguments.module);
  if (!address) return std::unexpected(address.error());
  target->number = *address;
  return target;
}

std::string shown_address(const Target& target, const Arguments& arguments, std::uint32_t offset) {
  return client::plc_address(target, offset, io_base(arguments));
}

client::PlcClient::Result<std::vector<std::uint16_t>> read_values(client::PlcClient& client,
                                                                  const Target& target, std::uint32_t count) {
  if (!is_bit(target)) return client.read_words(target, count);
  const auto bits = client.read_bits(target, count);
  if (!bits) return std::unexpected(bits.error());
  return std::vector<std::uint16_t>(bits->begin(), bits->end());
}

client::PlcClient::Result<std::vector<std::string>> read_points(client::PlcClient& client,
                                                                const Target& target,
                                                                const Arguments& arguments) {
  const auto values = read_values(client, target, arguments.count);
  if (!values) return std::unexpected(values.error());
  std::vector<std::string> texts;
  for (const std::uint16_t value : *values) {
    texts.push_back(is_bit(target) ? shown_bit(value != 0) : shown(value, arguments));
  }
  return texts;
}

int write_and_verify(client::PlcClient& client, const Target& target, const Arguments& arguments,
                     std::span<const std::uint8_t> bits) {
  const auto written = client.write_bits(target, bits);
  if (!written) return complain(refused, written.error());
  return verify(
      target, arguments, bits, [&](std::uint32_t count) { return client.read_bits(target, count); },
      [](std::uint8_t bit) { return shown_bit(bit != 0); });
}

int write_and_verify(client::PlcClient& client, const Target& target, const Arguments& arguments,
                     std::span<const std::uint16_t> words) {
  const auto written = client.write_words(target, words);
  if (!written) return complain(refused, written.error());
  return verify(
      target, arguments, words, [&](std::uint32_t count) { return client.read_words(target, count); },
      [](std::uint16_t word) { return fmt::format("{} ({:04X}H)", word, word); });
}

}  // namespace canopus::cli
