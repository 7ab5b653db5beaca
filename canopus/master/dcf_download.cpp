#include "canopus/master/dcf_download.hpp"

#include <map>

#include <fmt/format.h>

#include "canopus/canopen/dictionary/object_text.hpp"
#include "canopus/manager/boot/concise_dcf.hpp"

namespace canopus::master {
namespace {

using canopen::DictionaryDescription;
using canopen::Entry;
using Bytes = std::vector<std::uint8_t>;
/// Values to write by index and sub-index.
using Values = std::map<std::uint16_t, std::map<std::uint8_t, Bytes>>;

constexpr std::uint16_t verify_configuration = 0x1020;
constexpr std::uint32_t not_valid = 0x8000'0000;  // bit 31 of a PDO's COB-ID

/// Offset from a PDO's communication to its mapping record; 0 when `index` is not a communication record.
constexpr std::uint16_t mapping_of(std::uint16_t index) {
  const bool is_pdo = (index >= 0x1400 && index <= 0x15FF) || (index >= 0x1800 && index <= 0x19FF);
  return is_pdo ? static_cast<std::uint16_t>(index + 0x200) : std::uint16_t{0};
}
constexpr bool is_mapping(std::uint16_t index) {
  return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF);
}
constexpr bool is_command(std::uint16_t index) { return index == 0x1010 || index == 0x1011; }

class Download {
 public:
  Download(const DictionaryDescription& dictionary, std::uint8_t node_id)
      : dictionary_(dictionary), block_(dictionary.block_size()) {
    dictionary.load_defaults(block_, node_id);
  }

  void add_configured(const eds::DeviceFile& file) {
    constexpr std::uint32_t no_download = 0x01;
    for (const eds::EntryFacts& facts : file.facts) {
      if (!facts.configured || (facts.object_flags & no_download) != 0 || is_command(facts.index)) continue;
      const auto* object = dictionary_.find(facts.index);
      if (object == nullptr) continue;
      const bool for_all = object->uniform && facts.sub == 1;
      const unsigned last = for_all ? object->highest_sub : facts.sub;
      for (unsigned sub = facts.sub; sub <= last; ++sub) {
        const Entry entry = dictionary_.find(*object, static_cast<std::uint8_t>(sub));
        if (entry && is_writable(entry.description->access))
          values_[entry.index][entry.sub] = value_of(entry);
      }
    }
  }
  std::vector<text::FileError> add(std::span<const text::ObjectSetting> settings) {
    std::vector<text::FileError> errors;
    for (const text::ObjectSetting& setting : settings) {
      const auto [index, sub] = setting.object;
      const std::string name = canopen::object_text(index, sub);
      const Entry entry = dictionary_.find(index, sub);
      if (!entry) {
        errors.push_back({setting.place, fmt::format("{}: the device file has no such object", name)});
      } else if (!is_writable(entry.description->access)) {
        errors.push_back({setting.place, fmt::format("{}: the device file says it cannot be written", name)});
      } else if (auto value = text::encode(setting.value, entry.description->type); !value) {
        errors.push_back({setting.place, fmt::format("{}: {}", name, value.error())});
      } else {
        values_[index][sub] = std::move(*value);
      }
    }
    return errors;
  }

  Bytes write() {
    // A PDO of which only the mapping is configured has its communication record touched as well.
    std::vector<std::uint16_t> records;
    for (const auto& [index, subs] : values_) {
      if (is_mapping(index)) records.push_back(static_cast<std::uint16_t>(index - 0x200));
    }
    for (const std::uint16_t index : records) {
      if (dictionary_.find(index) != nullptr) values_.try_emplace(index);
    }
    if (values_.empty()) return {};
    for (const auto& [index, subs] : values_) {
      if (mapping_of(index) != 0) {
        write_pdo(index, subs);
      } else if (!is_mapping(index) || !values_.contains(static_cast<std::uint16_t>(index - 0x200))) {
        if (index == verify_configuration) continue;
        for (const auto& [sub, value] : subs) file_.add(index, sub, value);
      }
    }
    // Any other change of its configuration makes the device clear it [CiA 301 1020H].
    if (const auto found = values_.find(verify_configuration); found != values_.end()) {
      for (const auto& [sub, value] : found->second) file_.add(verify_configuration, sub, value);
    }
    return file_.file();
  }

 private:
  [[nodiscard]] Bytes value_of(const Entry& entry) const {
    if (canopen::is_variable_length(entry.description->type)) return dictionary_.default_slot(entry.offset);
    const auto begin = block_.begin() + static_cast<std::ptrdiff_t>(entry.offset);
    return {begin, begin + entry.description->length};
  }

  void write_pdo(std::uint16_t index, const std::map<std::uint8_t, Bytes>& communication) {
    const Entry cob_id = dictionary_.find(index, 1);
    const bool switchable =
        cob_id && is_writable(cob_id.description->access) && cob_id.description->length == 4;
    const auto configured = communication.find(1);
    const Bytes own = !switchable                         ? Bytes{}
                      : configured != communication.end() ? configured->second
                                                          : value_of(cob_id);
    if (switchable) {
      Bytes off = own;
      off[3] = static_cast<std::uint8_t>(off[3] | not_valid >> 24);
      file_.add(index, 1, off);
    }
    for (const auto& [sub, value] : communication) {
      if (sub != 1 || !switchable) file_.add(index, sub, value);
    }
    const std::uint16_t mapping = mapping_of(index);
    if (const auto found = values_.find(mapping); found != values_.end())
      write_mapping(mapping, found->second);
    if (switchable) file_.add(index, 1, own);
  }

  void write_mapping(std::uint16_t index, const std::map<std::uint8_t, Bytes>& subs) {
    const Entry count = dictionary_.find(index, 0);
    const bool can_be_emptied = count && is_writable(count.description->access);
    if (can_be_emptied) file_.add(index, 0, 0, 1);
    for (const auto& [sub, value] : subs) {
      if (sub != 0) file_.add(index, sub, value);
    }
    if (!can_be_emptied) return;
    const auto configured = subs.find(0);
    file_.add(index, 0, configured != subs.end() ? configured->second : value_of(count));
  }

  const DictionaryDescription& dictionary_;
  std::vector<std::uint8_t> block_;
  Values values_;
  manager::ConciseDcfWriter file_;
};

}  // namespace

std::expected<std::vector<std::uint8_t>, std::vector<text::FileError>> concise_dcf_of(
    const eds::DeviceFile& file, std::span<const text::ObjectSetting> settings, std::uint8_t node_id) {
  Download download(*file.dictionary, node_id);
  download.add_configured(file);
  auto errors = download.add(settings);
  if (!errors.empty()) return std::unexpected(std::move(errors));
  return download.write();
}

}  // namespace canopus::master
