#include <algorithm>
#include <limits>
#include <set>

#include "canopus/eds/device_sections.hpp"
#include "canopus/eds/entry_reader.hpp"
#include "canopus/eds/number.hpp"
#include "canopus/eds/object_lists.hpp"
#include "canopus/eds/object_reader.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {
namespace {

using canopen::Access;
using canopen::DataType;
using canopen::ObjectCode;

constexpr std::size_t most_slots = 254;          // 1027H
constexpr std::size_t most_added_subs = 20'000;  // of a file made to annoy

std::string prefix(std::size_t module) { return 'm' + std::to_string(module); }

std::uint32_t number_or_zero(const Section& section, std::string_view key, Problems& problems) {
  const Item* item = section.find_value(key);
  if (item == nullptr) return 0;
  return static_cast<std::uint32_t>(
      read_unsigned(section, *item, std::numeric_limits<std::uint32_t>::max(), problems).value_or(0));
}

class ModularDevice {
 public:
  ModularDevice(const IniFile& file, Draft& draft, DeviceFile& device, Problems& problems)
      : file_(file), draft_(draft), device_(device), problems_(problems) {}

  void read() {
    const Section* supported = file_.find("supportedmodules");
    if (supported == nullptr) return;
    const Item* count = supported->find_value("nrofentries");
    const std::size_t modules =
        count == nullptr
            ? 0
            : read_unsigned(*supported, *count, most_slots, problems_, Problem::Severity::loss).value_or(0);
    for (std::size_t module = 1; module <= modules; ++module) read_module_info(module, *supported);

    const Section* connected = file_.find("connectedmodules");
    if (connected == nullptr) {
      problems_.note(supported->line, "a modular device, and no [ConnectedModules]: no module is plugged in");
      return;
    }
    read_slots(*connected);
    std::set<std::uint16_t> types(device_.connected.begin(), device_.connected.end());
    for (const std::uint16_t type : types) read_fixed_objects(type);
    for (const std::uint16_t type : device_.connected) read_extensions(type);
  }

 private:
  struct Extension {
    std::uint16_t index = 0;  // of the object that is being filled
    unsigned subs = 0;        // given out in it
    unsigned bits_left = 0;   // of the last sub-index, when modules share it
  };

  void read_module_info(std::size_t module, const Section& supported) {
    ModuleInfo info;
    const Section* section = file_.find(prefix(module) + "moduleinfo");
    if (section == nullptr) {
      problems_.warning(supported.line, "[M" + std::to_string(module) + "ModuleInfo] is missing");
    } else {
      if (const Item* item = section->find("productname")) info.product_name = to_utf8(item->value);
      if (const Item* item = section->find("ordercode")) info.order_code = to_utf8(item->value);
      info.product_version = number_or_zero(*section, "productversion", problems_);
      info.product_revision = number_or_zero(*section, "productrevision", problems_);
    }
    device_.modules.push_back(std::move(info));
  }

  void read_slots(const Section& connected) {
    for (const ListEntry& entry : read_list(connected, "nrofentries", problems_)) {
      const auto type = read_number(entry.item->value);
      if (!type || type->bits() == 0 || type->bits() > device_.modules.size()) {
        problems_.loss(entry.item->line, entry.item->key + '=' + printable(entry.item->value) + " in [" +
                                             connected.name + "]: there are modules 1 to " +
                                             std::to_string(device_.modules.size()) + ": slot left empty");
        continue;
      }
      if (device_.connected.size() == most_slots) {
        problems_.loss(entry.item->line, "more than " + std::to_string(most_slots) +
                                             " modules are plugged in: the others are left out");
        break;
      }
      device_.connected.push_back(static_cast<std::uint16_t>(type->magnitude));
    }
  }

  void read_fixed_objects(std::uint16_t type) {
    const ObjectSectionMap objects = find_object_sections(file_, prefix(type) + "fixed", problems_);
    if (const Section* list = file_.find(prefix(type) + "fixedobjects")) {
      for (const ListEntry& entry : read_list(*list, "nrofentries", problems_)) {
        const auto index = read_number(entry.item->value);
        if (index && index->bits() <= 0xFFFF && objects.contains(static_cast<std::uint16_t>(index->bits()))) {
          continue;
        }
        problems_.loss(entry.item->line, entry.item->key + '=' + printable(entry.item->value) + " in [" +
                                             list->name + "]: no section describes it: left out");
      }
    }
    for (const auto& [index, sections] : objects) {
      if (!draft_.contains(index)) read_object(draft_, index, sections, problems_);
    }
  }

