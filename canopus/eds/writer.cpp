#include "canopus/eds/writer.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "canopus/ascii/hex.hpp"
#include "canopus/can/controller.hpp"
#include "canopus/can/little_endian.hpp"
#include "canopus/eds/problems.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"

namespace canopus::eds {

namespace {

using canopen::Access;
using canopen::DataType;
using canopen::DictionaryDescription;
using canopen::Entry;
using canopen::ObjectCode;
using canopen::ObjectDescription;

using ascii::hex;

// Below it are the data types, which the format has in [DummyUsage] alone.
constexpr std::uint16_t first_object = 0x1000;
bool is_data_type_index(std::uint16_t index) { return index < first_object; }

class Writer {
 public:
  /// `device`: the file the dictionary is of, or nullptr for one that is described in code.
  explicit Writer(const DictionaryDescription& dictionary, const DeviceFile* device = nullptr)
      : dictionary_(dictionary), device_(device) {}

  void section(std::string_view name) { line(("[" + std::string(name) + "]")); }
  void key(std::string_view name, std::string_view value) {
    line(std::string(name) + "=" + readable(name, value));
  }
  void key(std::string_view name, std::uint64_t value) { key(name, std::to_string(value)); }
  void end() { line(""); }

  enum class Kind : std::uint8_t { mandatory, optional, manufacturer };

  void list(std::string_view name, Kind kind) {
    std::vector<std::uint16_t> indexes;
    for (const ObjectDescription& object : dictionary_.objects()) {
      if (!is_data_type_index(object.index) && kind_of(object.index) == kind) indexes.push_back(object.index);
    }
    section(name);
    key("SupportedObjects", indexes.size());
    for (std::size_t i = 0; i < indexes.size(); ++i) key(std::to_string(i + 1), "0x" + hex(indexes[i], 4));
    end();
  }

  void object(const ObjectDescription& object) {
    section(hex(object.index, 4));
    key("ParameterName", dictionary_.name(object));
    if (object.code == ObjectCode::variable || object.code == ObjectCode::domain) {
      key("ObjectType", "0x" + hex(static_cast<unsigned>(object.code), 1));
      entry(dictionary_.find(object, 0));
      return end();
    }
    key("ObjectType", "0x" + hex(static_cast<unsigned>(object.code), 1));
    if (object.uniform && device_ == nullptr) {
      entry(dictionary_.find(object, 1));
      key("CompactSubObj", object.highest_sub);
      return end();
    }
    unsigned count = 0;
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      count += dictionary_.find(object, static_cast<std::uint8_t>(sub)) ? 1U : 0U;
    }
    key("SubNumber", count);
    const EntryFacts* facts = device_ == nullptr ? nullptr : device_->find_facts(object.index, 0);
    if (facts != nullptr && !facts->object_description.empty())
      key("Description", facts->object_description.text());
    end();
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const Entry found = dictionary_.find(object, static_cast<std::uint8_t>(sub));
      if (!found) continue;
      section(hex(object.index, 4) + "sub" + hex(sub, 1));
      const bool has_name = device_ != nullptr || sub != 0;
      key("ParameterName", has_name ? dictionary_.name(found) : "Highest sub-index supported");
      key("ObjectType", "0x7");
      entry(found);
      end();
    }
  }

  std::string release() { return std::move(text_); }
  std::vector<std::string> release_warnings() { return std::move(warnings_); }

 private:
  static Kind kind_of(std::uint16_t index) {
    if (index == 0x1000 || index == 0x1001 || index == 0x1018) return Kind::mandatory;
    return index >= 0x2000 && index <= 0x5FFF ? Kind::manufacturer : Kind::optional;
  }

  void line(const std::string& text) { (text_ += text) += "\r\n"; }

  void entry(const Entry& entry) {
    const EntryFacts* facts = device_ == nullptr ? nullptr : device_->find_facts(entry.index, entry.sub);
    place_ = object_text(entry.index, entry.sub);
    key("DataType", "0x" + hex(static_cast<unsigned>(entry.description->type), 4));
    key("AccessType", name(entry.description->access));
    const canopen::Limits& limits = dictionary_.limits(entry);
    if (limits.low) key("LowLimit", limit_text(entry.description->type, *limits.low));
    if (limits.high) key("HighLimit", limit_text(entry.description->type, *limits.high));
    const auto value = default_text(dictionary_, entry);
    if (!value) warnings_.push_back(place_ + ": its value is no text of its type: left out");
    const bool is_configured = facts != nullptr && facts->configured;
    key("DefaultValue", is_configured ? facts->default_text.text() : value.value_or(""));
    if (is_configured) key("ParameterValue", value.value_or(""));
    if (entry.description->type != DataType::domain) {
      const bool is_mappable = entry.description->rpdo_mappable || entry.description->tpdo_mappable;
      key("PDOMapping",
          (device_ == nullptr ? is_mappable : is_said_to_be_mappable(*entry.description)) ? 1U : 0U);
    }
    if (facts != nullptr) write_facts(*facts);
    place_.clear();
  }

