#include "canopus/project/module_windows.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

namespace canopus::project {
namespace {

using Kind = Place::Kind;

constexpr std::uint32_t any_word = 0xFFFF;
constexpr std::uint32_t any_long = 0xFFFF'FFFF;

constexpr std::array<std::uint32_t, 9> baud_rates{10, 20, 50, 100, 125, 250, 500, 800, 1000};
constexpr std::array<std::string_view, 2> check_box{"Not selected", "Selected"};
constexpr std::array<std::string_view, 3> priorities{"High", "Medium", "Low"};  // 1F90H:03 [FX3U-CAN 5.8.11]
constexpr std::array<std::uint32_t, 1> mode_405{405};

constexpr Place word_at(std::uint32_t number, std::uint16_t factor = 1) {
  return {.kind = Kind::word, .number = number, .bytes = 2, .factor = factor};
}
constexpr Place object(std::uint32_t index, std::uint8_t sub, std::uint8_t bytes) {
  return {.kind = Kind::object, .number = index, .sub = sub, .bytes = bytes};
}
constexpr Place bit_of(std::uint32_t index, std::uint8_t bit) {
  return {.kind = Kind::object, .number = index, .first_bit = bit, .bits = 1};
}
constexpr Place pdo(std::uint32_t index, std::uint8_t sub, std::uint8_t bytes) {
  return {.kind = Kind::pdo_object, .number = index, .sub = sub, .bytes = bytes};
}
constexpr Place of_node(std::uint32_t index, std::uint8_t first_bit = 0, std::uint8_t bits = 0) {
  return {.kind = Kind::node_object, .number = index, .first_bit = first_bit, .bits = bits};
}
constexpr Field box(std::string_view name, Place place) {
  return {.name = name, .unit = "", .highest = 1, .place = place, .words = check_box};
}
constexpr Field time_field(std::string_view name, std::string_view unit, std::uint32_t highest,
                           std::uint32_t factory, Place place) {
  return {.name = name, .unit = unit, .highest = highest, .factory = factory, .place = place};
}

// In the order of the windows.
constexpr std::array basic{
    Field{.name = "Module number", .unit = "", .highest = 16},
    Field{.name = "Function mode",
          .unit = "",
          .lowest = 405,
          .highest = 405,
          .factory = 405,
          .place = word_at(21),
          .choices = mode_405,
          .read_only = true},
    Field{.name = "Node ID", .unit = "", .lowest = 1, .highest = 127, .factory = 127, .place = word_at(27)},
    Field{.name = "Baud-Rate",
          .unit = "kbps",
          .lowest = 10,
          .highest = 1000,
          .factory = 250,
          .place = word_at(24),
          .choices = baud_rates},
    Field{.name = "FROM/TO Watchdog",
          .unit = "ms",
          .highest = 65530,
          .factory = 200,
          .place = word_at(26, 10),
          .step = 10},
    Field{.name = "SDO timeout",
          .unit = "ms",
          .lowest = 50,
          .highest = 32767,
          .factory = 500,
          .place = word_at(71)},
};

constexpr Field transmission_type(std::uint32_t index) {
  return {.name = "Transmission type",
          .unit = "",
          .highest = 0xFF,
          .factory = 0xFE,
          .place = pdo(index, 2, 1),
          .hexadecimal = true};
}
constexpr Field cob_id(std::uint32_t index) {
  return {.name = "COB-ID", .unit = "", .highest = any_long, .place = pdo(index, 1, 4), .hexadecimal = true};
}
constexpr std::array transmit_pdo{
    cob_id(0x1800),
    transmission_type(0x1800),
    time_field("Inhibit time", "100us", any_word, 0, pdo(0x1800, 3, 2)),
    time_field("Event timer", "ms", any_word, 0, pdo(0x1800, 5, 2)),
};
constexpr std::array receive_pdo{cob_id(0x1400), transmission_type(0x1400)};

constexpr std::array master{
    box("NMT master", bit_of(0x1F80, 0)),
    box("Start all nodes", bit_of(0x1F80, 1)),
    box("NMT master start", bit_of(0x1F80, 2)),
    box("Start node", bit_of(0x1F80, 3)),
    box("Reset all nodes", bit_of(0x1F80, 4)),
    box("Stop all nodes", bit_of(0x1F80, 6)),
    time_field("SYNC - Communication cycle period", "us", any_long, 0, object(0x1006, 0, 4)),
    time_field("Boot time", "ms", any_long, 0, object(0x1F89, 0, 4)),
    time_field("Start all nodes delay", "ms", any_word, 500, word_at(70)),
    box("Flying master", bit_of(0x1F80, 5)),
    time_field("Timeout", "ms", any_word, 100, object(0x1F90, 1, 2)),
    time_field("NMT master negotiation time delay", "ms", any_word, 500, object(0x1F90, 2, 2)),
    Field{.name = "NMT master priority",
          .unit = "",
          .highest = 2,
          .factory = 1,
          .place = object(0x1F90, 3, 2),
          .words = priorities},
    time_field("Priority time slot", "ms", any_word, 1500, object(0x1F90, 4, 2)),
    time_field("CANopen device time slot", "ms", any_word, 10, object(0x1F90, 5, 2)),
    time_field("Multiple NMT master detect cycle time", "ms", any_word, 4000, object(0x1F90, 6, 2)),
    time_field("Guard time", "ms", any_word, 0, object(0x100C, 0, 2)),
    time_field("Life time factor", "", 255, 0, object(0x100D, 0, 1)),
};

constexpr Field identity(std::string_view name, std::uint32_t index, bool hexadecimal) {
  return {.name = name, .unit = "", .highest = any_long, .place = of_node(index), .hexadecimal = hexadecimal};
}
constexpr std::array slaves{
    box("NMT slave", of_node(0x1F81, 0, 1)),
    box("NMT boot slave", of_node(0x1F81, 2, 1)),
    box("Mandatory", of_node(0x1F81, 3, 1)),
    box("Reset communication", of_node(0x1F81, 4, 1)),
    Field{.name = "Retry factor", .unit = "", .highest = 255, .place = of_node(0x1F81, 8, 8)},
    Field{.name = "Guard time", .unit = "ms", .highest = any_word, .place = of_node(0x1F81, 16, 16)},
    identity("Device type", 0x1F84, false),
    identity("Vendor-ID", 0x1F85, true),
    identity("Product code", 0x1F86, false),
    identity("Revision number", 0x1F87, true),
    identity("Serial number", 0x1F88, true),
};

constexpr std::array consumers{
    Field{.name = "Consumer heartbeat time",
          .unit = "ms",
          .highest = any_word,
          .place = {.kind = Kind::consumer, .number = 0x1016}},
};
constexpr std::array producer{time_field("Producer heartbeat time", "ms", any_word, 0, object(0x1017, 0, 2))};

constexpr std::array windows{
    Window{.word = "basic",
           .title = "CANopen Configuration: Module basic settings",
           .key = "",
           .fields = basic,
           .part = "basic"},
    Window{.word = "tpdo",
           .title = "PDO list: Transmit PDO",
           .key = "PDO number",
           .most_key = 80,
           .most_rows = 80,
           .fields = transmit_pdo,
           .mapping = 0x1A00,
           .part = "tpdo"},
    Window{.word = "rpdo",
           .title = "PDO list: Receive PDO",
           .key = "PDO number",
           .most_key = 80,
           .most_rows = 80,
           .fields = receive_pdo,
           .mapping = 0x1600,
           .part = "rpdo"},
    Window{.word = "master",
           .title = "NMT settings: NMT master / slave",
           .key = "",
           .fields = master,
           .part = "nmt"},
    Window{.word = "slave",
           .title = "NMT settings: NMT Slave assignment",
           .key = "Node ID",
           .most_key = 127,
           .most_rows = 126,
           .fields = slaves,
           .part = "nmt"},
    Window{.word = "consumer",
           .title = "NMT settings: Heartbeat, consumer",
           .key = "Node ID",
           .most_key = 127,
           .most_rows = 126,
           .fields = consumers,
           .part = "nmt"},
    Window{.word = "producer",
           .title = "NMT settings: Heartbeat, producer",
           .key = "",
           .fields = producer,
           .part = "nmt"},
};

constexpr ModuleModel the_fx3u_can{.name = "FX3U-CAN", .windows = windows};

/// A kind of the module's own objects: its first index, how many objects follow each other, and what lies in a sub-index.
struct BufferObjects {
  std::uint16_t first, count;
  std::string_view type;
  std::uint8_t bits;
};
// [FX3U-CAN 5.9]; 40H further for each type, in the order of the manual.
constexpr std::array to_bus{
    BufferObjects{0xA000, 3, "Integer8", 8},   BufferObjects{0xA040, 3, "Unsigned8", 8},
    BufferObjects{0xA0C0, 3, "Integer16", 16}, BufferObjects{0xA100, 3, "Unsigned16", 16},
    BufferObjects{0xA1C0, 1, "Integer32", 32}, BufferObjects{0xA200, 1, "Unsigned32", 32},
    BufferObjects{0xA240, 1, "Float", 32},
};
constexpr std::uint16_t from_bus = 0x480;  // the same objects for RPDOs

constexpr std::array<std::string_view, 8> dummies{"",
                                                  "",
                                                  "Dummy Signed 8 bit",
                                                  "Dummy Signed 16 bit",
                                                  "Dummy Signed 32 bit",
                                                  "Dummy Unsigned 8 bit",
                                                  "Dummy Unsigned 16 bit",
                                                  "Dummy Unsigned 32 bit"};

std::string buffer_name(const BufferObjects& objects, std::uint32_t object, std::uint32_t sub, bool to) {
  constexpr std::uint32_t words = 320, words_of_object = 120;
  const std::uint32_t base = to ? 11000 : 10000;
  const std::string_view direction = to ? "TO" : "FROM";
  const std::uint32_t number =
      object * words_of_object * 16U / objects.bits + sub - 1;  // of values of this width
  const std::string head =
      fmt::format("BFM Area {} (PLC {} access), BFM#", objects.type, to ? "write" : "read");
  if (objects.bits == 8) {
    if (number >= 2 * words) return {};
    return fmt::format("{}{} {}Byte ({})", head, base + number / 2, number % 2 == 0 ? 'L' : 'H', direction);
  }
  if (objects.bits == 16) {
    if (number >= words) return {};
    return fmt::format("{}{} ({})", head, base + number, direction);
  }
  if (number >= words / 2) return {};
  return fmt::format("{}{}, #{} ({})", head, base + 2 * number + 1, base + 2 * number, direction);
}

bool same_letters(std::string_view a, std::string_view b) noexcept {
  const auto lower = [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter;
  };
  return std::ranges::equal(a, b, {}, lower, lower);
}

}  // namespace

const ModuleModel& fx3u_can_settings() noexcept { return the_fx3u_can; }

const ModuleModel* find_module_model(std::string_view name) noexcept {
  return same_letters(name, the_fx3u_can.name) ? &the_fx3u_can : nullptr;
}

std::uint32_t factory_value(const Window& window, const Field& field, std::uint32_t key,
                            std::uint32_t node_id) noexcept {
  if (field.name == "COB-ID") {
    const bool transmits = window.mapping == 0x1A00;
    const std::uint32_t no_rtr = transmits ? 0x4000'0000 : 0;
    if (key >= 1 && key <= 4) return no_rtr + (transmits ? 0x80U : 0x100U) + 0x100 * key + node_id;
    return 0x8000'0000 | no_rtr;
  }
  if (field.name == "Multiple NMT master detect cycle time") return field.factory + 10 * node_id;
  return field.factory;
}

std::string why_not(const Field& field, std::uint32_t value) {
  const auto unit = field.unit.empty() ? std::string() : fmt::format(" {}", field.unit);
  if (!field.choices.empty()) {
    if (std::ranges::find(field.choices, value) != field.choices.end()) return {};
    return fmt::format("{} = {}: expected {}{}", field.name, value, fmt::join(field.choices, ", "), unit);
  }
  if (value < field.lowest || value > field.highest) {
    if (!field.words.empty())
      return fmt::format("{} = {}: expected {}", field.name, value, fmt::join(field.words, ", "));
    return fmt::format("{} = {}: expected {} to {}{}", field.name, shown_value(field, value),
                       shown_value(field, field.lowest), shown_value(field, field.highest), unit);
  }
  if (value % field.step != 0)
    return fmt::format("{} = {}: expected steps of {}{}", field.name, value, field.step, unit);
  return {};
}

std::optional<std::uint32_t> parse_value(const Field& field, std::string_view text) noexcept {
  for (std::size_t i = 0; i < field.words.size(); ++i) {
    if (same_letters(text, field.words[i])) return static_cast<std::uint32_t>(i);
  }
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  std::uint32_t value = 0;
  const auto [end, failure] =
      std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string shown_value(const Field& field, std::uint32_t value) {
  if (value < field.words.size()) return std::string(field.words[value]);
  if (!field.hexadecimal) return fmt::format("{}", value);
  return field.highest <= 0xFF ? fmt::format("0x{:02X}", value) : fmt::format("0x{:08X}", value);
}

std::string object_name(std::uint32_t mapping_entry) {
  const std::uint32_t index = mapping_entry >> 16, sub = mapping_entry >> 8 & 0xFF,
                      bits = mapping_entry & 0xFF;
  if (index < dummies.size() && sub == 0) return std::string(dummies[index]);
  for (const BufferObjects& objects : to_bus) {
    for (const bool to : {true, false}) {
      const std::uint32_t first = objects.first + (to ? 0U : from_bus);
      if (index < first || index >= first + objects.count || bits != objects.bits) continue;
      const std::uint32_t most = objects.bits == 8 ? 240 : objects.bits == 16 ? 120 : 160;
      if (sub >= 1 && sub <= most) return buffer_name(objects, index - first, sub, to);
    }
  }
  return {};
}

}  // namespace canopus::project
