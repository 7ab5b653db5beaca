#pragma once
// A module's project against the module: what differs, writing it, reading it. Each [Write ...] and [Read ...] button of the
// configuration tool is a part here [FX3U-CAN 15.1.2].

#include <cstdint>
#include <expected>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/module_settings/module_project.hpp"

namespace canopus::module_settings {

struct ObjectNumber {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
};

/// The way to a module: through the PLC it is in, or a test's own.
class ModuleAccess {
 public:
  template <typename Value>
  using Result = std::expected<Value, std::string>;  ///< else why it could not be done, as a sentence

  virtual ~ModuleAccess() = default;
  virtual Result<std::uint16_t> read_word(std::uint32_t address) = 0;
  virtual Result<void> write_word(std::uint32_t address, std::uint16_t value) = 0;
  /// Objects of a node that have 1 to 4 bytes, as numbers; node 0 is the module itself.
  virtual Result<std::vector<std::uint32_t>> read_objects(std::uint8_t node,
                                                          std::span<const ObjectNumber> objects) = 0;
  /// The lowest `bytes` bytes of the value.
  virtual Result<void> write_object(std::uint8_t node, ObjectNumber object, std::uint32_t value,
                                    std::uint8_t bytes) = 0;
  /// Keeps the module's words (node, baud rate ...) in its flash ROM.
  virtual Result<void> save_words() = 0;
};

/// Which rows of the PDO lists: "All", "Starting from", "Range".
struct PdoRange {
  std::uint32_t first = 1;
  std::uint32_t last = 0xFFFF;
};

/// Part of a project: "basic", "tpdo", "rpdo", "nmt"; "all" is all of them.
[[nodiscard]] bool is_part(std::string_view part) noexcept;

/// One value that the module has otherwise than the project.
struct Difference {
  std::string where;  ///< "tpdo 1: COB-ID (1800:01)"
  std::string device;
  std::string project;
};

/// One step of a transfer, as a line; `good` false: it was refused, `text` has the reason.
struct TransferStep {
  bool good = true;
  std::string text;
};
using StepListener = std::function<void(const TransferStep&)>;

/// The changes that writing the part would make. `node`: 0 the module, else another node (which has no
/// "basic").
[[nodiscard]] ModuleAccess::Result<std::vector<Difference>> differences(const ModuleProject& project,
                                                                        std::string_view part, PdoRange range,
                                                                        std::uint8_t node,
                                                                        ModuleAccess& access);

/// Writes the differences, PDOs in the five steps of CiA 301, and saves them in the flash ROM [CiA 301
/// 7.5.2.36]. Ends at the first refusal; values that were not written are not reported as written.
[[nodiscard]] ModuleAccess::Result<void> write_module(const ModuleProject& project, std::string_view part,
                                                      PdoRange range, std::uint8_t node, ModuleAccess& access,
                                                      const StepListener& listener);

/// Puts into the project what the module has. PDOs from 5 on that are as the factory made them are left out.
[[nodiscard]] ModuleAccess::Result<void> read_module(ModuleProject& project, std::string_view part,
                                                     PdoRange range, std::uint8_t node, ModuleAccess& access);

}  // namespace canopus::module_settings
