#pragma once
// The settings of a communication module as its configuration tool has them: windows of fields, each with its printed name,
// range and default, and with the word or object it stands for [FX3U-CAN 15.1.2] [RJ71CN91 3.1]. Files, checks and transfers
// go by these tables, so that they cannot disagree.

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
  /// The default; of some fields it depends on PDO number and node-ID, see factory_value().
  std::uint32_t factory = 0;
  Place place{};
  std::uint32_t step = 1;
  bool hexadecimal = false;
  std::span<const std::uint32_t> choices{};   ///< nothing else is taken; empty: the whole range
  std::span<const std::string_view> words{};  ///< names of the values from 0 on: "Not selected", "Selected"
  bool read_only = false;
  std::string_view description{};  ///< what the description window says of it, in short
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
  std::string_view
      part;  ///< read and written together: "basic", "tpdo", "rpdo", "nmt"; empty: only in the project
  std::string_view
      name_field{};  ///< rows have a name, and this is what it is called: "Node name"; empty: they have none
};

/// How a module takes requests of the PLC's program.
enum class RequestWay : std::uint8_t {
  words,    ///< a word begins it, and shows its end: #1000, #22, #25 [FX3U-CAN 10]
  signals,  ///< Y17, Y1F and Y2 begin it, X17, X1F and X2 show its end [RJ71CN91 App.1]
};

/// A module whose settings are known here.
struct ModuleModel {
  std::string_view name;  ///< "FX3U-CAN"
  std::span<const Window> windows;
  RequestWay request_way;
  /// The object that a mapping entry stands for, as the details window names it: "BFM Area Unsigned16 (PLC write access),
  /// BFM#11000 (TO)", "Dummy Unsigned 8 bit"; empty: none of the module's.
  std::string (*object_name)(std::uint32_t mapping_entry);
};

/// The FX3U-CAN in CANopen 405 mode [FX3U-CAN 15.1.2].
[[nodiscard]] const ModuleModel& fx3u_can_settings() noexcept;
/// The RJ71CN91 in CANopen 405 mode [RJ71CN91 3.1].
[[nodiscard]] const ModuleModel& rj71cn91_settings() noexcept;
/// By name, in any case; nullptr: not known.
[[nodiscard]] const ModuleModel* find_module_model(std::string_view name) noexcept;
/// "FX3U-CAN, RJ71CN91"
[[nodiscard]] std::string module_model_names();

/// The field's default for this row of a module with this node-ID. Key 0: not a row.
[[nodiscard]] std::uint32_t factory_value(const Window& window, const Field& field, std::uint32_t key,
                                          std::uint32_t node_id) noexcept;

/// What a field takes: "1 to 127", "10, 20, 50 kbps", "High, Mid, Low".
[[nodiscard]] std::string shown_range(const Field& field);
/// What is wrong with a value, with the printed range ("Node ID = 128: expected 1 to 127"); empty: nothing.
[[nodiscard]] std::string why_not(const Field& field, std::uint32_t value);
/// A number, decimal or as 0x1F, or a word of the field ("Selected"); else what was expected.
[[nodiscard]] std::optional<std::uint32_t> parse_value(const Field& field, std::string_view text) noexcept;
/// As the window shows it: "0x40000181", "250", "Selected".
[[nodiscard]] std::string shown_value(const Field& field, std::uint32_t value);

}  // namespace canopus::project
