#pragma once
// A new plant or project as a form of the page describes it: a module, a bus, and devices with their files.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/text/json.hpp"

namespace canopus::web {

struct NewDevice {
  std::string file{};  ///< name of its device file, of letters, digits and `. _ -`
  std::string text{};  ///< of the file
  std::uint8_t node = 0;
  std::string name{};
};

struct NewPlant {
  static constexpr std::size_t most_devices = 126;
  static constexpr std::uint32_t usual_bit_rate = 250'000;

  std::string model{};                      ///< of the module; empty: of a project, which has none
  std::uint32_t bit_rate = usual_bit_rate;  ///< bit/s
  std::vector<NewDevice> devices{};

  /// {"model": "ME3CAN1-Q", "bit_rate": "250k", "devices": [{"file": {"name": "servo.eds", "text": "..."}, "node_id": 5, "name": "servo"}]};
  /// a device without "node_id" gets the lowest that is free, from 2 on; node-ID 1 is the module's. The error names the field.
  [[nodiscard]] static std::expected<NewPlant, std::string> parse(const text::Json& wish, bool has_module);
  /// The plant file (plant::plant_text()). The error names the device file that cannot be read.
  [[nodiscard]] std::expected<std::string, std::string> plant_text(std::string_view name) const;
};

/// Models of modules that a new plant may have.
[[nodiscard]] std::vector<std::string> module_models();

}  // namespace canopus::web
