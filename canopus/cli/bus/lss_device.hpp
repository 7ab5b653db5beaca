#pragma once
// Common to the lss commands: their options, the selection of a device, and the result of a service.

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>

#include "canopus/cli/bus/lss_on_bus.hpp"
#include "canopus/text/json.hpp"

namespace canopus::cli {

struct LssArguments {
  BusOptions bus;
  std::string node, rate, state, delay;
  std::string vendor, product, revision, serial;
  std::string assign, activate;
  bool slow = false;
  bool store = false;
};

/// A line for people, or the JSON.
void show(const LssArguments& arguments, const text::Json& line, const std::string& text);
[[nodiscard]] text::Json json(const lss::LssAddress& address);
[[nodiscard]] std::string describe(const lss::LssAddress& address);

/// The exit code for the result of a service that had to succeed.
int judge(const LssOnBus& on_bus, const BusLoop& bus, std::optional<lss::LssResult> result,
          std::string_view what);
void all_to_waiting(LssOnBus& on_bus);
/// The selected device keeps what it was given. An exit code.
int store(LssOnBus& on_bus, const BusLoop& bus);
/// The selected device gets its node-ID and keeps it if asked to. An exit code.
int set_node_id(LssOnBus& on_bus, const BusLoop& bus, std::uint8_t node, bool stored);

/// "250k", "1M", "250000": one of LSS, in bit/s.
[[nodiscard]] std::expected<std::uint32_t, std::string> parse_lss_bit_rate(std::string_view text);
/// The value of option --`name`; nothing when it was not given.
[[nodiscard]] std::expected<std::optional<std::uint32_t>, std::string> u32(const std::string& word,
                                                                           std::string_view name);
/// Nothing when no part was given.
[[nodiscard]] std::expected<std::optional<lss::LssAddress>, std::string> address_of(
    const LssArguments& arguments);

}  // namespace canopus::cli
