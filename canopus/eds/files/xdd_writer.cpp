#include "canopus/eds/files/xdd_writer.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/eds/problems.hpp"
#include "canopus/eds/value.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/eds/xdd_parameters.hpp"
#include "canopus/eds/xml/document.hpp"

namespace canopus::eds {
namespace {

using canopen::Access;
using canopen::Entry;
using canopen::ObjectDescription;

constexpr std::uint16_t first_index = 0x1000;  // below are data types
constexpr std::string_view unknown_date = "1970-01-01";

std::string_view access_word(Access access) {
  switch (access) {
    case Access::write_only: return "wo";
    case Access::read_write:
    case Access::read_write_input:
    case Access::read_write_output: return "rw";
    case Access::constant: return "const";
    case Access::read_only: break;
  }
  return "ro";
}

std::string_view mapping_word(const canopen::EntryDescription& entry) {
  if (!is_said_to_be_mappable(entry)) return "no";
  if (entry.access == Access::read_write_input) return "TPDO";
  if (entry.access == Access::read_write_output) return "RPDO";
  return "optional";
}

std::optional<unsigned> digits_in(std::string_view text, std::size_t place, std::size_t length) {
  if (text.size() < place + length) return std::nullopt;
  return ascii::parse_number<unsigned>(text.substr(place, length));
}

class XddWriter {
 public:
  explicit XddWriter(const DeviceFile& file) : file_(file), dictionary_(*file.dictionary) {}

  WrittenFile write() {
    text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    open("ISO15745ProfileContainer", {{"xmlns", "http://www.canopen.org/xml/1.0"},
                                      {"xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"},
                                      {"xsi:schemaLocation", "http://www.canopen.org/xml/1.0 CANopen.xsd"}});
    if (xdd_date(file_.file.creation_date).empty()) {
      warn("the file has no date of its creation, which an XDD must have: " + std::string(unknown_date) +
           " is written");
    }
    write_device();
    write_network();
    close("ISO15745ProfileContainer");
    report_losses();
    return {std::move(text_), std::move(warnings_)};
  }

 private:
  struct Attribute {
    std::string_view name;
    std::string value;
  };
  using Attributes = std::vector<Attribute>;

  void warn(std::string text) { warnings_.push_back(std::move(text)); }

