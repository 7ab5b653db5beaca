#pragma once
// The text of a new plant file: one PLC with a module as NMT master, and devices from their device files. As it is written
// it boots, and exchanges PDO1 with every device.

#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canopus/eds/device_file.hpp"
#include "canopus/plant/catalogue/module_catalogue.hpp"

namespace canopus::plant {

/// A device of a new plant.
struct NewDevice {
  std::string name;                             ///< no other device, nor the module, has it
  std::uint8_t node_id = 0;                     ///< 1..127
  std::string path;                             ///< of its device file, from the plant file's folder
  std::shared_ptr<const eds::DeviceFile> file;  ///< never null
};

struct NewPlant {
  std::string name;
  const CatalogueEntry* module = nullptr;  ///< never null
  std::uint8_t module_node_id = 1;
  std::uint32_t bit_rate = 250'000;  ///< bit/s
  std::vector<NewDevice> devices{};
  bool has_program = false;  ///< main.st beside it is the program of the PLC
};

/// The text, with `comments` (Plant::connections(), for example) as lines below the module.
[[nodiscard]] std::string plant_text(const NewPlant& plant, std::span<const std::string> comments = {});

/// The PLC program that plant_text() names, main.st: each word of `connections` (Plant::connections()) is a variable AT its place.
[[nodiscard]] std::string program_text(std::span<const std::string> connections);

/// The highest bit rate in bit/s, but not above 250 kbit/s, that all devices support as their files say; the error names two that
/// have none in common.
[[nodiscard]] std::expected<std::uint32_t, std::string> common_bit_rate(std::span<const NewDevice> devices);

/// The lowest node-ID from 1 on that no device has; 0: there is none.
[[nodiscard]] std::uint8_t free_node_id(std::span<const NewDevice> devices) noexcept;

}  // namespace canopus::plant
