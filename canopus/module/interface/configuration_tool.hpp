#pragma once
// The settings of a module as its configuration tool has them: windows of fields, each with its printed name, range and default, and
// with the word or object it stands for. Facts of a model, in its folder.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace canopus::module {

/// Where a field's value lies in the module.
struct SettingPlace {
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

/// A field of a window.
struct SettingField {
  std::string_view name;  ///< as printed: "FROM/TO Watchdog"
  std::string_view unit;  ///< "ms"; empty: none
  std::uint32_t lowest = 0;
  std::uint32_t highest = 0;
  /// The default; of some fields it depends on PDO number and node-ID, see factory_value().
  std::uint32_t factory = 0;
  SettingPlace place{};
  std::uint32_t step = 1;
  bool hexadecimal = false;
  std::span<const std::uint32_t> choices{};   ///< nothing else is taken; empty: the whole range
  std::span<const std::string_view> words{};  ///< names of the values from 0 on: "Not selected", "Selected"
  bool read_only = false;
  std::string_view description{};  ///< what the description window says of it, in short
};

/// A window holds one set of fields, or a list of rows with a number each.
struct SettingWindow {
  std::string_view word;       ///< "tpdo", for command lines and files
  std::string_view title;      ///< "PDO list: Transmit PDO"
  std::string_view key;        ///< what the number of a row is: "PDO number"; empty: no rows
  std::uint32_t most_key = 0;  ///< keys are 1 to this
  std::uint32_t most_rows = 1;
  std::span<const SettingField> fields{};
  std::uint16_t mapping = 0;  ///< 1A00H or 1600H: rows have mapped objects; 0: they have none
  std::string_view
      part;  ///< read and written together: "basic", "tpdo", "rpdo", "nmt"; empty: only in the project
  std::string_view
      name_field{};  ///< rows have a name, and this is what it is called: "Node name"; empty: they have none
};

/// How a module takes requests of the PLC's program.
enum class RequestMethod : std::uint8_t {
  words,    ///< a word begins it, and shows its end: #1000, #22, #25 [FX3U-CAN 10]
  signals,  ///< Y17, Y1F and Y2 begin it, X17, X1F and X2 show its end [RJ71CN91 App.1]
};

/// What the configuration tool of a module shows.
struct ConfigurationTool {
  std::string_view model;  ///< "FX3U-CAN"
  std::span<const SettingWindow> windows;
  RequestMethod request_method;
  /// The object that a mapping entry stands for, as the details window names it: "BFM Area Unsigned16 (PLC write access),
  /// BFM#11000 (TO)", "Dummy Unsigned 8 bit"; empty: none of the module's.
  std::string (*object_name)(std::uint32_t mapping_entry);
};

}  // namespace canopus::module
