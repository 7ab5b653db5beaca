#pragma once
// The settings of a communication module as its configuration tool has them: windows of fields, each with its printed name,
// range and default, and with the word or object it stands for [FX3U-CAN 15.1.2]. Files, checks and transfers go by these
// tables, so that they cannot disagree.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace canopus::project {

/// Where a field's value lies in the module.
struct Place {
  enum class Kind : std::uint8_t {
    none,         ///< only in the project
    word,         ///< buffer memory, `number`
    object,       ///< `number`:`sub`
    pdo_object,   ///< PDO 1: `number`:`sub`, PDO n: n-1 further
    node_object,  ///< `number`:node-ID
    consumer,     ///< 1016H, one entry for each row
  };
  Kind kind = Kind::none;
  std::uint32_t number = 0;
  std::uint8_t sub = 0;
  std::uint8_t bytes = 4;      ///< of the object
  std::uint8_t first_bit = 0;  ///< of the field in the object
  std::uint8_t bits = 0;       ///< 0: all of it
  std::uint16_t factor = 1;    ///< the field counts so many times finer than the module: 10 ms, in ms
};

/// COB-ID entries: the PDO or consumer is not there [CiA 301 7.5.2.37].
inline constexpr std::uint32_t not_valid = 0x8000'0000;

struct Field {
  std::string_view name;  ///< as printed: "FROM/TO Watchdog"
  std::string_view unit;  ///< "ms"; empty: none
  std::uint32_t lowest = 0;
  std::uint32_t highest = 0;
  std::uint32_t factory =
      0;  ///< the default; of some fields it depends on PDO number and node-ID, see factory_value()
  Place place{};
  std::uint32_t step = 1;
  bool hexadecimal = false;
  std::span<const std::uint32_t> choices{};   ///< nothing else is taken; empty: the whole range
  std::span<const std::string_view> words{};  ///< names of the values from 0 on: "Not selected", "Selected"
  bool read_only = false;
};

/// A window holds one set of fields, or a list of rows with a number each.
struct Window {
  std::string_view word;       ///< "tpdo", for command lines and files
  std::string_view title;      ///< "PDO list: Transmit PDO"
  std::string_view key;        ///< what the number of a row is: "PDO number"; empty: no rows
  std::uint32_t most_key = 0;  ///< keys are 1 to this
  std::uint32_t most_rows = 1;
  std::span<const Field> fields{};
  std::uint16_t mapping = 0;  ///< 1A00H or 1600H: rows have mapped objects; 0: they have none
  std::string_view part;      ///< what is read and written together: "basic", "tpdo", "rpdo", "nmt"
};

/// A module whose settings are known here.
struct ModuleModel {
  std::string_view name;  ///< "FX3U-CAN"
  std::span<const Window> windows;
};

/// The FX3U-CAN in CANopen 405 mode [FX3U-CAN 15.1.2].
[[nodiscard]] const ModuleModel& fx3u_can_settings() noexcept;
/// By name, in any case; nullptr: not known.
[[nodiscard]] const ModuleModel* find_module_model(std::string_view name) noexcept;

/// The field's default for this row of a module with this node-ID. Key 0: not a row.
[[nodiscard]] std::uint32_t factory_value(const Window& window, const Field& field, std::uint32_t key,
                                          std::uint32_t node_id) noexcept;

/// What is wrong with a value, with the printed range ("Node ID = 128: expected 1 to 127"); empty: nothing.
[[nodiscard]] std::string why_not(const Field& field, std::uint32_t value);
/// A number, decimal or as 0x1F, or a word of the field ("Selected"); else what was expected.
[[nodiscard]] std::optional<std::uint32_t> parse_value(const Field& field, std::string_view text) noexcept;
/// As the window shows it: "0x40000181", "250", "Selected".
[[nodiscard]] std::string shown_value(const Field& field, std::uint32_t value);

/// The object that a mapping entry stands for, as the details window names it: "BFM Area Unsigned16 (PLC write access),
/// BFM#11000 (TO)", "Dummy Unsigned 8 bit"; empty: none of the module's.
[[nodiscard]] std::string object_name(std::uint32_t mapping_entry);

}  // namespace canopus::project