  /// The text as XML; characters that XML cannot represent are replaced.
  std::string written(std::string_view text, std::string_view name) {
    if (auto result = xml::escaped(text, '"')) return *std::move(result);
    std::string cleaned = to_utf8(text);
    std::ranges::replace_if(
        cleaned, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
    warn((place_.empty() ? "" : place_ + ": ") + std::string(name) +
         (is_utf8(text) ? " has characters that XML cannot say: ? is written"
                        : " is no UTF-8 text: it is written as such, so its bytes differ"));
    return xml::escaped(cleaned, '"').value_or("");
  }

  void begin(std::string_view name, const Attributes& attributes) {
    text_.append(depth_ * 2, ' ');
    (text_ += '<') += name;
    for (const Attribute& attribute : attributes) {
      ((text_ += ' ') += attribute.name) += "=\"";
      (text_ += written(attribute.value, attribute.name)) += '"';
    }
  }
  void open(std::string_view name, const Attributes& attributes = {}) {
    begin(name, attributes);
    text_ += ">\n";
    ++depth_;
  }
  void close(std::string_view name) {
    --depth_;
    text_.append(depth_ * 2, ' ');
    ((text_ += "</") += name) += ">\n";
  }
  void empty(std::string_view name, const Attributes& attributes) {
    begin(name, attributes);
    text_ += "/>\n";
  }
  void element(std::string_view name, std::string_view content, const Attributes& attributes = {}) {
    begin(name, attributes);
    ((((text_ += '>') += written(content, name)) += "</") += name) += ">\n";
  }

  void open_profile(std::string_view identification, std::string_view class_id, std::string_view type) {
    open("ISO15745Profile");
    open("ProfileHeader");
    element("ProfileIdentification", identification);
    element("ProfileRevision", "1");
    element("ProfileName", file_.device.product_name);
    element("ProfileSource", "");
    element("ProfileClassID", class_id);
    open("ISO15745Reference");
    element("ISO15745Part", "1");
    element("ISO15745Edition", "1");
    element("ProfileTechnology", "CANopen");
    close("ISO15745Reference");
    close("ProfileHeader");
    const FileInfo& info = file_.file;
    const auto or_empty = [](std::string value, std::string_view otherwise) {
      return value.empty() ? std::string(otherwise) : value;
    };
    Attributes attributes = {{"xsi:type", std::string(type)},
                             {"formatName", "CANopen"},
                             {"formatVersion", "1.0"},
                             {"fileName", info.file_name},
                             {"fileCreator", info.created_by},
                             {"fileCreationDate", or_empty(xdd_date(info.creation_date), unknown_date)}};
    const auto add = [&](std::string_view name, std::string value) {
      if (!value.empty()) attributes.push_back({name, std::move(value)});
    };
    add("fileCreationTime", xdd_time(info.creation_time));
    add("fileModifiedBy", info.modified_by);
    add("fileModificationDate", xdd_date(info.modification_date));
    add("fileModificationTime", xdd_time(info.modification_time));
    add("fileVersion",
        std::to_string(info.version) + (info.revision == 0 ? "" : '.' + std::to_string(info.revision)));
    add("supportedLanguages", "en");
    open("ProfileBody", attributes);
  }
  void close_profile() {
    close("ProfileBody");
    close("ISO15745Profile");
  }

  void write_device() {
    const DeviceInfo& device = file_.device;
    const Identity identity = eds::identity(file_);
    const auto number = [](std::optional<std::uint32_t> given, std::optional<std::uint32_t> of_1018) {
      return "0x" + ascii::hex(given ? *given : of_1018.value_or(0), 8);
    };
    open_profile("CANopen device profile", "Device", "ProfileBody_Device_CANopen");
    open("DeviceIdentity");
    element("vendorName", device.vendor_name);
    element("vendorID", number(device.vendor_number, identity.vendor_id));
    element("productName", device.product_name);
    element("productID", number(device.product_number, identity.product_code));
    if (!file_.file.description.empty()) {
      open("productText");
      element("description", file_.file.description, {{"lang", "en"}});
      close("productText");
    }
    if (!device.order_code.empty()) element("orderNumber", device.order_code);
    close("DeviceIdentity");
    const unsigned profile = identity.device_type.value_or(0) & 0xFFFF;
    open("DeviceFunction");
    open("capabilities");
    open("characteristicsList");
    open("characteristic");
    open("characteristicName");
    element("label", "Device profile", {{"lang", "en"}});
    close("characteristicName");
    open("characteristicContent");
    element("label", profile == 0 ? "none" : "CiA " + std::to_string(profile), {{"lang", "en"}});
    close("characteristicContent");
    close("characteristic");
    close("characteristicsList");
    close("capabilities");
    close("DeviceFunction");
    write_descriptions();
    close_profile();
  }

  [[nodiscard]] const std::string& object_description(const ObjectDescription& object) const {
    const EntryFacts* facts = file_.find_facts(object.index, 0);
    static const std::string none;
    return facts == nullptr ? none : facts->object_description.text();
  }
  static std::string parameter_id(std::uint16_t index) { return "UID_" + ascii::hex(index, 4); }
  static std::string parameter_id(const Entry& entry) {
    return parameter_id(entry.index) + '_' + ascii::hex(entry.sub, 2);
  }

  /// A parameter for each object and sub-index with a description, which has no other place.
  void write_descriptions() {
    bool is_open = false;
    const auto parameter = [&](const std::string& id, std::string_view label, std::string_view description,
                               canopen::DataType type) {
      if (description.empty()) return;
      if (!is_open) {
        open("ApplicationProcess");
        open("parameterList");
      }
      is_open = true;
      open("parameter", {{"uniqueID", id}});
      element("label", label, {{"lang", "en"}});
      element("description", description, {{"lang", "en"}});
      empty(simple_type_word(type), {});
      close("parameter");
    };
    for (const ObjectDescription& object : dictionary_.objects()) {
      if (object.index < first_index) continue;
      parameter(parameter_id(object.index), dictionary_.name(object), object_description(object),
                canopen::DataType::unsigned8);
      for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
        const Entry entry = dictionary_.find(object, static_cast<std::uint8_t>(sub));
        const EntryFacts* facts = entry ? file_.find_facts(entry.index, entry.sub) : nullptr;
        if (facts == nullptr) continue;
        parameter(parameter_id(entry), dictionary_.name(entry), facts->description.text(),
                  entry.description->type);
      }
    }
    if (!is_open) return;
    close("parameterList");
    close("ApplicationProcess");
  }

