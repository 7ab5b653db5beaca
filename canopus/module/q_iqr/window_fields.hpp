#pragma once
// Fields that the windows of several modules have in common: both tools write the same objects of CiA 301 and CiA 302
// [FX3U-CAN 15.1.2] [RJ71CN91 3.1].

#include <array>
#include <string>
#include <type_traits>

#include "canopus/module/interface/configuration_tool.hpp"

namespace canopus::module::window_fields {

inline constexpr std::uint32_t any_word = 0xFFFF;
inline constexpr std::uint32_t any_long = 0xFFFF'FFFF;

inline constexpr std::array<std::uint32_t, 9> baud_rates{10, 20, 50, 100, 125, 250, 500, 800, 1000};
inline constexpr std::array<std::string_view, 2> check_box{"Not selected", "Selected"};
inline constexpr std::array<std::uint32_t, 1> mode_405{405};

constexpr SettingPlace word_at(std::uint32_t number, std::uint16_t factor = 1) {
  return {.kind = SettingPlace::Kind::word, .number = number, .bytes = 2, .factor = factor};
}
constexpr SettingPlace object(std::uint32_t index, std::uint8_t sub, std::uint8_t bytes) {
  return {.kind = SettingPlace::Kind::object, .number = index, .sub = sub, .bytes = bytes};
}
constexpr SettingPlace bit_of(std::uint32_t index, std::uint8_t bit) {
  return {.kind = SettingPlace::Kind::object, .number = index, .first_bit = bit, .bits = 1};
}
constexpr SettingPlace pdo(std::uint32_t index, std::uint8_t sub, std::uint8_t bytes) {
  return {.kind = SettingPlace::Kind::pdo_object, .number = index, .sub = sub, .bytes = bytes};
}
constexpr SettingPlace of_node(std::uint32_t index, std::uint8_t first_bit = 0, std::uint8_t bits = 0) {
  return {.kind = SettingPlace::Kind::node_object, .number = index, .first_bit = first_bit, .bits = bits};
}
constexpr SettingField box(std::string_view name, SettingPlace place, std::string_view description) {
  return {
      .name = name, .unit = "", .highest = 1, .place = place, .words = check_box, .description = description};
}
constexpr SettingField time_field(std::string_view name, std::string_view unit, std::uint32_t highest,
                                  std::uint32_t factory, SettingPlace place, std::string_view description) {
  return {.name = name,
          .unit = unit,
          .highest = highest,
          .factory = factory,
          .place = place,
          .description = description};
}

inline constexpr SettingField function_mode{.name = "Function mode",
                                            .unit = "",
                                            .lowest = 405,
                                            .highest = 405,
                                            .factory = 405,
                                            .place = word_at(21),
                                            .choices = mode_405,
                                            .read_only = true,
                                            .description = "the tool sets up CANopen 405 mode only"};
inline constexpr SettingField node_id{.name = "Node ID",
                                      .unit = "",
                                      .lowest = 1,
                                      .highest = 127,
                                      .factory = 127,
                                      .place = word_at(27),
                                      .description = "of this module"};
inline constexpr SettingField baud_rate{.name = "Baud-Rate",
                                        .unit = "kbps",
                                        .lowest = 10,
                                        .highest = 1000,
                                        .factory = 250,
                                        .place = word_at(24),
                                        .choices = baud_rates,
                                        .description = "of the bus, the same for all nodes"};
inline constexpr SettingField sdo_timeout{.name = "SDO timeout",
                                          .unit = "ms",
                                          .lowest = 50,
                                          .highest = 32767,
                                          .factory = 500,
                                          .place = word_at(71),
                                          .description = "how long the module waits for an SDO answer"};

constexpr SettingField transmission_type(std::uint32_t index, std::string_view description) {
  return {.name = "Transmission type",
          .unit = "",
          .highest = 0xFF,
          .factory = 0xFE,
          .place = pdo(index, 2, 1),
          .hexadecimal = true,
          .description = description};
}
constexpr SettingField cob_id(std::uint32_t index) {
  return {.name = "COB-ID",
          .unit = "",
          .highest = any_long,
          .place = pdo(index, 1, 4),
          .hexadecimal = true,
          .description = "\"valid\" and \"CAN-ID (11-bit)\" in one, as the object has them"};
}
inline constexpr std::array transmit_pdo{
    cob_id(0x1800),
    transmission_type(0x1800,
                      "0x00 after a change with the next SYNC, 0x01 to 0xF0 with each 1st to 240th SYNC, "
                      "0xF1 to 0xFD reserved, 0xFE and 0xFF by event"),
    time_field("Inhibit time", "100us", any_word, 0, pdo(0x1800, 3, 2),
               "shortest time between two transmissions, for types 0xFE and 0xFF; 0: off"),
    time_field("Event timer", "ms", any_word, 0, pdo(0x1800, 5, 2),
               "longest time between two transmissions, for types 0xFE and 0xFF; 0: off"),
};
inline constexpr std::array receive_pdo{
    cob_id(0x1400),
    transmission_type(0x1400, "0x00 to 0xF0 taken over with the next SYNC, 0xFE and 0xFF at once")};

/// `priorities`: the words of 1F90:03, from 0 on.
constexpr std::array<SettingField, 18> master_fields(std::span<const std::string_view> priorities) {
  return {
      box("NMT master", bit_of(0x1F80, 0), "the module is the NMT master (1F80H bit 0)"),
      box("Start all nodes", bit_of(0x1F80, 1),
          "slaves are started by one request to all, not each by its own (1F80H bit 1)"),
      box("NMT master start", bit_of(0x1F80, 2),
          "selected: the master does not go to Operational by itself (1F80H bit 2)"),
      box("Start node", bit_of(0x1F80, 3),
          "selected: the program starts the slaves, not the master (1F80H bit 3)"),
      box("Reset all nodes", bit_of(0x1F80, 4),
          "an error of a mandatory slave resets all; without effect if Stop all nodes is selected (1F80H bit "
          "4)"),
      box("Stop all nodes", bit_of(0x1F80, 6), "an error of a mandatory slave stops all (1F80H bit 6)"),
      time_field("SYNC - Communication cycle period", "us", any_long, 0, object(0x1006, 0, 4), "0: no SYNC"),
      time_field("Boot time", "ms", any_long, 0, object(0x1F89, 0, 4),
                 "how long the master waits for mandatory slaves; 0: for ever"),
      time_field("Start all nodes delay", "ms", any_word, 500, word_at(70),
                 "after the communication reset; of this module only"),
      box("Flying master", bit_of(0x1F80, 5),
          "several masters agree which one is the active one (1F80H bit 5)"),
      time_field("Timeout", "ms", any_word, 100, object(0x1F90, 1, 2),
                 "of the look for an active NMT master (1F90:01)"),
      time_field("NMT master negotiation time delay", "ms", any_word, 500, object(0x1F90, 2, 2),
                 "before the negotiation (1F90:02)"),
      SettingField{.name = "NMT master priority",
                   .unit = "",
                   .highest = 2,
                   .factory = 1,
                   .place = object(0x1F90, 3, 2),
                   .words = priorities,
                   .description = "in the negotiation (1F90:03)"},
      time_field("Priority time slot", "ms", any_word, 1500, object(0x1F90, 4, 2),
                 "more than 127 times the CANopen device time slot (1F90:04)"),
      time_field("CANopen device time slot", "ms", any_word, 10, object(0x1F90, 5, 2), "1F90:05"),
      time_field("Multiple NMT master detect cycle time", "ms", any_word, 4000, object(0x1F90, 6, 2),
                 "how often the active master looks for another one (1F90:06)"),
      time_field("Guard time", "ms", any_word, 0, object(0x100C, 0, 2),
                 "of the life guarding of this module; 0: off"),
      time_field("Life time factor", "", 255, 0, object(0x100D, 0, 1),
                 "of the life guarding of this module; 0: off"),
  };
}

constexpr SettingField identity(std::string_view name, std::uint32_t index, bool hexadecimal,
                                std::string_view description) {
  return {.name = name,
          .unit = "",
          .highest = any_long,
          .place = of_node(index),
          .hexadecimal = hexadecimal,
          .description = description};
}
inline constexpr std::array slaves{
    box("NMT slave", of_node(0x1F81, 0, 1), "the node is a slave of this master (1F81H bit 0)"),
    box("NMT boot slave", of_node(0x1F81, 2, 1), "the master configures and starts it (1F81H bit 2)"),
    box("Mandatory", of_node(0x1F81, 3, 1), "the network does not start without it (1F81H bit 3)"),
    box("Reset communication", of_node(0x1F81, 4, 1),
        "selected: it is not reset while it is Operational (1F81H bit 4)"),
    SettingField{.name = "Retry factor",
                 .unit = "",
                 .highest = 255,
                 .place = of_node(0x1F81, 8, 8),
                 .description = "of node guarding; 0: off"},
    SettingField{.name = "Guard time",
                 .unit = "ms",
                 .highest = any_word,
                 .place = of_node(0x1F81, 16, 16),
                 .description = "of node guarding; 0: off"},
    identity("Device type", 0x1F84, false, "expected in 1000H; 0: any; of a boot slave"),
    identity("Vendor-ID", 0x1F85, true, "expected in 1018:01; 0: any; of a boot slave"),
    identity("Product code", 0x1F86, false, "expected in 1018:02; 0: any; of a boot slave"),
    identity("Revision number", 0x1F87, true, "expected in 1018:03; 0: any; of a boot slave"),
    identity("Serial number", 0x1F88, true, "expected in 1018:04; 0: any; of a boot slave"),
};

inline constexpr std::array consumers{
    SettingField{.name = "Consumer heartbeat time",
                 .unit = "ms",
                 .highest = any_word,
                 .place = {.kind = SettingPlace::Kind::consumer, .number = 0x1016},
                 .description = "how long the node's heartbeat may stay away; 0: not watched"},
};
inline constexpr std::array producer{time_field("Producer heartbeat time", "ms", any_word, 0,
                                                object(0x1017, 0, 2),
                                                "how often the module sends its own; 0: never")};

/// The windows of a tool but the first, in its order.
constexpr std::array<SettingWindow, 6> windows_of_lists(std::uint32_t most_pdos,
                                                        std::span<const SettingField> master) {
  return {
      SettingWindow{.word = "tpdo",
                    .title = "PDO list: Transmit PDO",
                    .key = "PDO number",
                    .most_key = most_pdos,
                    .most_rows = most_pdos,
                    .fields = transmit_pdo,
                    .mapping = 0x1A00,
                    .part = "tpdo"},
      SettingWindow{.word = "rpdo",
                    .title = "PDO list: Receive PDO",
                    .key = "PDO number",
                    .most_key = most_pdos,
                    .most_rows = most_pdos,
                    .fields = receive_pdo,
                    .mapping = 0x1600,
                    .part = "rpdo"},
      SettingWindow{.word = "master",
                    .title = "NMT settings: NMT master / slave",
                    .key = "",
                    .fields = master,
                    .part = "nmt"},
      SettingWindow{.word = "slave",
                    .title = "NMT settings: NMT Slave assignment",
                    .key = "Node ID",
                    .most_key = 127,
                    .most_rows = 126,
                    .fields = slaves,
                    .part = "nmt"},
      SettingWindow{.word = "consumer",
                    .title = "NMT settings: Heartbeat, consumer",
                    .key = "Node ID",
                    .most_key = 127,
                    .most_rows = 126,
                    .fields = consumers,
                    .part = "nmt"},
      SettingWindow{.word = "producer",
                    .title = "NMT settings: Heartbeat, producer",
                    .key = "",
                    .fields = producer,
                    .part = "nmt"},
  };
}

/// Texts and numbers, one after the other.
template <typename... Parts>
std::string joined(const Parts&... parts) {
  const auto text_of = [](const auto& part) {
    if constexpr (std::is_integral_v<std::decay_t<decltype(part)>>) {
      return std::to_string(part);
    } else {
      return std::string_view(part);
    }
  };
  std::string text;
  (text.append(text_of(parts)), ...);
  return text;
}

/// The dummy objects of CiA 301 by their index; empty: none.
constexpr std::string_view dummy_name(std::uint32_t mapping_entry) {
  constexpr std::array<std::string_view, 8> names{"",
                                                  "",
                                                  "Dummy Signed 8 bit",
                                                  "Dummy Signed 16 bit",
                                                  "Dummy Signed 32 bit",
                                                  "Dummy Unsigned 8 bit",
                                                  "Dummy Unsigned 16 bit",
                                                  "Dummy Unsigned 32 bit"};
  const std::uint32_t index = mapping_entry >> 16, sub = mapping_entry >> 8 & 0xFF;
  return index < names.size() && sub == 0 ? names[index] : std::string_view();
}

}  // namespace canopus::module::window_fields
