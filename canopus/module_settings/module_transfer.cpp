#include "canopus/module_settings/module_transfer.hpp"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"

namespace canopus::module_settings {
namespace {

using Kind = Place::Kind;
template <typename Value>
using Result = ModuleAccess::Result<Value>;

constexpr std::uint32_t no_rtr = 0x4000'0000;

/// A word or an object of the module that contains fields.
struct Target {
  bool is_word = false;
  std::uint32_t number = 0;  ///< address or index
  std::uint8_t sub = 0;
  std::uint8_t bytes = 4;

  auto operator<=>(const Target&) const = default;
  [[nodiscard]] std::string name() const {
    return is_word ? fmt::format("G{}", number) : canopen::object_text(number, sub);
  }
};

Target target_of(const Field& field, std::uint32_t key, std::uint8_t consumer) {
  const Place& place = field.place;
  switch (place.kind) {
    case Kind::word: return {true, place.number, 0, 2};
    case Kind::pdo_object: return {false, place.number + key - 1, place.sub, place.bytes};
    case Kind::node_object: return {false, place.number, static_cast<std::uint8_t>(key), place.bytes};
    case Kind::consumer: return {false, place.number, consumer, 4};
    case Kind::object:
    case Kind::none: break;
  }
  return {false, place.number, place.sub, place.bytes};
}

std::uint32_t mask_of(const Place& place) { return 0xFFFF'FFFF >> (place.bits == 0 ? 0 : 32 - place.bits); }

/// A value that a module must have, and what its fields are called.
struct Wanted {
  std::uint32_t value = 0;
  std::string fields;
};
using WantedValues = std::map<Target, Wanted>;

void want(WantedValues& wanted, const Window& window, const Field& field, std::uint32_t key,
          std::uint32_t value, std::uint8_t consumer) {
  if (field.place.kind == Kind::none || field.read_only) return;
  std::uint32_t part = value / field.place.factor;
  if (field.place.kind == Kind::consumer) part |= key << 16;
  Wanted& all = wanted[target_of(field, key, consumer)];
  all.value |= (part & mask_of(field.place)) << field.place.first_bit;
  if (all.fields.empty()) {
    all.fields = window.key.empty() ? fmt::format("{}: {}", window.word, field.name)
                                    : fmt::format("{} {}: {}", window.word, key, field.name);
  } else {
    all.fields += fmt::format(", {}", field.name);
  }
}

/// The values of a window, of lists by node also those of nodes that are not listed: 0.
WantedValues wanted_of(const ModuleProject& project, const Window& window) {
  WantedValues wanted;
  std::uint8_t consumer = 0;
  for (const auto& [key, row] : project.rows(window)) {
    ++consumer;
    for (std::size_t i = 0; i < window.fields.size(); ++i)
      want(wanted, window, window.fields[i], key, row.values[i], consumer);
  }
  if (window.word != "slave" && window.word != "consumer") return wanted;
  for (std::uint32_t number = 1; number <= window.most_key; ++number) {
    for (const Field& field : window.fields) {
      const Target target = target_of(field, number, static_cast<std::uint8_t>(number));
      wanted.try_emplace(target, Wanted{0, fmt::format("{} {}: not listed", window.word, number)});
    }
  }
  return wanted;
}

using Values = std::map<Target, std::uint32_t>;

/// Reads all these targets of the module. For another node than the module no words.
Result<Values> read(ModuleAccess& access, std::uint8_t node, const std::vector<Target>& targets) {
  Values values;
  std::vector<Target> objects;
  std::vector<ObjectNumber> numbers;
  for (const Target& target : targets) {
    if (!target.is_word) {
      objects.push_back(target);
      numbers.push_back({static_cast<std::uint16_t>(target.number), target.sub});
    } else if (node == 0) {
      const auto word = access.read_word(target.number);
      if (!word) return std::unexpected(word.error());
      values[target] = *word;
    }
  }
  const auto read = access.read_objects(node, numbers);
  if (!read) return std::unexpected(read.error());
  for (std::size_t i = 0; i < objects.size(); ++i) values[objects[i]] = (*read)[i];
  return values;
}

Result<void> write(ModuleAccess& access, std::uint8_t node, const Target& target, std::uint32_t value) {
  if (target.is_word) return access.write_word(target.number, static_cast<std::uint16_t>(value));
  return access.write_object(node, {static_cast<std::uint16_t>(target.number), target.sub}, value,
                             target.bytes);
}

/// Bit 30 of a COB-ID of a TPDO is always 1 in these modules, regardless of the written value [FX3U-CAN
/// 5.6.5] [RJ71CN91 App.3].
bool same(const Target& target, std::uint32_t device, std::uint32_t project) {
  const bool cob_id = !target.is_word && target.number >= 0x1800 && target.number < 0x1A00 && target.sub == 1;
  return cob_id ? (device | no_rtr) == (project | no_rtr) : device == project;
}

std::string shown(const Target& target, std::uint32_t value) {
  return target.is_word ? fmt::format("{}", value) : fmt::format("{:0{}X}H", value, 2 * target.bytes);
}

/// A window's place in a transfer of this part.
bool is_in(const Window& window, std::string_view part) {
  return !window.part.empty() && (part == "all" || window.part == part);
}

struct Different {
  Wanted wanted;
  std::uint32_t device = 0;
};

/// The values that differ in a module, by target.
Result<std::map<Target, Different>> differing(const ModuleProject& project, const Window& window,
                                              std::uint8_t node, ModuleAccess& access) {
  const WantedValues wanted = wanted_of(project, window);
  std::vector<Target> targets;
  for (const auto& [target, value] : wanted) targets.push_back(target);
  const auto device = read(access, node, targets);
  if (!device) return std::unexpected(device.error());
  std::map<Target, Different> different;
  for (const auto& [target, value] : *device) {
    if (!same(target, value, wanted.at(target).value)) different[target] = {wanted.at(target), value};
  }
  return different;
}

Result<std::vector<std::uint32_t>> read_mapping(ModuleAccess& access, std::uint8_t node,
                                                std::uint32_t index) {
  const Target number{false, index, 0, 1};
  const auto count = read(access, node, {number});
  if (!count) return std::unexpected(count.error());
  std::vector<Target> targets;
  for (std::uint32_t sub = 1; sub <= std::min<std::uint32_t>(count->at(number), 64); ++sub) {
    targets.push_back({false, index, static_cast<std::uint8_t>(sub), 4});
  }
  const auto entries = read(access, node, targets);
  if (!entries) return std::unexpected(entries.error());
  std::vector<std::uint32_t> mapping;
  for (const auto& [target, entry] : *entries) mapping.push_back(entry);  // in the order of the sub-indices
  return mapping;
}

std::string shown_mapping(const std::vector<std::uint32_t>& mapping) {
  std::string text;
  for (const std::uint32_t entry : mapping) text += fmt::format("{}{:08X}H", text.empty() ? "" : " ", entry);
  return text.empty() ? "nothing" : text;
}

/// The PDO's own window and row, and what of it differs.
struct PdoDifference {
  bool communication = false;
  bool mapping = false;
  std::vector<Difference> shown;
};

Result<PdoDifference> pdo_difference(const Window& window, std::uint32_t number, const Row& row,
                                     std::uint8_t node, ModuleAccess& access) {
  PdoDifference found;
  std::vector<Target> targets;
  for (const Field& field : window.fields) targets.push_back(target_of(field, number, 0));
  const auto device = read(access, node, targets);
  if (!device) return std::unexpected(device.error());
  for (std::size_t i = 0; i < window.fields.size(); ++i) {
    const std::uint32_t value = device->at(targets[i]);
    if (same(targets[i], value, row.values[i])) continue;
    found.communication = true;
    found.shown.push_back(
        {fmt::format("{} {}: {} ({})", window.word, number, window.fields[i].name, targets[i].name()),
         shown(targets[i], value), shown(targets[i], row.values[i])});
  }
  const auto mapping = read_mapping(access, node, window.mapping + number - 1);
  if (!mapping) return std::unexpected(mapping.error());
  if (*mapping != row.mapping) {
    found.mapping = true;
    found.shown.push_back(
        {fmt::format("{} {}: mapped objects ({:04X}H)", window.word, number, window.mapping + number - 1),
         shown_mapping(*mapping), shown_mapping(row.mapping)});
  }
  return found;
}

/// Writes one after the other, and reports the result of each.
class Writer {
 public:
  Writer(ModuleAccess& access, std::uint8_t node, const StepListener& listener)
      : access_(access), node_(node), listener_(listener) {}

  Result<void> put(const Target& target, std::uint32_t value, std::string_view what) {
    const std::string text = fmt::format("{}: {} = {}", what, target.name(), shown(target, value));
    if (const auto written = write(access_, node_, target, value); !written) {
      listener_({false, fmt::format("{}: {}", text, written.error())});
      return std::unexpected(fmt::format("{}: {}", text, written.error()));
    }
    listener_({true, text});
    return {};
  }

  /// Invalid, no objects, the objects, their number, and the settings with the COB-ID last [CiA 301 7.5.2.36].
  Result<void> put_pdo(const Window& window, std::uint32_t number, const Row& row) {
    const std::string what = fmt::format("{} {}", window.word, number);
    const Target cob_id = target_of(window.fields[0], number, 0);
    const std::uint32_t mapping = window.mapping + number - 1;
    std::vector<std::pair<Target, std::uint32_t>> steps{{cob_id, row.values[0] | not_valid},
                                                        {{false, mapping, 0, 1}, 0}};
    for (std::size_t i = 0; i < row.mapping.size(); ++i) {
      steps.push_back({{false, mapping, static_cast<std::uint8_t>(i + 1), 4}, row.mapping[i]});
    }
    steps.push_back({{false, mapping, 0, 1}, static_cast<std::uint32_t>(row.mapping.size())});
    for (std::size_t i = 1; i < window.fields.size(); ++i)
      steps.push_back({target_of(window.fields[i], number, 0), row.values[i]});
    if ((row.values[0] & not_valid) == 0) steps.push_back({cob_id, row.values[0]});
    for (const auto& [target, value] : steps) {
      if (const auto done = put(target, value, what); !done) return done;
    }
    return {};
  }

 private:
  ModuleAccess& access_;
  std::uint8_t node_;
  const StepListener& listener_;
};

constexpr std::array parts{"basic", "tpdo", "rpdo", "nmt", "all"};

}  // namespace

bool is_part(std::string_view part) noexcept { return std::ranges::find(parts, part) != parts.end(); }

Result<std::vector<Difference>> differences(const ModuleProject& project, std::string_view part,
                                            PdoRange range, std::uint8_t node, ModuleAccess& access) {
  std::vector<Difference> found;
  for (const Window& window : project.tool().windows) {
    if (!is_in(window, part) || (window.word == "basic" && node != 0)) continue;
    if (window.mapping != 0) {
      for (const auto& [number, row] : project.rows(window)) {
        if (number < range.first || number > range.last) continue;
        const auto pdo = pdo_difference(window, number, row, node, access);
        if (!pdo) return std::unexpected(pdo.error());
        found.insert(found.end(), pdo->shown.begin(), pdo->shown.end());
      }
      continue;
    }
    const auto different = differing(project, window, node, access);
    if (!different) return std::unexpected(different.error());
    for (const auto& [target, value] : *different) {
      found.push_back({fmt::format("{} ({})", value.wanted.fields, target.name()),
                       shown(target, value.device), shown(target, value.wanted.value)});
    }
  }
  return found;
}

Result<void> write_module(const ModuleProject& project, std::string_view part, PdoRange range,
                          std::uint8_t node, ModuleAccess& access, const StepListener& listener) {
  Writer writer(access, node, listener);
  bool words = false, objects = false;
  for (const Window& window : project.tool().windows) {
    if (!is_in(window, part) || (window.word == "basic" && node != 0)) continue;
    if (window.mapping != 0) {
      for (const auto& [number, row] : project.rows(window)) {
        if (number < range.first || number > range.last) continue;
        const auto pdo = pdo_difference(window, number, row, node, access);
        if (!pdo) return std::unexpected(pdo.error());
        if (!pdo->communication && !pdo->mapping) continue;
        if (const auto done = writer.put_pdo(window, number, row); !done) return done;
        objects = true;
      }
      continue;
    }
    const auto different = differing(project, window, node, access);
    if (!different) return std::unexpected(different.error());
    for (const auto& [target, value] : *different) {
      if (const auto done = writer.put(target, value.wanted.value, value.wanted.fields); !done) return done;
      (target.is_word ? words : objects) = true;
    }
  }
  constexpr std::uint32_t save = 0x65766173;
  if (objects) {
    if (const auto done = writer.put({false, 0x1010, 1, 4}, save, "saved in the flash ROM of the node");
        !done)
      return done;
  }
  if (words) {
    const auto saved = access.save_words();
    listener({saved.has_value(), saved ? "saved the module's words in its flash ROM: G22 = 1"
                                       : fmt::format("saving the module's words: {}", saved.error())});
    if (!saved) return saved;
  }
  return {};
}

namespace {

/// A row as it is in the module; `key` may be another one than asked for: entries of 1016H are in no order.
struct ReadRow {
  std::uint32_t key = 0;
  Row row;
  bool is_used = false;
};

ReadRow row_from(const ModuleProject& project, const Window& window, std::uint32_t key,
                 const Values& device) {
  ReadRow read{
      key,
      project.rows(window).contains(key) ? project.rows(window).at(key) : project.factory_row(window, key),
      window.key.empty() || (window.mapping != 0 && key <= 4)};
  for (std::size_t i = 0; i < window.fields.size(); ++i) {
    const Field& field = window.fields[i];
    const auto found = device.find(target_of(field, key, static_cast<std::uint8_t>(key)));
    if (found == device.end()) continue;
    const std::uint32_t value =
        (found->second >> field.place.first_bit & mask_of(field.place)) * field.place.factor;
    if (field.place.kind == Kind::consumer) {
      read.key = found->second >> 16 & 0xFF;
      read.row.values[i] = found->second & 0xFFFF;
      read.is_used = read.key >= 1 && read.key <= window.most_key && read.row.values[i] != 0;
      continue;
    }
    read.row.values[i] = value;
    if (field.place.kind == Kind::node_object && value != 0) read.is_used = true;
    if (field.place.kind == Kind::pdo_object && value != factory_value(window, field, key, project.node_id()))
      read.is_used = true;
  }
  return read;
}

Result<void> read_window(ModuleProject& project, const Window& window, PdoRange range, std::uint8_t node,
                         ModuleAccess& access) {
  const std::uint32_t first = window.key.empty() ? 0 : window.mapping != 0 ? std::max(1U, range.first) : 1;
  const std::uint32_t last = window.mapping != 0 ? std::min(window.most_key, range.last) : window.most_key;
  std::vector<Target> targets;
  for (std::uint32_t key = first; key <= last; ++key) {
    for (const Field& field : window.fields) {
      if (field.place.kind != Kind::none)
        targets.push_back(target_of(field, key, static_cast<std::uint8_t>(key)));
    }
  }
  std::ranges::sort(targets);  // one object can contain several fields
  const auto same_place = std::ranges::unique(targets);
  targets.erase(same_place.begin(), same_place.end());
  const auto device = read(access, node, targets);
  if (!device) return std::unexpected(device.error());
  if (window.word == "consumer") project.restore_defaults(window);
  for (std::uint32_t key = first; key <= last; ++key) {
    ReadRow read = row_from(project, window, key, *device);
    if (!read.is_used) {
      project.remove(window, window.word == "consumer" ? 0 : key);
      continue;
    }
    if (window.mapping != 0) {
      auto mapping = read_mapping(access, node, window.mapping + key - 1);
      if (!mapping) return std::unexpected(mapping.error());
      read.row.mapping = std::move(*mapping);
    }
    project.put(window, read.key, std::move(read.row));
  }
  return {};
}

}  // namespace

Result<void> read_module(ModuleProject& project, std::string_view part, PdoRange range, std::uint8_t node,
                         ModuleAccess& access) {
  ModuleProject read = project;  // nothing changes when something cannot be read
  for (const Window& window : project.tool().windows) {
    if (!is_in(window, part) || (window.word == "basic" && node != 0)) continue;
    if (const auto done = read_window(read, window, range, node, access); !done) return done;
  }
  project = std::move(read);
  return {};
}

}  // namespace canopus::module_settings