  void write_network() {
    open_profile("CANopen communication network profile", "CommunicationNetwork",
                 "ProfileBody_CommunicationNetwork_CANopen");
    open("ApplicationLayers");
    open("CANopenObjectList");
    for (const ObjectDescription& object : dictionary_.objects()) {
      if (object.index >= first_index) write_object(object);
    }
    close("CANopenObjectList");
    open("dummyUsage");
    for (unsigned type = 1; type < 32; ++type) {
      const bool is_usable = (file_.dummy_usage >> type & 1U) != 0;
      if (!is_usable && type > 7) continue;
      empty("dummy", {{"entry", "Dummy" + ascii::hex(type, 4) + (is_usable ? "=1" : "=0")}});
    }
    close("dummyUsage");
    close("ApplicationLayers");
    open("TransportLayers");
    open("PhysicalLayer");
    open("baudRate");
    for (const std::uint32_t rate : file_.device.bit_rates) {
      empty("supportedBaudRate", {{"value", std::to_string(rate / 1000) + " Kbps"}});
    }
    close("baudRate");
    close("PhysicalLayer");
    close("TransportLayers");
    write_management();
    close_profile();
  }

  void write_management() {
    const DeviceInfo& device = file_.device;
    const auto flag = [](bool value) -> std::string { return value ? "true" : "false"; };
    open("NetworkManagement");
    empty("CANopenGeneralFeatures", {{"groupMessaging", flag(device.group_messaging)},
                                     {"dynamicChannels", std::to_string(device.dynamic_channels)},
                                     {"granularity", std::to_string(device.granularity)},
                                     {"nrOfRxPDO", std::to_string(device.rpdos)},
                                     {"nrOfTxPDO", std::to_string(device.tpdos)},
                                     {"bootUpSlave", flag(device.simple_boot_up_slave)},
                                     {"layerSettingServiceSlave", flag(device.lss)}});
    empty("CANopenMasterFeatures", {{"bootUpMaster", flag(device.simple_boot_up_master)}});
    if (file_.commissioning) {
      const Commissioning& given = *file_.commissioning;
      if (!given.node_id) warn("the file names no node-ID, which an XDC must have: none is written");
      Attributes attributes;
      if (given.node_id) attributes.push_back({"nodeID", std::to_string(*given.node_id)});
      attributes.push_back({"nodeName", given.node_name});
      attributes.push_back(
          {"actualBaudRate", given.bit_rate == 0 ? "" : std::to_string(given.bit_rate / 1000) + " Kbps"});
      attributes.push_back({"networkNumber", std::to_string(given.net_number)});
      attributes.push_back({"networkName", given.network_name});
      attributes.push_back({"CANopenManager", flag(given.canopen_manager)});
      empty("deviceCommissioning", attributes);
    }
    close("NetworkManagement");
  }

  void write_object(const ObjectDescription& object) {
    Attributes attributes = {{"index", ascii::hex(object.index, 4)},
                             {"name", std::string(dictionary_.name(object))},
                             {"objectType", std::to_string(static_cast<unsigned>(object.code))}};
    place_ = object_name(object.index);
    if (object.code == canopen::ObjectCode::variable || object.code == canopen::ObjectCode::domain) {
      add_entry(attributes, dictionary_.find(object, 0));
      empty("CANopenObject", attributes);
      place_.clear();
      return;
    }
    std::vector<Entry> entries;
    for (unsigned sub = 0; sub <= object.highest_sub; ++sub) {
      const Entry entry = dictionary_.find(object, static_cast<std::uint8_t>(sub));
      if (entry) entries.push_back(entry);
    }
    attributes.push_back({"subNumber", std::to_string(entries.size())});
    if (!object_description(object).empty())
      attributes.push_back({"uniqueIDRef", parameter_id(object.index)});
    open("CANopenObject", attributes);
    for (const Entry& entry : entries) {
      place_ = object_text(entry.index, entry.sub);
      attributes = {{"subIndex", ascii::hex(entry.sub, 2)},
                    {"name", std::string(dictionary_.name(entry))},
                    {"objectType", "7"}};
      add_entry(attributes, entry);
      empty("CANopenSubObject", attributes);
    }
    close("CANopenObject");
    place_.clear();
  }