  void read_extensions(std::uint16_t type) {
    const std::string start = prefix(type) + "subext";
    for (const Section& section : file_.sections()) {
      if (!section.folded_name.starts_with(start)) continue;
      const auto meaning = object_section(std::string_view(section.folded_name).substr(start.size()));
      if (meaning && meaning->kind == ObjectSection::Kind::head) extend(meaning->index, section);
    }
  }

  /// Count new sub-indexes for one plugged module, or a share of one: Count=0;bits.
  void extend(std::uint16_t index, const Section& section) {
    const ObjectKeys keys(section, problems_);
    EntryDraft entry = read_entry(keys, index, 1, {object_name(index), std::nullopt}, problems_);
    unsigned count = 1;
    unsigned shared_bits = 0;
    if (const Item* item = section.find_value("count")) {
      if (!read_number(item->value) && item->value.find(';') == std::string::npos) {
        problems_.loss(item->line, item->key + '=' + printable(item->value) + " in [" + section.name +
                                       "] is not a number: taken as 1");
      }
      if (const auto number = read_number(item->value)) {
        count = static_cast<unsigned>(std::min<std::uint64_t>(number->bits(), most_slots));
      }
      if (const std::size_t place = item->value.find(';'); place != std::string::npos && count == 0) {
        const auto bits = read_number(std::string_view(item->value).substr(place + 1));
        if (bits) shared_bits = static_cast<unsigned>(std::min<std::uint64_t>(bits->bits(), 64));
      }
    }
    unsigned per_object = most_slots;
    if (const std::uint32_t given = number_or_zero(section, "objextend", problems_); given != 0) {
      per_object = std::min<unsigned>(given, most_slots);
    }
    Extension& extension = extensions_.try_emplace(index, Extension{index}).first->second;
    if (shared_bits != 0) {
      if (extension.bits_left >= shared_bits) {
        extension.bits_left -= shared_bits;
        return;
      }
      const unsigned bits = canopen::bit_length(entry.spec.type);
      extension.bits_left = bits > shared_bits ? bits - shared_bits : 0;
      count = 1;
    }
    for (unsigned i = 0; i < count; ++i) add_sub(extension, entry, per_object, section);
  }

  void add_sub(Extension& extension, const EntryDraft& member, unsigned per_object, const Section& section) {
    if (extension.subs >= per_object) {
      if (extension.index == 0xFFFF) return;
      ++extension.index;
      extension.subs = 0;
    }
    const auto [place, is_new] = draft_.try_emplace(extension.index);
    ObjectDraft& object = place->second;
    if (is_new) {
      object.code = ObjectCode::array;
      object.name = member.spec.name;
      object.line = section.line;
    }
    if (object.uniform_count != 0 || !object.is_structured()) {
      problems_.loss(section.line, "[" + section.name + "]: " + object_name(extension.index) +
                                       " cannot take more sub-indexes");
      return;
    }
    if (object.highest_sub() >= most_slots || ++added_subs_ > most_added_subs) {
      problems_.repeated(Problem::Severity::loss, "too many extensions", section.line,
                         "[" + section.name + "]: " + object_name(extension.index) +
                             " would have too many sub-indexes: left out");
      return;
    }
    const auto sub = static_cast<std::uint8_t>(object.highest_sub() + 1);
    if (!object.subs.contains(0)) {
      object.subs.emplace(std::uint8_t{0}, made_entry("Highest sub-index supported", DataType::unsigned8,
                                                      Access::read_only, 0, section.line));
      object.subs.at(0).facts.index = extension.index;
    }
    EntryDraft copy = member;
    copy.facts.index = extension.index;
    copy.facts.sub = sub;
    object.subs.emplace(sub, std::move(copy));
    if (object.subs.at(0).spec.type == DataType::unsigned8) object.subs.at(0).set_number(sub);
    ++extension.subs;
  }

  const IniFile& file_;
  Draft& draft_;
  DeviceFile& device_;
  Problems& problems_;
  std::map<std::uint16_t, Extension> extensions_;
  std::size_t added_subs_ = 0;
};

}  // namespace

void read_modules(const IniFile& file, Draft& draft, DeviceFile& device, Problems& problems) {
  ModularDevice(file, draft, device, problems).read();
}

}  // namespace canopus::eds
