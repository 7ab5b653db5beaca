#pragma once
// Global labels that stand for devices, as an engineering tool assigns them: their values by name.

#include <expected>
#include <string>
#include <string_view>

#include "canopus/can/time.hpp"

namespace canopus::plc {

class Rack;

struct DeviceLabel {
  std::string name{};
  std::string type{};    ///< "INT"
  std::string device{};  ///< "D100", of a type of 32 or 64 bits the first one
  std::string comment{};
};

/// As Machine::read() and write(); of an elementary type that is no string.
[[nodiscard]] std::expected<std::string, std::string> read_label(Rack& rack, const DeviceLabel& label,
                                                                 can::Time now);
[[nodiscard]] std::expected<void, std::string> write_label(Rack& rack, const DeviceLabel& label,
                                                           std::string_view value, can::Time now);

}  // namespace canopus::plc
