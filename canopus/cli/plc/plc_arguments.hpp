#pragma once
// The arguments for a PLC: its connection, and what to read or write.

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/client/plc_client.hpp"

namespace canopus::cli {

class Command;

struct TransferSetup;

struct PlcArguments {
  std::string setup;  ///< the transfer setup that the values are of; empty: none
  /// Its port is ignored (see `port`); its frame is the default of the flags below.
  client::PlcConnection connection;
  std::optional<std::uint16_t> port{};
  bool frame_3e = false;
  bool frame_4e = false;
  bool frame_1e = false;
  bool modbus = false;
  std::string cpu = "none";        ///< of a multiple CPU system
  std::optional<unsigned> unit{};  ///< of Modbus
  std::string timeout = "3s";
  bool octal = false;  ///< X and Y
  std::string module;  ///< module whose names of words are used
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
  std::string at{};     ///< control server of a plant: what is read and written is a variable of its program
  std::string plc{};    ///< whose program or signals; empty: of the only one, or of all
  std::string plant{};  ///< plant file of signals; empty: plant.toml of the working folder
};

/// The value of --plc, "192.168.3.39", "192.168.3.39:5007", "5007" or "[fe80::1]:5007".
struct PlcPlace {
  std::optional<std::string> host{};
  std::optional<std::uint16_t> port{};
};
[[nodiscard]] std::expected<PlcPlace, std::string> parse_plc_place(std::string_view text);
/// As --plc is written for this place.
[[nodiscard]] std::string plc_place_text(const std::string& host, std::optional<std::uint16_t> port);

/// --plc; `use` gets its value.
void add_plc_option(Command& command, const char* help, std::function<void(const PlcPlace&)> use);

/// --setup, --plc, the frames, --timeout and so on.
void add_connection_options(Command& command, PlcArguments& arguments);

/// The setup's values take the place of those that are there.
void use_setup(const TransferSetup& setup, PlcArguments& arguments);
[[nodiscard]] client::PlcConnection::Frame frame_of(const PlcArguments& arguments) noexcept;

}  // namespace canopus::cli
