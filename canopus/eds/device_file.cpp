#include "canopus/eds/device_file.hpp"

#include <algorithm>
#include <utility>

#include "canopus/can/little_endian.hpp"
#include "canopus/eds/communication_defaults.hpp"
#include "canopus/eds/device_sections.hpp"
#include "canopus/eds/foreign_files.hpp"
#include "canopus/eds/object_lists.hpp"
#include "canopus/eds/object_reader.hpp"
#include "canopus/eds/user_types.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/eds/xdd.hpp"

namespace canopus::eds {
namespace {

using canopen::Access;
using canopen::DataType;
using canopen::ObjectCode;
using Severity = Problem::Severity;

constexpr std::size_t most_sub_indexes = 100'000;  // so that no file takes all memory
constexpr std::size_t most_limits = 65'000;        // EntryDescription::limits has 16 bits

Draft read_objects(const ObjectSectionMap& sections, Problems& problems) {
  Draft draft;
  std::size_t sub_indexes = 0;
  for (const auto& [index, object] : sections) {
    if (sub_indexes > most_sub_indexes) {
      const Section* section = object.head != nullptr ? object.head : nullptr;
      problems.loss(section != nullptr ? section->line : 1, "more than " + std::to_string(most_sub_indexes) +
                                                                " sub-indexes: " + object_name(index) +
                                                                " and all above are left out");
      break;
    }
    read_object(draft, index, object, problems);
    if (const auto place = draft.find(index); place != draft.end()) sub_indexes += place->second.subs.size();
  }
  return draft;
}

/// 1000H, 1001H and 1018H must exist [CiA 301]. True: 1018H had to be made, and has no values yet.
bool complete_mandatory_objects(Draft& draft, const IniFile& file, Problems& problems) {
  const Section* list = file.find("mandatoryobjects");
  const unsigned line = list != nullptr ? list->line : 1;
  const auto variable = [&](std::uint16_t index, std::string_view name, DataType type) {
    if (draft.contains(index)) return;
    ObjectDraft object;
    object.name = name;
    object.line = line;
    EntryDraft entry = made_entry(object.name, type, Access::read_only, 0, line);
    entry.facts.index = index;
    object.subs.emplace(std::uint8_t{0}, std::move(entry));
    draft.emplace(index, std::move(object));
    problems.warning(line, "mandatory object " + object_name(index) + " (" + std::string(name) +
                               ") is missing: made, with value 0");
  };
  variable(0x1000, "Device type", DataType::unsigned32);
  variable(0x1001, "Error register", DataType::unsigned8);
  if (draft.contains(0x1018)) return false;
  ObjectDraft identity;
  identity.code = ObjectCode::record;
  identity.name = "Identity object";
  identity.line = line;
  constexpr std::string_view names[] = {"Highest sub-index supported", "Vendor-ID", "Product code",
                                        "Revision number", "Serial number"};
  for (std::uint8_t sub = 0; sub <= 4; ++sub) {
    EntryDraft entry =
        made_entry(std::string(names[sub]), sub == 0 ? DataType::unsigned8 : DataType::unsigned32,
                   Access::read_only, sub == 0 ? 4 : 0, line);
    entry.has_value = sub == 0;
    entry.facts.index = 0x1018;
    entry.facts.sub = sub;
    identity.subs.emplace(sub, std::move(entry));
  }
  draft.emplace(std::uint16_t{0x1018}, std::move(identity));
  problems.warning(line, "mandatory object 1018H (Identity object) is missing: made");
  return true;
}

/// 1018H and [DeviceInfo] contain the same identity twice; the one that the device answers (1018H) wins.
void compare_identity(Draft& draft, const DeviceFile& device, const Section* info, bool is_made,
                      Problems& problems) {
  struct Part {
    std::uint8_t sub;
    std::string_view key;  // as the file has it
    std::optional<std::uint32_t> number;
  };
  const auto key = [&](std::string_view folded_key, std::string_view key_of_eds) {
    const Item* item = info == nullptr ? nullptr : info->find(folded_key);
    return item == nullptr ? key_of_eds : std::string_view(item->key);
  };
  const Part parts[] = {{1, key("vendornumber", "VendorNumber"), device.device.vendor_number},
                        {2, key("productnumber", "ProductNumber"), device.device.product_number},
                        {3, key("revisionnumber", "RevisionNumber"), device.device.revision_number}};
  for (const Part& part : parts) {
    EntryDraft* entry = find(draft, 0x1018, part.sub);
    if (entry == nullptr || !part.number || canopen::byte_length(entry->spec.type) == 0) continue;
    if (!entry->has_value) {
      entry->set_number(*part.number);
      if (*part.number != 0 && !is_made) {
        problems.note(entry->facts.line,
                      object_text(0x1018, part.sub) + " has no value: taken from " + std::string(part.key));
      }
    } else if (entry->number() != *part.number) {
      const bool says_nothing = *part.number == 0 || *part.number == 0xFFFF'FFFF;
      problems.report(says_nothing ? Severity::note : Severity::warning, entry->value_line,
                      object_text(0x1018, part.sub) + " is " + std::to_string(entry->number()) + ", but " +
                          std::string(part.key) + " in [" + (info == nullptr ? "DeviceInfo" : info->name) +
                          "] is " + std::to_string(*part.number) + ": the object counts");
    }
  }
  EntryDraft* serial = find(draft, 0x1018, 4);
  if (serial != nullptr && !serial->has_value && device.commissioning) {
    serial->set_number(device.commissioning->lss_serial_number);
  }
}

void review_device_type(Draft& draft, Problems& problems) {
  const EntryDraft* entry = find(draft, 0x1000, 0);
  if (entry == nullptr || entry->spec.type != DataType::unsigned32) return;
  if (!entry->has_value) {
    problems.warning(entry->facts.line, "1000H (Device type) has no value: taken as 0");
    return;
  }
  // 0 is none, 301 to 499 are the numbers of CiA's device profiles.
  const std::uint64_t profile = entry->number() & 0xFFFF;
  if (profile != 0 && (profile < 301 || profile > 499)) {
    problems.warning(entry->value_line, "1000H (Device type) names device profile " +
                                            std::to_string(profile) +
                                            ", which CiA does not have; the value is kept");
  }
}

/// Values for download without a node to download them to.
void review_configuration(const Draft& draft, const DeviceFile& device, Problems& problems) {
  if (device.commissioning) return;
  for (const auto& [index, object] : draft) {
    for (const auto& [sub, entry] : object.subs) {
      if (!entry.facts.configured) continue;
      problems.repeated(Severity::note, "configured", entry.value_line,
                        object_text(index, sub) +
                            " has a ParameterValue, which counts, but the file has no " +
                            "[DeviceComissioning]");
    }
  }
}

void compare_pdo_counts(const DeviceFile& device, const DeviceInfoLines& lines, Problems& problems) {
  const PdoCount found = count_pdos(*device.dictionary);
  const auto compare = [&](unsigned announced, unsigned described, unsigned line, std::string_view key,
                           std::string_view what) {
    if (announced == described || line == 1) return;
    problems.note(line, std::string(key) + '=' + std::to_string(announced) + ", but " +
                            counted(described, what) + " described");
  };
  compare(device.device.rpdos, found.rpdos, lines.rpdos, "NrOfRXPDO", "RPDO");
  compare(device.device.tpdos, found.tpdos, lines.tpdos, "NrOfTXPDO", "TPDO");
}

/// Members that differ in nothing at all need only one description.
void join_alike_members(ObjectDraft& object) {
  constexpr std::size_t worth_it = 4;
  if (object.uniform_count != 0 || !object.is_structured() || object.subs.size() <= worth_it ||
      !object.subs.contains(0) || object.highest_sub() != object.subs.size() - 1) {
    return;
  }
  const EntryDraft& first = object.subs.at(1);
  for (const auto& [sub, entry] : object.subs) {
    if (sub == 0) continue;
    const canopen::EntrySpec& a = first.spec;
    const canopen::EntrySpec& b = entry.spec;
    const bool alike = a.name == b.name && a.type == b.type && a.access == b.access && a.value == b.value &&
                       a.adds_node_id == b.adds_node_id && a.rpdo_mappable == b.rpdo_mappable &&
                       a.tpdo_mappable == b.tpdo_mappable && a.stored == b.stored &&
                       a.limits.low == b.limits.low && a.limits.high == b.limits.high &&
                       first.facts.object_flags == entry.facts.object_flags &&
                       first.facts.configured == entry.facts.configured &&
                       first.facts.denotation == entry.facts.denotation &&
                       first.facts.description == entry.facts.description &&
                       first.facts.upload_file == entry.facts.upload_file &&
                       first.facts.download_file == entry.facts.download_file;
    if (!alike) return;
  }
  object.uniform_count = object.highest_sub();
  object.subs.erase(std::next(object.subs.begin(), 2), object.subs.end());
}

/// The draft is used up.
void build(Draft& draft, DeviceFile& device, Problems& problems) {
  canopen::DictionaryBuilder builder;
  std::vector<EntryFacts> facts;
  std::size_t limits = 0;
  for (auto& [index, object] : draft) {
    join_alike_members(object);
    for (auto& [sub, entry] : object.subs) {
      entry.facts.index = index;
      entry.facts.sub = sub;
      facts.push_back(std::move(entry.facts));
      if (!entry.spec.limits.low && !entry.spec.limits.high) continue;
      if (++limits <= most_limits) continue;
      entry.spec.limits = {};
      problems.repeated(Severity::loss, "too many limits", facts.back().line,
                        "more than " + std::to_string(most_limits) + " sub-indexes with limits: those of " +
                            object_text(index, sub) + " are left out");
    }
    if (!object.is_structured()) {
      canopen::EntrySpec spec = std::move(object.subs.begin()->second.spec);
      spec.name = std::move(object.name);
      builder.variable(index, std::move(spec));
      continue;
    }
    if (object.uniform_count != 0) {
      builder.uniform(index, object.code, std::move(object.name), object.uniform_count,
                      std::move(object.subs.at(1).spec));
      builder.sub(index, 0, std::move(object.subs.at(0).spec));
      continue;
    }
    builder.object(index, object.code, std::move(object.name));
    for (auto& [sub, entry] : object.subs) builder.sub(index, sub, std::move(entry.spec));
  }
  device.facts = std::move(facts);
  device.dictionary = builder.build();
}

/// Why there is no device in this text: the wrong file was opened.
void refuse(std::string_view text, const IniFile& file, Problems& problems) {
  if (trim(text).empty() || text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    problems.error(1, "the file is empty");
  } else if (const std::string_view kind = foreign_kind(text, file); !kind.empty()) {
    problems.error(1,
                   "this is " + std::string(kind) + " and no device file of CANopen (EDS, DCF, XDD or XDC)");
  } else if (file.sections().empty()) {
    problems.error(file.first_strange_line(), "this is not an EDS or DCF: there is not one [section]");
  } else {
    problems.error(file.sections().front().line,
                   "no object is described: an EDS has sections such as [1000] and [1018sub1]");
  }
}

std::optional<IniFile> read_ini(std::string_view text, Problems& problems) {
  IniFile file(text, problems);
  if (text.size() > largest_ini_text) return std::nullopt;
  return file;
}

}  // namespace

ReadResult read_device_file(std::string_view text) {
  Problems problems;
  const bool is_xdd = is_xml(text);
  std::optional<IniFile> read = is_xdd ? read_xdd(text, problems) : read_ini(text, problems);
  if (!read) return {nullptr, problems.release()};
  const IniFile file = with_base_types(*std::move(read), problems);
  const ObjectSectionMap sections = find_object_sections(file, "", problems);
  Draft draft = read_objects(sections, problems);
  if (draft.empty()) {
    if (is_xdd) {
      problems.error(1, "no object is described: CANopenObjectList has no object from 1000H on");
    } else {
      refuse(text, file, problems);
    }
    return {nullptr, problems.release()};
  }

  auto device = std::make_shared<DeviceFile>();
  read_file_info(file, device->file, problems);
  const DeviceInfoLines lines = read_device_info(file, device->device, problems);
  device->commissioning = read_commissioning(file, problems);
  device->dummy_usage = read_dummy_usage(file, problems);
  device->comments = read_comments(file);
  if (!is_xdd) check_object_lists(file, sections, problems);
  read_modules(file, draft, *device, problems);
  const bool identity_is_made = complete_mandatory_objects(draft, file, problems);
  compare_identity(draft, *device, file.find("deviceinfo"), identity_is_made, problems);
  review_device_type(draft, problems);
  generate_compact_pdos(draft, device->device, lines.section, problems);
  set_missing_defaults(draft, problems);
  repair_cob_ids(draft, problems);
  review_restricted_identifiers(draft, problems);
  review_mappings(draft, device->dummy_usage, problems);
  review_configuration(draft, *device, problems);
  report_unread(file, problems);
  note_unknown_sections(file, problems);
  build(draft, *device, problems);
  compare_pdo_counts(*device, lines, problems);
  return {std::move(device), problems.release()};
}

const EntryFacts* DeviceFile::find_facts(std::uint16_t index, std::uint8_t sub) const noexcept {
  const canopen::Entry entry = dictionary->find(index, sub);
  if (!entry) return nullptr;
  const std::uint8_t described = sub != 0 && dictionary->find(index)->uniform ? std::uint8_t{1} : sub;
  const auto place = std::ranges::lower_bound(facts, std::pair(index, described), {},
                                              [](const EntryFacts& f) { return std::pair(f.index, f.sub); });
  if (place == facts.end() || place->index != index || place->sub != described) return nullptr;
  return &*place;
}

std::optional<std::uint64_t> default_value(const canopen::DictionaryDescription& dictionary,
                                           std::uint16_t index, std::uint8_t sub, std::uint8_t node_id) {
  const canopen::Entry entry = dictionary.find(index, sub);
  if (!entry || entry.description->length == 0) return std::nullopt;
  return dictionary.default_value(entry, node_id);
}

Identity identity(const DeviceFile& file) {
  const auto part = [&](std::uint16_t index, std::uint8_t sub) -> std::optional<std::uint32_t> {
    const auto value = default_value(*file.dictionary, index, sub, 0);
    if (!value) return std::nullopt;
    return static_cast<std::uint32_t>(*value);
  };
  return {part(0x1000, 0), part(0x1018, 1), part(0x1018, 2), part(0x1018, 3), part(0x1018, 4)};
}

PdoCount count_pdos(const canopen::DictionaryDescription& dictionary) noexcept {
  PdoCount count;
  for (const canopen::ObjectDescription& object : dictionary.objects()) {
    if (object.index >= 0x1400 && object.index <= 0x15FF) ++count.rpdos;
    if (object.index >= 0x1800 && object.index <= 0x19FF) ++count.tpdos;
  }
  return count;
}

}  // namespace canopus::eds
