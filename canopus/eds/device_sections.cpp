#include "canopus/eds/device_sections.hpp"

#include <algorithm>
#include <limits>

#include "canopus/can/controller.hpp"
#include "canopus/eds/draft.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using Severity = Problem::Severity;

/// One section, read key by key; keys may be misspelt.
class SectionReader {
 public:
  /// `unreadable`: what a value that is no number is.
  SectionReader(const Section& section, Problems& problems, Severity unreadable = Severity::warning)
      : section_(section), problems_(problems), unreadable_(unreadable) {}

  [[nodiscard]] const Item* find(std::string_view key) const {
    const Item* item = section_.find(key);
    if (item == nullptr) {
      const auto place = std::ranges::find_if(
          section_.items, [&](const Item& other) { return is_misspelt(other.folded_key, key); });
      // A key one letter off may well be another key: NrOfRXPDO, NrOfTXPDO.
      if (place != section_.items.end() && place->folded_key.front() == key.front() &&
          key.substr(0, 4) != "nrof" && key.substr(0, 4) != "baud" && key.find("bootup") == key.npos) {
        item = &*place;
      }
    }
    return item != nullptr && !item->value.empty() ? item : nullptr;
  }
  void text(std::string_view key, std::string& value) const {
    if (const Item* item = find(key)) value = to_utf8(item->value);
  }
  /// The line of the key, or of the section.
  template <typename T>
  unsigned number(std::string_view key, T& value) const {
    const Item* item = find(key);
    if (item == nullptr) return section_.line;
    if (const auto given =
            read_unsigned(section_, *item, std::numeric_limits<T>::max(), problems_, unreadable_)) {
      value = static_cast<T>(*given);
    }
    return item->line;
  }
  void number(std::string_view key, std::optional<std::uint32_t>& value) const {
    std::uint32_t given = 0;
    const Item* item = find(key);
    if (item == nullptr) return;
    if (const auto read = read_unsigned(section_, *item, std::numeric_limits<std::uint32_t>::max(), problems_,
                                        unreadable_)) {
      given = static_cast<std::uint32_t>(*read);
      value = given;
    }
  }
  void flag(std::string_view key, bool& value) const {
    std::uint32_t number_value = value ? 1 : 0;
    number(key, number_value);
    value = number_value != 0;
  }

 private:
  const Section& section_;
  Problems& problems_;
  Severity unreadable_;
};

}  // namespace

void read_file_info(const IniFile& file, FileInfo& info, Problems& problems) {
  const Section* section = file.find_or_misspelt("fileinfo", "FileInfo", problems);
  if (section == nullptr) {
    problems.note(1, "there is no [FileInfo]");
    return;
  }
  const SectionReader reader(*section, problems);
  reader.text("filename", info.file_name);
  reader.number("fileversion", info.version);
  reader.number("filerevision", info.revision);
  reader.text("edsversion", info.eds_version);
  reader.text("description", info.description);
  reader.text("creationtime", info.creation_time);
  reader.text("creationdate", info.creation_date);
  reader.text("createdby", info.created_by);
  reader.text("modificationtime", info.modification_time);
  reader.text("modificationdate", info.modification_date);
  reader.text("modifiedby", info.modified_by);
  reader.text("lasteds", info.last_eds);
}

DeviceInfoLines read_device_info(const IniFile& file, DeviceInfo& info, Problems& problems) {
  DeviceInfoLines lines;
  const Section* section = file.find_or_misspelt("deviceinfo", "DeviceInfo", problems);
  if (section == nullptr) {
    problems.warning(1, "there is no [DeviceInfo]: vendor, product and bit rates are unknown");
    return lines;
  }
  lines.section = section->line;
  const SectionReader reader(*section, problems);
  reader.text("vendorname", info.vendor_name);
  reader.text("productname", info.product_name);
  reader.text("ordercode", info.order_code);
  reader.number("vendornumber", info.vendor_number);
  reader.number("productnumber", info.product_number);
  reader.number("revisionnumber", info.revision_number);
  for (const std::uint32_t rate : can::bit_rates) {
    bool supported = false;
    reader.flag("baudrate" + std::to_string(rate / 1000), supported);
    if (supported) info.bit_rates.push_back(rate);
  }
  reader.flag("simplebootupmaster", info.simple_boot_up_master);
  reader.flag("simplebootupslave", info.simple_boot_up_slave);
  reader.number("granularity", info.granularity);
  reader.number("dynamicchannelssupported", info.dynamic_channels);
  reader.flag("groupmessaging", info.group_messaging);
  lines.rpdos = reader.number("nrofrxpdo", info.rpdos);
  lines.tpdos = reader.number("nroftxpdo", info.tpdos);
  reader.flag("lsssupported", info.lss);
  reader.number("compactpdo", info.compact_pdo);
  if (info.bit_rates.empty()) {
    problems.note(section->line, "[" + section->name + "] names no bit rate the device supports");
  }
  if (info.granularity > 64) {
    problems.warning(section->line, "Granularity=" + std::to_string(info.granularity) + ": 0 to 64 bits");
  }
  return lines;
}