  void add_entry(Attributes& attributes, const Entry& entry) {
    const canopen::EntryDescription& what = *entry.description;
    const EntryFacts* facts = file_.find_facts(entry.index, entry.sub);
    attributes.push_back({"dataType", ascii::hex(static_cast<unsigned>(what.type), 4)});
    const canopen::Limits& limits = dictionary_.limits(entry);
    if (limits.low) attributes.push_back({"lowLimit", limit_text(what.type, *limits.low)});
    if (limits.high) attributes.push_back({"highLimit", limit_text(what.type, *limits.high)});
    attributes.push_back({"accessType", std::string(access_word(what.access))});
    const bool is_one_way =
        what.access == Access::read_write_input || what.access == Access::read_write_output;
    if (is_one_way && mapping_word(what) == "no") {
      warn(place_ + ": " + (what.access == Access::read_write_input ? "rwr" : "rww") +
           " of an object that is in no PDO: rw is written");
    }
    auto value = default_text(dictionary_, entry);
    if (!value) warn(place_ + ": its value is no text of its type: left out");
    const bool is_configured = facts != nullptr && facts->configured;
    const auto add = [&](std::string_view name, std::string text) {
      if (!text.empty()) attributes.push_back({name, std::move(text)});
    };
    add("defaultValue", is_configured ? facts->default_text.text() : value.value_or(""));
    if (is_configured) add("actualValue", value.value_or(""));
    attributes.push_back({"PDOmapping", std::string(mapping_word(what))});
    if (facts == nullptr) return;
    if (facts->object_flags != 0) add("objFlags", ascii::hex(facts->object_flags, 4));
    add("denotation", facts->denotation);
    if (!facts->description.empty()) add("uniqueIDRef", parameter_id(entry));
    if (!facts->upload_file.empty() || !facts->download_file.empty()) {
      warn(place_ + ": the names of its files have no place in an XDD: left out");
    }
  }

  void report_losses() {
    const FileInfo& info = file_.file;
    const std::pair<std::string_view, std::pair<const std::string&, std::string>> dates[] = {
        {"CreationDate", {info.creation_date, xdd_date(info.creation_date)}},
        {"CreationTime", {info.creation_time, xdd_time(info.creation_time)}},
        {"ModificationDate", {info.modification_date, xdd_date(info.modification_date)}},
        {"ModificationTime", {info.modification_time, xdd_time(info.modification_time)}}};
    for (const auto& [key, date] : dates) {
      if (!date.first.empty() && date.second.empty())
        warn(std::string(key) + '=' + printable(date.first) + " is not as CiA 306 has it: left out");
      if (!date.second.empty() && date.first.starts_with("00:"))  // its hours are 01 to 12
        warn(std::string(key) + '=' + printable(date.first) + " is written as " + date.second);
    }
    const auto of_1018 = identity(file_).revision;
    const auto revision = file_.device.revision_number;
    if (revision && *revision != of_1018.value_or(0)) {
      warn("RevisionNumber=0x" + ascii::hex(*revision, 8) +
           " has no place in an XDD: 1018:03 has the revision");
    }
    if (file_.device.compact_pdo != 0) {
      warn("CompactPDO=" + std::to_string(file_.device.compact_pdo) +
           " has no place in an XDD: its PDOs are written");
    }
    if (!file_.comments.empty()) warn("the comments have no place in an XDD: left out");
    if (!file_.file.last_eds.empty()) warn("LastEDS has no place in an XDC: left out");
    if (file_.commissioning && file_.commissioning->lss_serial_number != 0) {
      warn("LSS_SerialNumber has no place in an XDC: left out");
    }
    if (!file_.modules.empty()) warn(std::string(modules_are_lost));
  }

  const DeviceFile& file_;
  const canopen::DictionaryDescription& dictionary_;
  std::string text_;
  std::size_t depth_ = 0;
  std::string place_;  // the sub-index that is being written
  std::vector<std::string> warnings_;
};

}  // namespace

WrittenFile write_xdd(const DeviceFile& file) { return XddWriter(file).write(); }

std::string xdd_date(std::string_view date) {
  const auto month = digits_in(date, 0, 2);
  const auto day = digits_in(date, 3, 2);
  const auto year = digits_in(date, 6, 4);
  if (date.size() != 10 || date[2] != '-' || date[5] != '-' || !month || !day || !year) return {};
  if (*month < 1 || *month > 12 || *day < 1 || *day > 31) return {};
  return std::string(date.substr(6)) + '-' + std::string(date.substr(0, 5));
}

std::string xdd_time(std::string_view given) {
  std::string time(given);
  std::erase(time, ' ');
  if (time.size() > 1 && time[1] == ':') time.insert(0, 1, '0');
  const auto hour = digits_in(time, 0, 2);
  const auto minute = digits_in(time, 3, 2);
  const std::string half = ascii::lower(std::string_view(time).substr(std::min<std::size_t>(5, time.size())));
  if (!hour || !minute || time[2] != ':' || *hour > 12 || *minute > 59 || (half != "am" && half != "pm"))
    return {};
  const unsigned shown = *hour % 12 + (half == "pm" ? 12 : 0);
  return (shown < 10 ? "0" : "") + std::to_string(shown) + ':' + time.substr(3, 2) + ":00";
}

}  // namespace canopus::eds
