#pragma once
// What the subcommands of `canopus plc` share: their arguments, addresses, values as text, reading and writing.

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/client/plc_client.hpp"
#include "canopus/client/plc_point.hpp"

namespace CLI {
class App;
}

namespace canopus::cli {

struct PlcArguments {
  client::PlcConnection connection;  ///< frame and port: as the flags below say
  std::optional<std::uint16_t> port{};
  bool frame_3e = false;
  bool frame_4e = false;
  bool frame_1e = false;
  bool modbus = false;
  std::optional<unsigned> unit{};  ///< of Modbus
  std::string timeout = "3s";
  bool octal = false;  ///< X and Y
  std::string module;  ///< whose names of words are meant
  std::string address;
  std::vector<std::string> values;
  std::uint32_t count = 1;
  std::string format = "both";
  bool as_signed = false;
  std::string interval = "200ms";
  std::string duration;
  bool no_verify = false;
  bool csv = false;
  bool json = false;
  std::string file;
};

// Exit codes.
inline constexpr int done = 0;
inline constexpr int refused = 1;
inline constexpr int usage = 2;

/// --host, --port, the frames, --timeout and so on.
void add_connection_options(CLI::App& command, PlcArguments& arguments);

/// Prints the message, and returns the code.
int plc_failed(int exit_code, const std::string& message);

[[nodiscard]] client::PlcConnection::Frame frame_of(const PlcArguments& arguments) noexcept;
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

/// Writes, and reads back unless that is not wanted.
int write_and_verify(client::PlcClient& client, const client::PlcPoint& point, const PlcArguments& arguments,
                     std::span<const std::uint8_t> bits);
int write_and_verify(client::PlcClient& client, const client::PlcPoint& point, const PlcArguments& arguments,
                     std::span<const std::uint16_t> words);

// Subcommands with a source of their own.
int watch_plc(const client::PlcPoint& point, const PlcArguments& arguments);
int dump_plc(const PlcArguments& arguments);
int load_plc(const PlcArguments& arguments);
int list_plc_names();

}  // namespace canopus::cli
