#pragma once
// `canopus plc` and the signals that a plant exchanges by PDO: "drive.6041" or "drive.Statusword" instead of the words of the
// buffer memory behind them.

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "canopus/cli/plc/plc_arguments.hpp"
#include "canopus/client/sdo_request.hpp"
#include "canopus/plant/process_signals.hpp"

namespace canopus::cli {

class Command;

/// --plant.
void add_plant_option(Command& command, PlcArguments& arguments);

/// What was written for ADDRESS is [BUS:]NODE.OBJECT: with --plant everything that is no address, else where plant.toml of the
/// working folder has such a node, or where it cannot be a variable of a program.
[[nodiscard]] bool is_signal(const PlcArguments& arguments);

/// A signal of a plant, and its object with name, type and words.
struct PlcSignal {
  plant::ProcessSignal at{};
  client::SdoTarget target{};
  std::string name{};                     ///< "drive.6041:00"
  std::vector<plc::RackAddress> words{};  ///< rising, each once
  std::string place{};                    ///< "U0\G10009-U0\G10010", "U0\G13000 bits 0-7"
  std::optional<std::uint16_t> port{};    ///< of its PLC for the MC protocol, in the plant file
};
/// The error is a sentence that names similar nodes, objects, or the signals of the node; empty if the mistakes of the plant file
/// were printed already.
[[nodiscard]] std::expected<PlcSignal, std::string> find_signal(const PlcArguments& arguments);
/// The value in these words, as many as the signal has.
[[nodiscard]] std::vector<std::uint8_t> value_in_words(const PlcSignal& signal,
                                                       const std::vector<std::uint16_t>& words);
/// The words with this value in them; their other bits stay.
[[nodiscard]] std::vector<std::uint16_t> words_with_value(const PlcSignal& signal,
                                                          std::vector<std::uint16_t> words,
                                                          const std::vector<std::uint8_t>& value);

// Exit codes are those of plc_access.hpp.
int read_signal(const PlcArguments& arguments);
int write_signal(const PlcArguments& arguments);
int watch_signal(const PlcArguments& arguments);
/// All signals of the plant.
int list_signals(const PlcArguments& arguments);

}  // namespace canopus::cli
