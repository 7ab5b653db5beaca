#include "canopus/eds/writer.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "canopus/can/little_endian.hpp"

namespace canopus::eds {

namespace {

using canopen::Access;
using canopen::DataType;
using canopen::DictionaryDescription;
using canopen::Entry;
using canopen::ObjectCode;
using canopen::ObjectDescription;

std::string hex(std::uint64_t value, int digits) {
  std::string text;
  for (; value != 0 || digits > 0; value >>= 4, --digits) {
    text.insert(text.begin(), "0123456789ABCDEF"[value & 0xF]);
  }
  return text;
}

std::string_view word(Access access) {
  switch (access) {
    case Access::write_only: return "wo";
    case Access::read_write: return "rw";
    case Access::read_write_input: return "rwr";
    case Access::read_write_output: return "rww";
    case Access::constant: return "const";
    case Access::read_only: break;
  }
  return "ro";
}

// Below it are the data types, which the format has in [DummyUsage] alone.
constexpr std::uint16_t first_object = 0x1000;
bool is_data_type(std::uint16_t index) { return index < first_object; }

class Writer {
 public:
  explicit Writer(const DictionaryDescription& dictionary)
      : dictionary_(dictionary), defaults_(dictionary.block_size()), defaults_of_1_(dictionary.block_size()) {
    dictionary.load_defaults(defaults_, 0);
    dictionary.load_defaults(defaults_of_1_, 1);
  }

  void section(std::string_view name) { line(("[" + std::string(name) + "]")); }
  void key(std::string_view name, std::string_view value) {
    line(std::string(name) + "=" + std::string(value));
  }
  void key(std::string_view name, std::uint64_t value) { key(name, std::to_string(value)); }
  void end() { line(""); }

  enum class Kind : std::uint8_t { mandatory, optional, manufacturer };

  void list(std::string_view name, Kind kind) {
    std::vector<std::uint16_t> indexes;
    for (const ObjectDescription& object : dictionary_.objects()) {
      if (!is_data_type(object.index) && kind_of(object.index) == kind) indexes.push_back(object.index);
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
    if (object.uniform) {
      entry(dictionary_.find(object, 1));
      key("CompactSubObj", object.highest_sub);
      return end();
    }
    unsigned count = 0;
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      count += dictionary_.find(object, static_cast<std::uint8_t>(sub)) ? 1U : 0U;
    }
    key("SubNumber", count);
    end();
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const Entry found = dictionary_.find(object, static_cast<std::uint8_t>(sub));
      if (!found) continue;
      section(hex(object.index, 4) + "sub" + hex(sub, 1));
      key("ParameterName", sub == 0 ? "Highest sub-index supported" : dictionary_.name(found));
      key("ObjectType", "0x7");
      entry(found);
      end();
    }
  }

  std::string take() { return std::move(text_); }

 private:
  static Kind kind_of(std::uint16_t index) {
    if (index == 0x1000 || index == 0x1001 || index == 0x1018) return Kind::mandatory;
    return index >= 0x2000 && index <= 0x5FFF ? Kind::manufacturer : Kind::optional;
  }

  void line(const std::string& text) { (text_ += text) += "\r\n"; }

  void entry(const Entry& entry) {
    key("DataType", "0x" + hex(static_cast<unsigned>(entry.description->type), 4));
    key("AccessType", word(entry.description->access));
    key("DefaultValue", default_of(entry));
    if (entry.description->type != DataType::domain) {
      key("PDOMapping", entry.description->rpdo_mappable || entry.description->tpdo_mappable ? 1U : 0U);
    }
  }

  std::string default_of(const Entry& entry) const {
    const unsigned length = entry.description->length;
    if (length == 0) {
      const std::vector<std::uint8_t>& bytes = dictionary_.default_slot(entry.offset);
      return {bytes.begin(), bytes.end()};
    }
    const std::uint64_t value = number(defaults_, entry), of_1 = number(defaults_of_1_, entry);
    const std::string text =
        value < 10 ? std::to_string(value) : "0x" + hex(value, static_cast<int>(2 * length));
    return value == of_1 ? text : "$NODEID+" + text;
  }

  static std::uint64_t number(const std::vector<std::uint8_t>& block, const Entry& entry) {
    return can::load_value(&block[entry.offset], entry.description->length);
  }

  const DictionaryDescription& dictionary_;
  std::vector<std::uint8_t> defaults_;
  std::vector<std::uint8_t> defaults_of_1_;
  std::string text_;
};

void write_file_info(Writer& writer, const FileInfo& file) {
  writer.section("FileInfo");
  writer.key("FileName", file.file_name);
  writer.key("FileVersion", file.version);
  writer.key("FileRevision", file.revision);
  writer.key("EDSVersion", file.eds_version);
  writer.key("Description", file.description);
  writer.key("CreationTime", file.creation_time);
  writer.key("CreationDate", file.creation_date);
  writer.key("CreatedBy", file.created_by);
  writer.key("ModificationTime", file.modification_time);
  writer.key("ModificationDate", file.modification_date);
  writer.key("ModifiedBy", file.modified_by);
  writer.end();
}

void write_device_info(Writer& writer, const DeviceInfo& device) {
  constexpr std::array bit_rates{10U, 20U, 50U, 125U, 250U, 500U, 800U, 1000U};  // those the format knows
  writer.section("DeviceInfo");
  writer.key("VendorName", device.vendor_name);
  writer.key("VendorNumber", "0x" + hex(device.vendor_number.value_or(0), 8));
  writer.key("ProductName", device.product_name);
  writer.key("ProductNumber", "0x" + hex(device.product_number.value_or(0), 8));
  writer.key("RevisionNumber", "0x" + hex(device.revision_number.value_or(0), 8));
  writer.key("OrderCode", device.order_code);
  for (const unsigned kbps : bit_rates) {
    const bool supported = std::ranges::find(device.bit_rates, kbps * 1000) != device.bit_rates.end();
    writer.key("BaudRate_" + std::to_string(kbps), supported ? 1U : 0U);
  }
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
void write_dummy_usage(Writer& writer, const DictionaryDescription& dictionary) {
  writer.section("DummyUsage");
  for (std::uint16_t type = 1; is_data_type(type); ++type) {
    const bool usable = dictionary.find(type) != nullptr;
    if (usable || type <= 7) writer.key("Dummy" + hex(type, 4), usable ? 1U : 0U);
  }
  writer.end();
}

}  // namespace

std::string write_device_file(const FileInfo& file, const DeviceInfo& device,
                              const DictionaryDescription& dictionary) {
  Writer writer(dictionary);
  write_file_info(writer, file);
  write_device_info(writer, device);
  write_dummy_usage(writer, dictionary);
  writer.list("MandatoryObjects", Writer::Kind::mandatory);
  writer.list("OptionalObjects", Writer::Kind::optional);
  writer.list("ManufacturerObjects", Writer::Kind::manufacturer);
  for (const ObjectDescription& object : dictionary.objects()) {
    if (!is_data_type(object.index)) writer.object(object);
  }
  return writer.take();
}

}  // namespace canopus::eds
