#pragma once
// What there is to see of a communication module at one moment.

#include <cstdint>
#include <optional>
#include <string_view>

namespace canopus::module {

/// A module's plain CAN function as seen from outside.
enum class Layer2State : std::uint8_t {
  inactive,  ///< another function mode, or the module has none
  offline,
  online,
};

/// What the engineering tool shows of a module beside its LEDs [RJ71CN91 5.2].
struct ModuleInformation {
  std::uint16_t function_mode = 0;  ///< as selected, 405; 0: none, the module is off
  std::string_view function_mode_name{};
  std::optional<std::uint32_t> bit_rate{};  ///< bit/s; none: off, or offline in a Layer 2 mode
  std::optional<std::uint8_t> node_id{};    ///< none: off, or in a Layer 2 mode
};

}  // namespace canopus::module
