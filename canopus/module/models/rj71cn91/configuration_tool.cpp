// The windows of the RJ71CN91's configuration tool [RJ71CN91 3.1].

#include "canopus/module/models/rj71cn91/configuration_tool.hpp"

#include "canopus/module/q_iqr/window_fields.hpp"

namespace canopus::module::rj71cn91 {
namespace {

constexpr std::array rj71_basic{
    SettingField{.name = "Module address",
                 .unit = "",
                 .highest = 0xFE0,
                 .step = 0x10,
                 .hexadecimal = true,
                 .description = "start I/O number of the module"},
    window_fields::function_mode,
    window_fields::node_id,
    window_fields::baud_rate,
    window_fields::sdo_timeout,
};
constexpr std::array<std::string_view, 3> rj71_priorities{"High", "Mid", "Low"};  // 1F90:03
constexpr std::array rj71_master = window_fields::master_fields(rj71_priorities);
constexpr std::array rj71_lists = window_fields::windows_of_lists(256, rj71_master);

constexpr std::array<std::string_view, 2> download_targets{"CPU module", "Target node"};
constexpr std::array rj71_nodes{
    SettingField{.name = "Download target",
                 .unit = "",
                 .highest = 1,
                 .words = download_targets,
                 .description =
                     "CPU module: the configuration manager brings it the settings, 60 nodes at most; "
                     "Target node: they are written through the module; this module: CPU module"},
};

constexpr std::array rj71_windows{
    SettingWindow{
        .word = "basic", .title = "CANopen Configuration", .key = "", .fields = rj71_basic, .part = "basic"},
    SettingWindow{.word = "node",
                  .title = "CANopen node list",
                  .key = "Node ID",
                  .most_key = 127,
                  .most_rows = 127,
                  .fields = rj71_nodes,
                  .part = "",
                  .name_field = "Node name"},
    rj71_lists[0],
    rj71_lists[1],
    rj71_lists[2],
    rj71_lists[3],
    rj71_lists[4],
    rj71_lists[5],
};

/// A kind of the network variables: its first index, and the width of an element.
struct NetworkVariables {
  std::uint16_t first;
  std::string_view type;
  std::uint8_t bits;
};
constexpr std::array transmit_variables{
    NetworkVariables{0xA000, "Integer8", 8},   NetworkVariables{0xA040, "Unsigned8", 8},
    NetworkVariables{0xA0C0, "Integer16", 16}, NetworkVariables{0xA100, "Unsigned16", 16},
    NetworkVariables{0xA1C0, "Integer32", 32}, NetworkVariables{0xA200, "Unsigned32", 32},
    NetworkVariables{0xA240, "Real32", 32},
};
constexpr std::uint32_t to_receive = 0x480;  // the same for RPDOs
constexpr std::uint32_t elements_of_object = 0xFE;
constexpr std::uint32_t words_of_area = 1024;

std::string element_name(const NetworkVariables& variables, std::uint32_t element, std::uint32_t base) {
  const std::string head = window_fields::joined("Buffer Memory Area ", variables.type, ", Un\\G");
  if (variables.bits == 8)
    return window_fields::joined(head, base + element / 2, element % 2 == 0 ? " L" : " H", "Byte");
  if (variables.bits == 16) return window_fields::joined(head, base + element);
  return window_fields::joined(head, base + 2 * element, "-Un\\G", base + 2 * element + 1);
}

std::string rj71_object_name(std::uint32_t mapping_entry) {
  const std::uint32_t index = mapping_entry >> 16, sub = mapping_entry >> 8 & 0xFF,
                      bits = mapping_entry & 0xFF;
  if (const std::string_view dummy = window_fields::dummy_name(mapping_entry); !dummy.empty())
    return std::string(dummy);
  for (const NetworkVariables& variables : transmit_variables) {
    const std::uint32_t elements = words_of_area * 16 / variables.bits;
    for (const bool transmits : {true, false}) {
      const std::uint32_t first = variables.first + (transmits ? 0 : to_receive);
      if (index < first || bits != variables.bits || sub < 1 || sub > elements_of_object) continue;
      const std::uint32_t element = (index - first) * elements_of_object + sub - 1;
      if (element < elements) return element_name(variables, element, transmits ? 13000 : 10000);
    }
  }
  return {};
}

}  // namespace

constinit const ConfigurationTool configuration_tool{.model = "RJ71CN91",
                                                     .windows = rj71_windows,
                                                     .request_method = RequestMethod::signals,
                                                     .object_name = rj71_object_name};

}  // namespace canopus::module::rj71cn91
