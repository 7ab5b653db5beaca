#include "canopus/master/device_configuration.hpp"

#include <algorithm>
#include <bit>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/hex.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/service/cob_id.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"
#include "canopus/master/dcf_download.hpp"

namespace canopus::master {
namespace {

using Bytes = std::vector<std::uint8_t>;
using State = ComparedValue::State;
using text::ObjectName;

constexpr std::uint16_t configuration_date_index = 0x1020;
constexpr std::uint32_t do_not_read = 0x02;  // of ObjFlags

constexpr bool is_stored_by_command(std::uint16_t index) { return index == 0x1010 || index == 0x1011; }
constexpr bool is_pdo_communication(std::uint16_t index) {
  return (index >= 0x1400 && index <= 0x15FF) || (index >= 0x1800 && index <= 0x19FF);
}
constexpr bool is_pdo_mapping(std::uint16_t index) {
  return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF);
}

/// The unit of a change: a PDO, else one object's sub-index.
std::uint32_t group_of(ObjectName object) {
  if (is_pdo_mapping(object.index)) return static_cast<std::uint32_t>(object.index - 0x200) << 8;
  if (is_pdo_communication(object.index)) return std::uint32_t{object.index} << 8;
  return std::uint32_t{object.index} << 8 | object.sub;
}
bool is_pdo(ObjectName object) { return is_pdo_communication(object.index) || is_pdo_mapping(object.index); }

Bytes default_of(const canopen::DictionaryDescription& dictionary, const std::vector<std::uint8_t>& block,
                 const canopen::Entry& entry) {
  if (canopen::is_variable_length(entry.description->type)) return dictionary.default_slot(entry.offset);
  const auto begin = block.begin() + static_cast<std::ptrdiff_t>(entry.offset);
  return {begin, begin + entry.description->length};
}

/// Calls visit(entry, facts) for each sub-index that can be read back.
template <typename Visit>
void for_each_readable(const eds::DeviceFile& file, Visit visit) {
  for (const canopen::ObjectDescription& object : file.dictionary->objects()) {
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const canopen::Entry entry = file.dictionary->find(object, static_cast<std::uint8_t>(sub));
      const eds::EntryFacts* facts = file.find_facts(object.index, static_cast<std::uint8_t>(sub));
      if (!entry || facts == nullptr || is_stored_by_command(object.index) ||
          (facts->object_flags & do_not_read) != 0)
        continue;
      if (is_readable(entry.description->access) && entry.description->type != canopen::DataType::domain) {
        visit(entry, *facts);
      }
    }
  }
}

std::vector<ComparedValue> values_of(const eds::DeviceFile& file, std::uint8_t node_id, auto wanted) {
  std::vector<std::uint8_t> block(file.dictionary->block_size());
  file.dictionary->load_defaults(block, node_id);
  std::vector<ComparedValue> values;
  for_each_readable(file, [&](const canopen::Entry& entry, const eds::EntryFacts& facts) {
    if (!wanted(entry, facts)) return;
    values.push_back({.object = {entry.index, entry.sub},
                      .type = entry.description->type,
                      .wanted = default_of(*file.dictionary, block, entry)});
  });
  return values;
}

/// Reads one; false: no answer.
bool compare(ComparedValue& value, ObjectAccess& access) {
  auto found = access.read(value.object, value.type);
  if (!found) {
    value.state = found.error().is_refused ? State::refused : State::not_answered;
    value.reason = std::move(found.error().reason);
    return value.state == State::refused;
  }
  value.found = std::move(*found);
  value.state = value.found == value.wanted ? State::same : State::different;
  return true;
}

void compare(std::vector<ComparedValue>& values, ObjectAccess& access, const Progress& progress) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (progress && !progress(i, values.size())) return;
    if (!compare(values[i], access)) return;
  }
}

}  // namespace

std::vector<ComparedValue> compare_identity(const eds::DeviceFile& file, ObjectAccess& access) {
  const eds::Identity identity = eds::identity(file);
  std::vector<ComparedValue> values;
  const auto add = [&](std::uint16_t index, std::uint8_t sub, std::optional<std::uint32_t> wanted) {
    if (wanted.value_or(0) == 0 || !file.dictionary->find(index, sub)) return;
    values.push_back({.object = {index, sub},
                      .type = canopen::DataType::unsigned32,
                      .wanted = can::little_endian(*wanted, 4)});
  };
  add(0x1000, 0, identity.device_type);
  add(0x1018, 1, identity.vendor_id);
  add(0x1018, 2, identity.product_code);
  add(0x1018, 3, identity.revision);
  if (values.empty())
    values.push_back({.object = {0x1000, 0}, .type = canopen::DataType::unsigned32, .wanted = Bytes(4)});
  compare(values, access, {});
  return values;
}

