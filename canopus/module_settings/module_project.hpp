#pragma once
// The settings of one communication module as a project: what its configuration tool keeps, checks and writes [FX3U-CAN 15].

#include <cstdint>
#include <expected>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "canopus/manager/nmt/flying_master.hpp"
#include "canopus/module_settings/module_windows.hpp"

namespace canopus::module_settings {

/// A row of a window, or the only set of its fields.
struct Row {
  std::vector<std::uint32_t> values;  ///< one for each field of the window
  /// Mapping of a PDO: index, sub-index, bits, as in 1A00H; at most 64 bits.
  std::vector<std::uint32_t> mapping{};
  std::string name{};  ///< of a node: 1 to 256 characters
};

/// A mistake and its place: "tpdo 3: Event timer = 70000: expected 0 to 65535 ms".
struct ProjectFinding {
  bool is_error = true;  ///< else a warning
  std::string text;
};

class ModuleProject {
 public:
  /// Every window without rows has its defaults; lists are empty.
  explicit ModuleProject(const module::ConfigurationTool& tool);

  [[nodiscard]] const module::ConfigurationTool& tool() const noexcept { return *tool_; }
  [[nodiscard]] std::uint32_t node_id() const noexcept { return value("basic", "Node ID"); }

  /// The number behind U: Module number, or Module address / 16.
  [[nodiscard]] std::uint32_t unit_number() const noexcept {
    return value("basic", "Module number") + value("basic", "Module address") / 0x10;
  }

  /// By its word; nullptr: the model has no such window.
  [[nodiscard]] const Window* window(std::string_view word) const noexcept;
  /// Rows by their number; of a window without rows the only one, 0.
  [[nodiscard]] const std::map<std::uint32_t, Row>& rows(const Window& window) const;

  /// A row with the defaults. The error: the number is out of range, there already, or the list is full.
  std::expected<void, std::string> add(const Window& window, std::uint32_t key);
  /// False: there is none.
  bool remove(const Window& window, std::uint32_t key);
  /// Checked by why_not(); nothing changes on an error. The row must exist.
  std::expected<void, std::string> set(const Window& window, std::uint32_t key, std::string_view field,
                                       std::string_view text);
  std::expected<void, std::string> set_mapping(const Window& window, std::uint32_t key,
                                               std::vector<std::uint32_t> mapping);
  /// [Restore default values]: a window without rows gets its defaults, a list loses its rows.
  void restore_defaults(const Window& window);
  /// Stores a row as read, without checks.
  void put(const Window& window, std::uint32_t key, Row row) { rows_[window.word][key] = std::move(row); }

  [[nodiscard]] std::uint32_t value(std::string_view window, std::string_view field,
                                    std::uint32_t key = 0) const noexcept;
  /// The defaults of a row, for this project's node-ID.
  [[nodiscard]] Row factory_row(const Window& window, std::uint32_t key) const;

  /// After what time the module answers a negotiation of flying masters, whether or not it is one: "negotiation: 500 ms + 1 x
  /// 1500 ms + 5 x 10 ms = 2.05 s; ..."
  [[nodiscard]] std::string negotiation() const;
  /// The mistake of its time slots; empty: none.
  [[nodiscard]] std::string overlapping_slots() const;

  /// Checks the range of every value, and values that depend on each other.
  [[nodiscard]] std::vector<ProjectFinding> check() const;

 private:
  [[nodiscard]] manager::FlyingMasterTiming flying_timing() const;
  /// Rows of a node list whose settings the CPU module holds, without this row and the module itself.
  [[nodiscard]] std::size_t from_cpu_beside(const Window& window, std::uint32_t key) const;
  [[nodiscard]] std::string why_not_target(const Window& window, std::uint32_t key,
                                           std::uint32_t target) const;
  std::expected<void, std::string> set_part_of_cob_id(const Window& window, std::uint32_t key,
                                                      const Field& cob_id, std::string_view name,
                                                      std::string_view text);
  std::expected<void, std::string> set_value(const Window& window, std::uint32_t key, const Field& field,
                                             std::uint32_t value);

  const module::ConfigurationTool* tool_;
  std::map<std::string_view, std::map<std::uint32_t, Row>> rows_;
};

/// The mistake of a node's name: not UTF-8, empty, longer than 256 characters, control characters; empty:
/// nothing.
[[nodiscard]] std::string why_no_name(std::string_view name);
/// The mistake of a list of mapped objects: "more than 64 bits" and the like; empty: nothing.
[[nodiscard]] std::string why_no_mapping(const std::vector<std::uint32_t>& mapping);

// A module's project as an XML file: the backup that [Export] writes and [Import] reads [FX3U-CAN 15.3.3].

/// The version of the format that is written here; files of a newer one are refused.
inline constexpr unsigned project_format = 1;

/// The whole file.
[[nodiscard]] std::string to_xml(const ModuleProject& project);

/// A project of a module that one of the tools is for, or what is wrong, as "LINE: text". Fields that the file does not have keep
/// their defaults.
[[nodiscard]] std::expected<ModuleProject, std::string> from_xml(std::string_view text, Tools tools);

}  // namespace canopus::module_settings
