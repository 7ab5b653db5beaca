#pragma once
// Common to the subcommands of `canopus plc`: their arguments, addresses, values as text, reading and
// writing.

#include <chrono>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/cli/plc/plc_arguments.hpp"
#include "canopus/client/plc_client.hpp"
#include "canopus/client/plc_point.hpp"

namespace canopus::cli {

// Exit codes.
inline constexpr int done = 0;
inline constexpr int refused = 1;
inline constexpr int usage = 2;

/// Prints the message, and returns the code.
int plc_failed(int exit_code, const std::string& message);

[[nodiscard]] client::PlcNotation notation_of(const PlcArguments& arguments) noexcept;

/// Connects, then does it. Everything else on the command line has been understood by then.
int with_client(const PlcArguments& arguments, const std::function<int(client::PlcClient&)>& action);

/// A device, U\G, or a name as U0:error_status; with --modbus an AS300's device or an address.
[[nodiscard]] std::expected<client::PlcPoint, std::string> plc_point(std::string_view text,
                                                                     const PlcArguments& arguments);
[[nodiscard]] std::string shown_address(const client::PlcPoint& point, const PlcArguments& arguments,
                                        std::uint32_t offset = 0);

/// Points from a point on, as numbers: 0 and 1 of a bit device.
[[nodiscard]] client::PlcClient::Result<std::vector<std::uint16_t>> read_values(client::PlcClient& client,
                                                                                const client::PlcPoint& point,
                                                                                std::uint32_t count);
/// The values of arguments.count points, as they are shown.
[[nodiscard]] client::PlcClient::Result<std::vector<std::string>> read_points(client::PlcClient& client,
                                                                              const client::PlcPoint& point,
                                                                              const PlcArguments& arguments);

/// Writes, and reads back unless the arguments disable that.
int write_and_verify(client::PlcClient& client, const client::PlcPoint& point, const PlcArguments& arguments,
                     std::span<const std::uint8_t> bits);
int write_and_verify(client::PlcClient& client, const client::PlcPoint& point, const PlcArguments& arguments,
                     std::span<const std::uint16_t> words);

/// When a watch begins and ends, and the time between its readings.
struct WatchTimes {
  using Clock = std::chrono::steady_clock;
  Clock::duration interval{};
  Clock::time_point start{};
  Clock::time_point end = Clock::time_point::max();
};
/// From now on, as --interval and --for have it; the error is a sentence.
[[nodiscard]] std::expected<WatchTimes, std::string> watch_times(const PlcArguments& arguments);

/// Reads again and again until the end, or until a reading returns another exit code than `done`; it gets the seconds since the start.
int watch(const WatchTimes& times, const std::function<int(double seconds)>& read);

// Subcommands with a source of their own.
int watch_plc(const client::PlcPoint& point, const PlcArguments& arguments);
int dump_plc(const PlcArguments& arguments);
int load_plc(const PlcArguments& arguments);
int list_plc_names();

}  // namespace canopus::cli
