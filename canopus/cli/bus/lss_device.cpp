#include "canopus/cli/bus/lss_device.hpp"

#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/number.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/client/sdo_value.hpp"
#include "canopus/text/bit_rate.hpp"

namespace canopus::cli {

using lss::LssAddress;
using lss::LssResult;
using Json = text::Json;

void show(const LssArguments& arguments, const Json& line, const std::string& text) {
  if (arguments.bus.json) return print_json(line);
  print_line("{}", text);
}

Json json(const LssAddress& address) {
  return {{"vendor", address.vendor},
          {"product", address.product},
          {"revision", address.revision},
          {"serial", address.serial}};
}

std::string describe(const LssAddress& address) {
  return fmt::format("vendor {:08X}  product {:08X}  revision {:08X}  serial {:08X}", address.vendor,
                     address.product, address.revision, address.serial);
}

int judge(const LssOnBus& on_bus, const BusLoop& bus, std::optional<LssResult> result,
          std::string_view what) {
  if (!result) return complain_of(on_bus.end(), bus, "");
  const unsigned error = on_bus.master().error();
  switch (*result) {
    case LssResult::done: return exit_code::done;
    case LssResult::silence: return complain(exit_code::failed, fmt::format("{}: no answer", what));
    case LssResult::lost:
      return complain(exit_code::failed, fmt::format("{}: the device stopped answering in the middle", what));
    case LssResult::refused: break;
  }
  constexpr unsigned specific = 0xFF;
  return complain(exit_code::failed, error == specific
                                         ? fmt::format("{}: refused with the device's own error {}", what,
                                                       on_bus.master().specific_error())
                                         : fmt::format("{}: refused with error {}", what, error));
}

void all_to_waiting(LssOnBus& on_bus) {
  (void)on_bus.service([](auto& master, can::Time now) { return master.switch_global(false, now); });
}

int store(LssOnBus& on_bus, const BusLoop& bus) {
  const auto stored = on_bus.service_of_found([](auto& master, can::Time now) { return master.store(now); });
  return judge(on_bus, bus, stored, "storing");
}

int set_node_id(LssOnBus& on_bus, const BusLoop& bus, std::uint8_t node, bool stored) {
  const auto set = on_bus.service_of_found(
      [&](auto& master, can::Time now) { return master.configure_node_id(node, now); });
  const int code = judge(on_bus, bus, set, fmt::format("setting node-ID {}", node));
  return code == exit_code::done && stored ? store(on_bus, bus) : code;
}

std::expected<std::uint32_t, std::string> parse_lss_bit_rate(std::string_view text) {
  auto bit_rate = text::parse_bit_rate(text, lss::bit_rates);
  if (!bit_rate)
    return std::unexpected(fmt::format("\"{}\" is not a bit rate of LSS; {}", text, bit_rate.error()));
  return bit_rate;
}

std::expected<std::optional<std::uint32_t>, std::string> u32(const std::string& word, std::string_view name) {
  if (word.empty()) return std::nullopt;
  const auto bytes = client::encode_value(word, canopen::DataType::unsigned32);
  if (!bytes) return std::unexpected(fmt::format("--{}: {}", name, bytes.error()));
  return can::load_u32(*bytes);
}

std::expected<std::optional<LssAddress>, std::string> address_of(const LssArguments& arguments) {
  const std::pair<const std::string*, std::string_view> words[] = {{&arguments.vendor, "vendor"},
                                                                   {&arguments.product, "product"},
                                                                   {&arguments.revision, "revision"},
                                                                   {&arguments.serial, "serial"}};
  LssAddress address;
  unsigned given = 0;
  for (unsigned part = 0; part < 4; ++part) {
    const auto value = u32(*words[part].first, words[part].second);
    if (!value) return std::unexpected(value.error());
    if (!*value) continue;
    ++given;
    address.set_part(part, **value);
  }
  if (given == 0) return std::nullopt;
  if (given == 4) return address;
  return std::unexpected(
      "an LSS address has four parts: --vendor, --product, --revision and --serial; `canopus lss scan` shows "
      "them "
      "of devices without a node-ID");
}

}  // namespace canopus::cli
