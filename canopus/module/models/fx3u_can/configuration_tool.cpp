// The windows of the FX3U-CAN's configuration tool [FX3U-CAN 15.1.2].

#include "canopus/module/models/fx3u_can/configuration_tool.hpp"

#include "canopus/module/q_iqr/window_fields.hpp"

namespace canopus::module::fx3u_can {
namespace {

constexpr std::array fx3u_basic{
    SettingField{.name = "Module number",
                 .unit = "",
                 .highest = 16,
                 .description = "0 to 7 behind an FX3, 1 to 16 behind an FX5"},
    window_fields::function_mode,
    window_fields::node_id,
    window_fields::baud_rate,
    SettingField{.name = "FROM/TO Watchdog",
                 .unit = "ms",
                 .highest = 65530,
                 .factory = 200,
                 .place = window_fields::word_at(26, 10),
                 .step = 10,
                 .description = "how long the program may leave the module alone; 0: for ever"},
    window_fields::sdo_timeout,
};
constexpr std::array<std::string_view, 3> fx3u_priorities{"High", "Medium",
                                                          "Low"};  // 1F90:03 [FX3U-CAN 5.8.11]
constexpr std::array fx3u_master = window_fields::master_fields(fx3u_priorities);
constexpr std::array fx3u_lists = window_fields::windows_of_lists(80, fx3u_master);

constexpr std::array fx3u_windows{
    SettingWindow{.word = "basic",
                  .title = "CANopen Configuration: Module basic settings",
                  .key = "",
                  .fields = fx3u_basic,
                  .part = "basic"},
    fx3u_lists[0],
    fx3u_lists[1],
    fx3u_lists[2],
    fx3u_lists[3],
    fx3u_lists[4],
    fx3u_lists[5],
};

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

std::string buffer_name(const BufferObjects& objects, std::uint32_t object, std::uint32_t sub, bool to) {
  constexpr std::uint32_t words = 320, words_of_object = 120;
  const std::uint32_t base = to ? 11000 : 10000;
  const std::string_view direction = to ? "TO" : "FROM";
  const std::uint32_t number =
      object * words_of_object * 16U / objects.bits + sub - 1;  // of values of this width
  const std::string head =
      window_fields::joined("BFM Area ", objects.type, " (PLC ", to ? "write" : "read", " access), BFM#");
  if (objects.bits == 8) {
    if (number >= 2 * words) return {};
    return window_fields::joined(head, base + number / 2, number % 2 == 0 ? " L" : " H", "Byte (", direction,
                                 ")");
  }
  if (objects.bits == 16) {
    if (number >= words) return {};
    return window_fields::joined(head, base + number, " (", direction, ")");
  }
  if (number >= words / 2) return {};
  return window_fields::joined(head, base + 2 * number + 1, ", #", base + 2 * number, " (", direction, ")");
}

std::string fx3u_object_name(std::uint32_t mapping_entry) {
  const std::uint32_t index = mapping_entry >> 16, sub = mapping_entry >> 8 & 0xFF,
                      bits = mapping_entry & 0xFF;
  if (const std::string_view dummy = window_fields::dummy_name(mapping_entry); !dummy.empty())
    return std::string(dummy);
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

}  // namespace

constinit const ConfigurationTool configuration_tool{.model = "FX3U-CAN",
                                                     .windows = fx3u_windows,
                                                     .request_method = RequestMethod::words,
                                                     .object_name = fx3u_object_name};

}  // namespace canopus::module::fx3u_can