std::optional<Commissioning> read_commissioning(const IniFile& file, Problems& problems) {
  const Section* section = file.find("devicecomissioning");  // [CiA 306] spells it so
  if (section == nullptr)
    section = file.find_or_misspelt("devicecommissioning", "DeviceComissioning", problems);
  if (section == nullptr) return std::nullopt;
  Commissioning commissioning;
  const SectionReader reader(*section, problems, Severity::loss);
  std::optional<std::uint32_t> node_id;
  reader.number("nodeid", node_id);
  if (node_id && *node_id >= 1 && *node_id <= 127) {
    commissioning.node_id = static_cast<std::uint8_t>(*node_id);
  } else if (node_id) {
    const Item* item = section->find("nodeid");
    problems.loss(item != nullptr ? item->line : section->line,
                  "NodeID=" + std::to_string(*node_id) + " in [" + section->name +
                      "]: a node-ID is 1 to 127: taken as not given");
  }
  reader.text("nodename", commissioning.node_name);
  std::uint16_t kilobits = 0;
  const unsigned line = reader.number("baudrate", kilobits);
  if (kilobits != 0 && std::ranges::find(can::bit_rates, kilobits * 1000U) == std::end(can::bit_rates)) {
    problems.warning(line, "Baudrate=" + std::to_string(kilobits) + " kbit/s is none of CANopen's bit rates");
  }
  commissioning.bit_rate = kilobits * 1000U;
  reader.number("netnumber", commissioning.net_number);
  reader.text("networkname", commissioning.network_name);
  reader.flag("canopenmanager", commissioning.canopen_manager);
  reader.number("lssserialnumber", commissioning.lss_serial_number);
  return commissioning;
}

std::uint32_t read_dummy_usage(const IniFile& file, Problems& problems) {
  const Section* section = file.find_or_misspelt("dummyusage", "DummyUsage", problems);
  if (section == nullptr) return 0;
  std::uint32_t usage = 0;
  for (const Item& item : section->items) {
    std::optional<Number> index;
    if (item.folded_key.starts_with("dummy")) index = read_number("0x" + item.folded_key.substr(5));
    if (!index || index->magnitude == 0 || index->magnitude > 0x1F) {
      problems.repeated(
          Severity::note, "dummy key", item.line,
          "key " + item.key + " in [" + section->name + "] is no Dummy0001 to Dummy001F: skipped");
      continue;
    }
    if (item.value.empty()) continue;
    if (read_unsigned(*section, item, 1, problems).value_or(0) != 0) usage |= 1U << index->magnitude;
  }
  return usage;
}

std::vector<std::string> read_comments(const IniFile& file) {
  std::vector<std::string> lines;
  const Section* section = file.find("comments");
  if (section == nullptr) return lines;
  for (const Item& item : section->items) {
    if (item.folded_key != "lines") lines.push_back(to_utf8(item.value));
  }
  return lines;
}

void report_unread(const IniFile& file, Problems& problems) {
  if (const Section* channels = file.find("dynamicchannels")) {
    const Item* const segments = channels->find_value("nrofseg");
    const auto count = segments == nullptr ? std::nullopt : read_number(segments->value);
    if (segments != nullptr && (!count || count->magnitude != 0)) {
      problems.loss(
          segments->line,
          "[" + channels->name + "]: the dynamic channels of a programmable device (CiA 302) are left out");
    }
  }
  for (const Section& section : file.sections()) {
    const Item* const mapping = section.find_value("srdomapping");
    if (mapping == nullptr || !object_section(section.folded_name)) continue;
    const auto number = read_number(mapping->value);
    if (number && number->magnitude == 0) continue;
    problems.loss(mapping->line,
                  mapping->key + '=' + printable(mapping->value) + " in [" + section.name +
                      "]: safety-relevant data objects (EN 50325-5) are not known here: left out");
  }
}

void note_unknown_sections(const IniFile& file, Problems& problems) {
  constexpr std::string_view known[] = {"fileinfo",
                                        "deviceinfo",
                                        "dummyusage",
                                        "comments",
                                        "mandatoryobjects",
                                        "optionalobjects",
                                        "manufacturerobjects",
                                        "supportedmodules",
                                        "connectedmodules",
                                        "devicecomissioning",
                                        "devicecommissioning",
                                        "dynamicchannels",
                                        "tools",
                                        "standarddatatypes"};
  const auto is_numbered = [](std::string_view name, std::string_view stem, std::string_view rest) {
    if (!name.starts_with(stem)) return false;
    name.remove_prefix(stem.size());
    const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
    return digits != 0 && name.substr(digits).starts_with(rest);
  };
  for (const Section& section : file.sections()) {
    const std::string_view name = section.folded_name;
    if (std::ranges::find(known, name) != std::end(known) || object_section(name)) continue;
    if (!nearest(name, known).empty() || is_numbered(name, "tool", "")) continue;
    constexpr std::string_view module_sections[] = {"moduleinfo", "comments", "fixed", "subext"};
    if (std::ranges::any_of(module_sections, [&](auto rest) { return is_numbered(name, "m", rest); }))
      continue;
    problems.repeated(Severity::note, "unknown section", section.line,
                      "section [" + section.name + "] is not known here: skipped");
  }
}

}  // namespace canopus::eds
