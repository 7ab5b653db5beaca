#pragma once
// The arguments for a PLC: its connection, and what to read or write.

#include <cstdint>
#include <optional>
#include <string>
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
};

/// --setup, --host, --port, the frames, --timeout and so on.
void add_connection_options(Command& command, PlcArguments& arguments);

/// The setup's values take the place of those that are there.
void use_setup(const TransferSetup& setup, PlcArguments& arguments);
[[nodiscard]] client::PlcConnection::Frame frame_of(const PlcArguments& arguments) noexcept;

}  // namespace canopus::cli
