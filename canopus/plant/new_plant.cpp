#include "canopus/plant/new_plant.hpp"

#include <algorithm>
#include <bitset>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/canopen/dictionary/dictionary_description.hpp"
#include "canopus/plc/cpu/device.hpp"
#include "canopus/text/json.hpp"

namespace canopus::plant {

namespace {

constexpr std::uint32_t usual_bit_rate = 250'000;
constexpr unsigned heartbeat_ms = 500;
constexpr unsigned heartbeat_time_out_ms = 1500;
constexpr std::uint32_t pdo_is_off = 0x8000'0000;
constexpr std::uint64_t highest_synchronous = 240;

/// A basic string of TOML, whose escapes are those of JSON.
std::string quoted(const std::string& text) { return text::Json(text).dump(); }

bool is_writable(const canopen::DictionaryDescription& objects, std::uint16_t index, std::uint8_t sub = 0) {
  const canopen::Entry entry = objects.find(index, sub);
  return entry && canopen::is_writable(entry.description->access);
}

bool has_heartbeat(const NewDevice& device) { return is_writable(*device.file->dictionary, 0x1017); }

/// PDO1 of the device exists and is on.
bool has_pdo(const NewDevice& device, std::uint16_t communication) {
  const auto cob_id = eds::default_value(*device.file->dictionary, communication, 1, device.node_id);
  return cob_id && (*cob_id & pdo_is_off) == 0;
}

bool waits_for_sync(const NewDevice& device) {
  for (const std::uint16_t first : {std::uint16_t{0x1400}, std::uint16_t{0x1800}}) {
    for (std::uint16_t index = first; index < first + 8; ++index) {
      const auto type = eds::default_value(*device.file->dictionary, index, 2, device.node_id);
      if (type && *type <= highest_synchronous && has_pdo(device, index)) return true;
    }
  }
  return false;
}

/// ["6000:01", "6000:02"]: what the file maps into a PDO.
std::string mapped_objects(const NewDevice& device, std::uint16_t mapping) {
  std::string list;
  const auto count = eds::default_value(*device.file->dictionary, mapping, 0, device.node_id).value_or(0);
  for (std::uint8_t sub = 1; sub <= std::min<std::uint64_t>(count, 64); ++sub) {
    const auto object = eds::default_value(*device.file->dictionary, mapping, sub, device.node_id);
    const auto index = static_cast<std::uint16_t>(object.value_or(0) >> 16);
    if (index < 0x1000) continue;  // a dummy, or nothing
    list += fmt::format("{}\"{:04X}:{:02X}\"", list.empty() ? "" : ", ", index, *object >> 8 & 0xFF);
  }
  return list;
}

std::string device_text(const NewDevice& device) {
  std::string text = fmt::format("\n[[device]]\nnode = {}\nname = {}\neds = {}\n", device.node_id,
                                 quoted(device.name), quoted(device.path));
  if (has_heartbeat(device)) {
    text += fmt::format("objects = {{ \"1017:00\" = {} }}   # heartbeat in ms\n", heartbeat_ms);
  }
  return text;
}

/// Objects of the master: its heartbeat, those that it watches, and SYNC where a device waits for it.
std::string master_objects(const NewPlant& plant) {
  if (plant.module->objects == nullptr) return {};
  const auto objects = plant.module->objects();
  std::string text;
  const auto add = [&](std::string_view object, std::string_view value) {
    text += fmt::format("{}\"{}\" = {}", text.empty() ? "" : ", ", object, value);
  };
  if (is_writable(*objects, 0x1017)) add("1017:00", fmt::format("{}", heartbeat_ms));
  std::uint8_t sub = 0;
  for (const NewDevice& device : plant.devices) {
    if (!has_heartbeat(device) || !is_writable(*objects, 0x1016, static_cast<std::uint8_t>(sub + 1)))
      continue;
    add(fmt::format("1016:{:02X}", ++sub),
        fmt::format("0x{:04X}_{:04X}", unsigned{device.node_id}, heartbeat_time_out_ms));
  }
  const bool sync = std::ranges::any_of(plant.devices, waits_for_sync);
  if (sync && is_writable(*objects, 0x1005) && is_writable(*objects, 0x1006)) {
    add("1005:00", "0x4000_0080");
    add("1006:00", "100_000");
  }
  if (text.empty()) return {};
  std::string meaning = "heartbeat in ms";
  if (sub > 0) meaning += "; 1016H: node-ID and time-out of each heartbeat that is watched";
  if (text.contains("1006:00")) meaning += "; SYNC every 100 ms";
  return fmt::format("# {}\nobjects = {{ {} }}\n", meaning, text);
}

/// What the tool of a module with a node list downloads.
std::string download_text(const NewPlant& plant) {
  std::string text;
  for (const NewDevice& device : plant.devices) {
    text += fmt::format("\n[[plc.module.download.slave]]\nnode = {}\n", device.node_id);
    if (has_heartbeat(device)) text += fmt::format("heartbeat = \"{}ms\"\n", heartbeat_ms);
    const auto add = [&](std::string_view key, std::uint16_t communication, std::uint16_t mapping) {
      const std::string objects = mapped_objects(device, mapping);
      if (objects.empty() || !has_pdo(device, communication)) return;
      const auto type = eds::default_value(*device.file->dictionary, communication, 2, device.node_id);
      text += fmt::format("{} = [{{ number = 1, type = {}, objects = [{}] }}]\n", key, type.value_or(255),
                          objects);
    };
    add("rx_pdo", 0x1400, 0x1600);
    add("tx_pdo", 0x1800, 0x1A00);
  }
  return text;
}

std::string module_text(const NewPlant& plant) {
  const CatalogueEntry& module = *plant.module;
  const plc::FamilyInfo& family = plc::family_info(module.families.front());
  const unsigned place = module.only_place != 0 ? module.only_place : family.place.first;
  std::string text = "\n[[plc]]\nname = \"plc1\"\n";
  text += fmt::format("family = \"{}\"\n", family.name);
  if (plant.has_program)
    text += "program = [\"main.st\"]                 # Structured Text, executed once a scan\n";
  const bool is_delta = module.families.front() == plc::CpuFamily::as300;
  text += is_delta ? "listen = \"off\"                          # no MC protocol\n"
                     "\n[[plc.modbus]]\nlisten = \"127.0.0.1:1502\"               # Modbus TCP\n"
                   : "listen = \"127.0.0.1:5007\"               # MC protocol, 3E and 4E\n";
  text += fmt::format("\n[[plc.module]]\nmodel = \"{}\"\n{} = {}\nnode = {}\n", module.data_sheet->model,
                      family.place.key, place, plant.module_node_id);
  if (module.download != nullptr) return text + download_text(plant);
  text +=
      "master = true                           # NMT master\n"
      "slaves = \"all\"                          # boots the devices; RPDO1 and TPDO1 of each are words of "
      "the module\n"
      "exchange = \"20ms\"                       # the built-in PLC program exchanges the data this often\n";
  return text + master_objects(plant);
}

/// Words of a module as the list of connections has them: "U0\\G10000-G10003 <- TPDO1 of node 2 (drive), 182H, 7 bytes".
struct ConnectedWords {
  std::string_view module;   ///< "U0"
  unsigned first = 0;        ///< 10000
  unsigned last = 0;         ///< 10003
  std::string_view pdo;      ///< "TPDO1"
  std::string_view node;     ///< "2"
  std::string_view meaning;  ///< "TPDO1 of node 2 (drive), 182H, 7 bytes"
};

std::optional<ConnectedWords> connected_words(std::string_view line) {
  const auto before = [](std::string_view& rest, std::string_view end) {
    const std::size_t at = rest.find(end);
    const std::string_view word = rest.substr(0, at);
    rest.remove_prefix(at == std::string_view::npos ? rest.size() : at + end.size());
    return word;
  };
  ConnectedWords words;
  words.module = before(line, "\\G");
  std::string_view numbers = before(line, " ");
  const auto first = ascii::parse_number<unsigned>(before(numbers, "-G"));
  before(line, " ");  // the arrow
  words.meaning = line;
  words.pdo = before(line, " of node ");
  words.node = line.substr(0, line.find_first_not_of("0123456789"));
  if (!first || words.node.empty()) return std::nullopt;
  words.first = *first;
  words.last = numbers.empty() ? *first : ascii::parse_number<unsigned>(numbers).value_or(*first);
  return words;
}

/// node2_TPDO1 AT U0\G10000 : WORD; a PDO of several words has an underscore and the number of each.
std::string variables_text(const ConnectedWords& words) {
  std::string text = fmt::format("  // {}\n", words.meaning);
  for (unsigned word = words.first; word <= words.last; ++word) {
    const std::string number =
        words.first == words.last ? std::string() : fmt::format("_{}", word - words.first + 1);
    text +=
        fmt::format("  node{}_{}{} AT {}\\G{} : WORD;\n", words.node, words.pdo, number, words.module, word);
  }
  return text;
}

}  // namespace

std::string program_text(std::span<const std::string> connections) {
  std::string text =
      "(* The PLC program, executed once a scan. The network is started, and process data are exchanged, "
      "without it.\n"
      "   TPDO words are inputs of the PLC, RPDO words are outputs. docs/structured-text.md describes the "
      "language. *)\n";
  std::string variables;
  for (const std::string& line : connections) {
    if (const auto words = connected_words(line)) variables += variables_text(*words);
  }
  if (!variables.empty()) text += fmt::format("\nVAR_GLOBAL\n{}END_VAR\n", variables);
  return text + "\nPROGRAM Main\nVAR\n  scans : UDINT;\nEND_VAR\n\nscans := scans + 1;\nEND_PROGRAM\n";
}

std::string plant_text(const NewPlant& plant, std::span<const std::string> comments) {
  std::string text = fmt::format(
      "# An {} as NMT master of {}. Every key is explained in docs/plant-file.md.\n"
      "#   canopus check plant.toml     what is wrong with this file, and the words of each PDO\n"
      "#   canopus run plant.toml       runs it\n\n"
      "[plant]\nname = {}\nseed = 1\n\n[[bus]]\nname = \"line1\"\nbit_rate = {}\n",
      plant.module->data_sheet->model, ascii::counted(plant.devices.size(), "device"), quoted(plant.name),
      plant.bit_rate);
  for (const NewDevice& device : plant.devices) text += device_text(device);
  text += module_text(plant);
  if (!comments.empty()) text += "\n";
  for (const std::string& comment : comments) text += fmt::format("# {}\n", comment);
  return text;
}

std::expected<std::uint32_t, std::string> common_bit_rate(std::span<const NewDevice> devices) {
  std::vector<std::uint32_t> common;
  const NewDevice* first = nullptr;
  for (const NewDevice& device : devices) {
    const std::vector<std::uint32_t>& rates = device.file->device.bit_rates;
    if (rates.empty()) continue;
    if (first == nullptr) {
      first = &device;
      common = rates;
      continue;
    }
    std::erase_if(common, [&](std::uint32_t rate) { return std::ranges::find(rates, rate) == rates.end(); });
    if (common.empty()) {
      return std::unexpected(
          fmt::format("{} and {}: their device files have no bit rate in common", first->path, device.path));
    }
  }
  if (first == nullptr) return usual_bit_rate;
  const auto above = std::ranges::upper_bound(common, usual_bit_rate);
  return above == common.begin() ? common.front() : *std::prev(above);
}

std::uint8_t free_node_id(std::span<const NewDevice> devices) noexcept {
  std::bitset<128> used;
  for (const NewDevice& device : devices) used.set(device.node_id & 0x7F);
  for (std::uint8_t id = 1; id < 128; ++id) {
    if (!used.test(id)) return id;
  }
  return 0;
}

}  // namespace canopus::plant