std::vector<ComparedValue> compare_configuration(const eds::DeviceFile& file, std::uint8_t node_id,
                                                 ObjectAccess& access, const Progress& progress) {
  auto values = values_of(file, node_id, [](const canopen::Entry& entry, const eds::EntryFacts& facts) {
    return facts.configured && is_writable(entry.description->access);
  });
  compare(values, access, progress);
  return values;
}

std::vector<ComparedValue> find_changed(const eds::DeviceFile& file, std::uint8_t node_id,
                                        ObjectAccess& access, const Progress& progress) {
  auto values = values_of(file, node_id, [](const canopen::Entry& entry, const eds::EntryFacts& facts) {
    const auto& description = *entry.description;
    const bool is_process_data = description.rpdo_mappable || description.tpdo_mappable;
    return is_writable(description.access) && entry.index != 0x1003 &&
           description.type != canopen::DataType::unicode_string && (facts.configured || !is_process_data);
  });
  compare(values, access, progress);
  std::erase_if(values, [](const ComparedValue& value) { return value.state == State::same; });
  return values;
}

std::vector<WriteStep> plan_writes(const eds::DeviceFile& file, std::uint8_t node_id,
                                   std::span<const ComparedValue> compared) {
  std::set<std::uint32_t> groups;
  for (const ComparedValue& value : compared) {
    if (value.state != State::same) groups.insert(group_of(value.object));
  }
  std::vector<WriteStep> steps;
  const auto concise = concise_dcf_of(file, {}, node_id);
  if (groups.empty() || !concise) return steps;
  manager::ConciseDcfReader reader(*concise);
  while (const auto entry = reader.next()) {
    const ObjectName object{entry->index, entry->sub};
    // A device clears the time of its configuration as soon as any object is written.
    if (entry->index != configuration_date_index && !groups.contains(group_of(object))) continue;
    steps.push_back({.object = object, .value = Bytes(entry->data.begin(), entry->data.end())});
  }
  return steps;
}

void write(std::vector<WriteStep>& steps, ObjectAccess& access, const Progress& progress) {
  std::optional<std::uint32_t> left_off;  // the PDO of which a write was refused
  bool is_complete = true;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    WriteStep& step = steps[i];
    if (progress && !progress(i, steps.size())) return;
    if (left_off == group_of(step.object)) {
      step.reason = "not tried: the PDO stays off, as another part of it was refused";
      continue;
    }
    if (step.object.index == configuration_date_index && !is_complete) {
      step.reason = "not tried: not everything else was written";
      continue;
    }
    auto written = access.write(step.object, step.value);
    if (written) {
      step.state = WriteStep::State::written;
      continue;
    }
    is_complete = false;
    step.reason = std::move(written.error().reason);
    step.state = written.error().is_refused ? WriteStep::State::refused : WriteStep::State::not_answered;
    if (step.state == WriteStep::State::not_answered) return;
    if (is_pdo(step.object)) left_off = group_of(step.object);
  }
}

std::optional<std::string> value_text(ObjectName object, canopen::DataType type,
                                      std::span<const std::uint8_t> value) {
  using canopen::DataType;
  if (type == DataType::visible_string) return std::string(value.begin(), value.end());
  if (type == DataType::octet_string) return ascii::hex_bytes(value);
  if (canopen::is_variable_length(type) || value.size() != canopen::byte_length(type)) return std::nullopt;
  const std::uint64_t number = can::load_value(value);
  if (type == DataType::real32)
    return fmt::format("{}", std::bit_cast<float>(static_cast<std::uint32_t>(number)));
  if (type == DataType::real64) return fmt::format("{}", std::bit_cast<double>(number));
  if (canopen::is_signed(type)) {
    const unsigned unused = 64 - canopen::bit_length(type);
    return fmt::format("{}", static_cast<std::int64_t>(number << unused) >> unused);
  }
  const bool is_pattern = canopen::cob_id_use(object.index, object.sub) != canopen::CobIdUse::none ||
                          (is_pdo_mapping(object.index) && object.sub != 0) || object.index == 0x1016;
  return is_pattern ? fmt::format("0x{:08X}", number) : fmt::format("{}", number);
}

}  // namespace canopus::master