  void write_facts(const EntryFacts& facts) {
    if (facts.object_flags != 0) key("ObjFlags", "0x" + hex(facts.object_flags, 1));
    const std::pair<std::string_view, const std::string&> texts[] = {{"Denotation", facts.denotation},
                                                                     {"Description", facts.description},
                                                                     {"UploadFile", facts.upload_file},
                                                                     {"DownloadFile", facts.download_file}};
    for (const auto& [name, text] : texts) {
      if (!text.empty()) key(name, text);
    }
  }

  /// A line end or an end of file in a value would end it.
  std::string readable(std::string_view name, std::string_view value) {
    std::string text(value);
    if (value.find_first_of(std::string_view("\0\x1A\r\n", 4)) == std::string_view::npos) return text;
    std::ranges::replace_if(
        text, [](char c) { return c == '\0' || c == '\x1A' || c == '\r' || c == '\n'; }, ' ');
    warnings_.push_back((place_.empty() ? "" : place_ + ": ") + std::string(name) +
                        " has a line end or the like in it: a blank is written");
    return text;
  }

  const DictionaryDescription& dictionary_;
  const DeviceFile* device_;
  std::string text_;
  std::string place_;  // the sub-index that is being written
  std::vector<std::string> warnings_;
};

void write_file_info(Writer& writer, const FileInfo& file) {
  writer.section("FileInfo");
  writer.key("FileName", file.file_name);
  writer.key("FileVersion", file.version);
  writer.key("FileRevision", file.revision);
  writer.key("EDSVersion", file.eds_version.empty() ? "4.0" : file.eds_version);
  writer.key("Description", file.description);
  writer.key("CreationTime", file.creation_time);
  writer.key("CreationDate", file.creation_date);
  writer.key("CreatedBy", file.created_by);
  writer.key("ModificationTime", file.modification_time);
  writer.key("ModificationDate", file.modification_date);
  writer.key("ModifiedBy", file.modified_by);
  if (!file.last_eds.empty()) writer.key("LastEDS", file.last_eds);
  writer.end();
}

void write_device_info(Writer& writer, const DeviceInfo& device) {
  constexpr std::uint32_t not_of_the_format = 100'000;  // but devices have it
  writer.section("DeviceInfo");
  writer.key("VendorName", device.vendor_name);
  writer.key("VendorNumber", "0x" + hex(device.vendor_number.value_or(0), 8));
  writer.key("ProductName", device.product_name);
  writer.key("ProductNumber", "0x" + hex(device.product_number.value_or(0), 8));
  writer.key("RevisionNumber", "0x" + hex(device.revision_number.value_or(0), 8));
  writer.key("OrderCode", device.order_code);
  const auto is_supported = [&](std::uint32_t rate) {
    return std::ranges::find(device.bit_rates, rate) != device.bit_rates.end();
  };
  for (const std::uint32_t rate : can::bit_rates) {
    if (rate != not_of_the_format)
      writer.key("BaudRate_" + std::to_string(rate / 1000), is_supported(rate) ? 1U : 0U);
  }
  if (is_supported(not_of_the_format)) writer.key("BaudRate_100", 1U);
  writer.key("SimpleBootUpMaster", device.simple_boot_up_master ? 1U : 0U);
  writer.key("SimpleBootUpSlave", device.simple_boot_up_slave ? 1U : 0U);
  writer.key("Granularity", device.granularity);
  writer.key("DynamicChannelsSupported", device.dynamic_channels);
  writer.key("CompactPDO", device.compact_pdo);
  writer.key("GroupMessaging", device.group_messaging ? 1U : 0U);
  writer.key("NrOfRXPDO", device.rpdos);
  writer.key("NrOfTXPDO", device.tpdos);
  writer.key("LSS_Supported", device.lss ? 1U : 0U);
  writer.end();
}

