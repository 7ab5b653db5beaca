#pragma once
// Devices, PLCs and their words by the names that a campaign file has for them. Errors are sentences that begin with the key.

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/can/time.hpp"
#include "canopus/plant/plant.hpp"
#include "canopus/plc/rack/rack_address.hpp"

namespace canopus::campaign {

/// `; did you mean "encoder"?`, or the names that there are, shortened if they are many.
[[nodiscard]] std::string names_there_are(std::string_view name, const std::vector<std::string>& known);

using FoundNumber = std::expected<std::size_t, std::string>;
/// The number of the device in the plant.
[[nodiscard]] FoundNumber find_device(const plant::Plant& plant, const std::string& name);
/// With an empty name the plant has but one PLC.
[[nodiscard]] FoundNumber find_plc(const plant::Plant& plant, const std::string& name);

/// A point of the CPU, or a word of a module's buffer memory, with supply or without.
[[nodiscard]] std::expected<plc::RackAddress, std::string> find_word(plc::Rack& rack,
                                                                     const std::string& word);
/// A bit is 0 or 1. Changes nothing, and no module gets to know of it. Nothing: without supply.
[[nodiscard]] std::optional<std::uint16_t> peek(plc::Rack& rack, const plc::RackAddress& address,
                                                can::Time now);
/// As the CPU's program writes it.
void write_word(plc::Rack& rack, const plc::RackAddress& address, std::uint16_t value, can::Time now);

}  // namespace canopus::campaign