// The data types that may stand for bytes an RPDO skips; the format always names the first seven.
void write_dummy_usage(Writer& writer, auto&& is_usable) {
  writer.section("DummyUsage");
  for (std::uint16_t type = 1; is_data_type_index(type); ++type) {
    const bool usable = is_usable(type);
    if (usable || type <= 7) writer.key("Dummy" + hex(type, 4), usable ? 1U : 0U);
  }
  writer.end();
}

void write_commissioning(Writer& writer, const Commissioning& commissioning) {
  writer.section("DeviceComissioning");  // [CiA 306] spells it so
  if (commissioning.node_id) writer.key("NodeID", *commissioning.node_id);
  writer.key("NodeName", commissioning.node_name);
  if (commissioning.bit_rate != 0) writer.key("Baudrate", commissioning.bit_rate / 1000);
  writer.key("NetNumber", commissioning.net_number);
  writer.key("NetworkName", commissioning.network_name);
  writer.key("CANopenManager", commissioning.canopen_manager ? 1U : 0U);
  writer.key("LSS_SerialNumber", "0x" + hex(commissioning.lss_serial_number, 8));
  writer.end();
}

void write_objects(Writer& writer, const DictionaryDescription& dictionary) {
  writer.list("MandatoryObjects", Writer::Kind::mandatory);
  writer.list("OptionalObjects", Writer::Kind::optional);
  writer.list("ManufacturerObjects", Writer::Kind::manufacturer);
  for (const ObjectDescription& object : dictionary.objects()) {
    if (!is_data_type_index(object.index)) writer.object(object);
  }
}

}  // namespace

std::string write_device_file(const FileInfo& file, const DeviceInfo& device,
                              const DictionaryDescription& dictionary) {
  Writer writer(dictionary);
  write_file_info(writer, file);
  write_device_info(writer, device);
  write_dummy_usage(writer, [&](std::uint16_t type) { return dictionary.find(type) != nullptr; });
  write_objects(writer, dictionary);
  return writer.release();
}

std::string too_much_to_write(const DeviceFile& file) {
  std::size_t count = 0;
  for (const ObjectDescription& object : file.dictionary->objects())
    count += object.highest_sub + std::size_t{1};
  if (count <= most_written_sub_indexes) return {};
  return "the file describes " + std::to_string(count) +
         " sub-indexes, and what is written describes each; expected at most " +
         std::to_string(most_written_sub_indexes);
}

WrittenFile write_eds(const DeviceFile& file) {
  Writer writer(*file.dictionary, &file);
  write_file_info(writer, file.file);
  DeviceInfo device = file.device;
  const Identity identity = eds::identity(file);
  if (!device.vendor_number) device.vendor_number = identity.vendor_id;
  if (!device.product_number) device.product_number = identity.product_code;
  if (!device.revision_number) device.revision_number = identity.revision;
  write_device_info(writer, device);
  write_dummy_usage(writer,
                    [&](std::uint16_t type) { return type < 32 && (file.dummy_usage >> type & 1U) != 0; });
  if (!file.comments.empty()) {
    writer.section("Comments");
    writer.key("Lines", file.comments.size());
    for (std::size_t i = 0; i < file.comments.size(); ++i)
      writer.key("Line" + std::to_string(i + 1), file.comments[i]);
    writer.end();
  }
  if (file.commissioning) write_commissioning(writer, *file.commissioning);
  write_objects(writer, *file.dictionary);
  WrittenFile written{writer.release(), writer.release_warnings()};
  if (!file.modules.empty()) written.warnings.emplace_back(modules_are_lost);
  return written;
}

std::optional<std::string> default_text(const DictionaryDescription& dictionary, const Entry& entry) {
  const unsigned length = entry.description->length;
  if (length == 0) return value_text(entry.description->type, dictionary.default_slot(entry.offset), false);
  const std::uint64_t value = dictionary.default_value(entry, 0);
  const bool adds_node_id = dictionary.default_value(entry, 1) != value;
  return value_text(entry.description->type, canopen::little_endian(value, length), adds_node_id);
}

bool is_said_to_be_mappable(const canopen::EntryDescription& entry) noexcept {
  switch (entry.access) {
    case Access::read_only:
    case Access::constant:
    case Access::read_write_input: return entry.tpdo_mappable && !entry.rpdo_mappable;
    case Access::write_only:
    case Access::read_write_output: return entry.rpdo_mappable && !entry.tpdo_mappable;
    case Access::read_write: break;
  }
  return entry.rpdo_mappable && entry.tpdo_mappable;
}

}  // namespace canopus::eds
