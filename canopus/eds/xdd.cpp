#include "canopus/eds/xdd.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/eds/xdd_parameters.hpp"
#include "canopus/eds/xml/profiles.hpp"

namespace canopus::eds {
namespace {

using Severity = Problem::Severity;
using xml::attribute;
using xml::child;
using xml::local_name;

constexpr std::size_t most_items = 64;  // of a section whose keys the file chooses
constexpr std::string_view mark = "\xEF\xBB\xBF";

/// 2025-12-31, with a time zone or without, as CiA 306 writes it: 12-31-2025. Empty: no such date.
std::string date_of(std::string_view text) {
  if (text.size() < 10 || text[4] != '-' || text[7] != '-') return {};
  return std::string(text.substr(5, 5)) + '-' + std::string(text.substr(0, 4));
}

/// 16:49:28.79+01:00 as 04:49PM. Empty: no such time.
std::string time_of(std::string_view text) {
  if (text.size() < 5 || text[2] != ':') return {};
  const auto hour = ascii::parse_number<unsigned>(text.substr(0, 2));
  if (!hour || *hour > 23) return {};
  const unsigned shown = *hour % 12 == 0 ? 12 : *hour % 12;
  return std::string(shown < 10 ? "0" : "") + std::to_string(shown) + ':' + std::string(text.substr(3, 2)) +
         (*hour < 12 ? "AM" : "PM");
}

std::string number_of_word(std::string_view word) {
  return word == "true" ? "1" : word == "false" ? "0" : std::string(word);
}

/// "250 Kbps" as 250.
std::string kilobits(std::string_view text) {
  return std::string(text.substr(0, text.find_first_not_of("0123456789")));
}

class XddReader {
 public:
  XddReader(const xml::Document& document, pugi::xml_node device, Problems& problems)
      : document_(document),
        device_(device),
        parameters_(document, child(device, "ApplicationProcess"), problems),
        problems_(problems) {}

  std::vector<Section> read(pugi::xml_node network) {
    read_file_info(device_ ? device_ : network);
    read_device_info(network);
    const pugi::xml_node layers = child(network, "ApplicationLayers");
    read_commissioning(child(child(network, "NetworkManagement"), "deviceCommissioning"));
    read_dummy_usage(child(layers, "dummyUsage"));
    for (const auto& [name, what] :
         {std::pair{"dynamicChannels", "the dynamic channels of a programmable device"},
          std::pair{"moduleManagement", "the modules of a modular device"}}) {
      const pugi::xml_node unread = child(layers, name);
      if (unread.first_child())
        problems_.loss(document_.position(unread).line, std::string(name) + ": " + what + " are left out");
    }
    for (const pugi::xml_node object : child(layers, "CANopenObjectList")) {
      if (local_name(object.name()) == "CANopenObject") read_object(object);
    }
    return std::move(sections_);
  }

 private:
  Section& add_section(std::string folded, std::string name, pugi::xml_node element) {
    Section section;
    section.folded_name = std::move(folded);
    section.name = std::move(name);
    section.line = element ? document_.position(element).line : 1;
    sections_.push_back(std::move(section));
    return sections_.back();
  }

  void add(Section& section, std::string_view key, pugi::xml_attribute given, std::string_view value) const {
    add_item(section, document_, key, given, value);
  }
  void add(Section& section, std::string_view key, pugi::xml_attribute given) const {
    add(section, key, given, given.value());
  }
  void add(Section& section, std::string_view key, pugi::xml_node given) const {
    add_item(section, document_, key, given);
  }

  void read_file_info(pugi::xml_node body) {
    Section& info = add_section("fileinfo", "ProfileBody", body);
    add(info, "filename", attribute(body, "fileName"));
    const auto version = attribute(body, "fileVersion");
    const std::string_view number = version.value();
    const std::size_t point = number.find('.');
    add(info, "fileversion", version, std::string(number.substr(0, point)));
    if (point != std::string_view::npos)
      add(info, "filerevision", version, std::string(number.substr(point + 1)));
    add(info, "createdby", attribute(body, "fileCreator"));
    add(info, "modifiedby", attribute(body, "fileModifiedBy"));
    for (const auto& [key, name] :
         {std::pair{"creationdate", "fileCreationDate"}, {"modificationdate", "fileModificationDate"}}) {
      add(info, key, attribute(body, name), date_of(attribute(body, name).value()));
    }
    for (const auto& [key, name] :
         {std::pair{"creationtime", "fileCreationTime"}, {"modificationtime", "fileModificationTime"}}) {
      add(info, key, attribute(body, name), time_of(attribute(body, name).value()));
    }
    add(info, "description",
        xml::english_child(child(child(device_, "DeviceIdentity"), "productText"), "description"));
  }

  void read_device_info(pugi::xml_node network) {
    const pugi::xml_node identity = child(device_, "DeviceIdentity");
    Section& info = add_section("deviceinfo", "DeviceIdentity", identity ? identity : network);
    add(info, "vendorname", child(identity, "vendorName"));
    add(info, "vendornumber", child(identity, "vendorID"));
    add(info, "productname", child(identity, "productName"));
    add(info, "productnumber", child(identity, "productID"));
    add(info, "ordercode", child(identity, "orderNumber"));
    const pugi::xml_node rates = child(child(child(network, "TransportLayers"), "PhysicalLayer"), "baudRate");
    for (const pugi::xml_node rate : rates) {
      const auto value = attribute(rate, "value");
      if (local_name(rate.name()) != "supportedBaudRate" || info.items.size() == most_items) continue;
      add(info, "baudrate" + kilobits(value.value()), value, "1");
    }
    const pugi::xml_node management = child(network, "NetworkManagement");
    const pugi::xml_node general = child(management, "CANopenGeneralFeatures");
    add(info, "granularity", attribute(general, "granularity"));
    add(info, "nrofrxpdo", attribute(general, "nrOfRxPDO"));
    add(info, "nroftxpdo", attribute(general, "nrOfTxPDO"));
    add(info, "dynamicchannelssupported", attribute(general, "dynamicChannels"));
    const auto flag = [&](std::string_view key, pugi::xml_attribute given) {
      add(info, key, given, number_of_word(given.value()));
    };
    flag("simplebootupslave", attribute(general, "bootUpSlave"));
    flag("groupmessaging", attribute(general, "groupMessaging"));
    flag("lsssupported", attribute(general, "layerSettingServiceSlave"));
    flag("simplebootupmaster", attribute(child(management, "CANopenMasterFeatures"), "bootUpMaster"));
  }

  void read_commissioning(pugi::xml_node given) {
    if (!given) return;
    Section& section = add_section("devicecomissioning", "deviceCommissioning", given);
    add(section, "nodeid", attribute(given, "nodeID"));
    add(section, "nodename", attribute(given, "nodeName"));
    const auto rate = attribute(given, "actualBaudRate");
    add(section, "baudrate", rate, kilobits(rate.value()));
    add(section, "netnumber", attribute(given, "networkNumber"));
    add(section, "networkname", attribute(given, "networkName"));
    const auto manager = attribute(given, "CANopenManager");
    add(section, "canopenmanager", manager, number_of_word(manager.value()));
  }

  void read_dummy_usage(pugi::xml_node usage) {
    if (!usage) return;
    Section& section = add_section("dummyusage", "dummyUsage", usage);
    for (const pugi::xml_node dummy : usage) {  // <dummy entry="Dummy0005=1"/>
      const auto entry = attribute(dummy, "entry");
      const std::string_view text = entry.value();
      const std::size_t equals = text.find('=');
      if (equals == std::string_view::npos || section.items.size() == most_items) continue;
      const std::string key(trim(text.substr(0, equals)));
      add(section, folded(key), entry, text.substr(equals + 1));
      section.items.back().key = printable(key);
    }
  }

  void read_object(pugi::xml_node object) {
    const auto given = attribute(object, "index");
    const auto index = read_hexadecimal(given.value(), 0xFFFF);
    if (!index) {
      problems_.loss(document_.position(object).line,
                     "CANopenObject with index=\"" + printable(given.value()) +
                         "\": an index is four hexadecimal digits: left out");
      return;
    }
    const std::string folded_index = ascii::lower_hex(*index, 4);
    const std::string shown = object_name(static_cast<std::uint16_t>(*index));
    if (const auto [place, is_new] = lines_.try_emplace(folded_index, document_.position(object).line);
        !is_new) {
      problems_.repeated(
          Severity::loss, "object again", document_.position(object).line,
          shown + " was described in line " + std::to_string(place->second) + " before: left out");
      return;
    }
    const bool has_subs = static_cast<bool>(child(object, "CANopenSubObject"));
    read_entry(add_section(folded_index, "CANopenObject " + shown, object), object, !has_subs);
    for (const pugi::xml_node member : object) {
      if (local_name(member.name()) != "CANopenSubObject") continue;
      const auto given_sub = attribute(member, "subIndex");
      const unsigned line = document_.position(member).line;
      const auto sub = read_hexadecimal(given_sub.value(), 0xFF);
      if (!sub) {
        problems_.loss(line, "CANopenSubObject of " + shown + " with subIndex=\"" +
                                 printable(given_sub.value()) +
                                 "\": a sub-index is hexadecimal, 00 to FF: left out");
        continue;
      }
      std::string name = folded_index + "sub" + ascii::lower_hex(*sub);
      const std::string shown_sub =
          object_text(static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*sub));
      if (const auto [place, is_new] = lines_.try_emplace(name, line); !is_new) {
        problems_.repeated(
            Severity::loss, "sub-index again", line,
            shown_sub + " was described in line " + std::to_string(place->second) + " before: left out");
        continue;
      }
      read_entry(add_section(std::move(name), "CANopenSubObject " + shown_sub, member), member, true);
    }
  }

  void read_entry(Section& section, pugi::xml_node object, bool has_value) {
    add(section, "parametername", attribute(object, "name"));
    add(section, "objecttype", attribute(object, "objectType"));
    add(section, "subnumber", attribute(object, "subNumber"));
    add(section, "denotation", attribute(object, "denotation"));
    add(section, "defaultvalue", attribute(object, "defaultValue"));
    add(section, "parametervalue", attribute(object, "actualValue"));
    add(section, "lowlimit", attribute(object, "lowLimit"));
    add(section, "highlimit", attribute(object, "highLimit"));
    for (const auto& [key, name] : {std::pair{"datatype", "dataType"}, std::pair{"objflags", "objFlags"}}) {
      const auto given = attribute(object, name);
      add(section, key, given,
          ascii::is_hex(given.value()) ? "0x" + std::string(given.value()) : given.value());
    }
    add(section, "accesstype", attribute(object, "accessType"));
    if (const auto reference = attribute(object, "uniqueIDRef")) {
      if (const Section* parameter = parameters_.find(reference.value())) {
        const Item* code = section.find("objecttype");
        const bool is_domain = code != nullptr && code->value == "2";  // IEC 61131-3 has no such type
        for (const Item& item : parameter->items) {
          const bool is_wanted = item.folded_key == "datatype"
                                     ? has_value && !is_domain
                                     : item.folded_key == "parametername" ||
                                           item.folded_key == "denotation" ||
                                           item.folded_key == "description" || has_value;
          if (is_wanted && section.find(item.folded_key) == nullptr) section.items.push_back(item);
        }
      } else {
        const xml::Position place = document_.position(reference);
        problems_.repeated(Severity::loss, "no parameter", place.line,
                           "uniqueIDRef=" + printable(reference.value()) + " in [" + section.name +
                               "]: there is no such parameter",
                           place.column);
      }
    }
    add_mapping(section, attribute(object, "PDOmapping"));
  }

  /// rw for TPDOs or RPDOs alone is what CiA 306 calls rwr and rww.
  void add_mapping(Section& section, pugi::xml_attribute mapping) const {
    const std::string_view word = mapping.value();
    const bool is_tpdo = word == "TPDO";
    if (!is_tpdo && word != "RPDO") {
      add(section, "pdomapping", mapping,
          word == "no"                              ? "0"
          : word == "default" || word == "optional" ? "1"
                                                    : word);
      return;
    }
    const auto place = std::ranges::find(section.items, "accesstype", &Item::folded_key);
    if (place == section.items.end()) return add(section, "pdomapping", mapping, "1");
    std::string& access = place->value;
    if (access == "rw") access = is_tpdo ? "rwr" : "rww";
    const bool is_impossible =
        is_tpdo ? access == "wo" || access == "rww" : access == "ro" || access == "const" || access == "rwr";
    if (is_impossible) {
      problems_.report(Severity::loss, document_.position(mapping).line,
                       "PDOmapping=" + std::string(word) + " in [" + section.name + "], which is " + access +
                           ": taken as not to be mapped",
                       document_.position(mapping).column);
    }
    add(section, "pdomapping", mapping, is_impossible ? "0" : "1");
  }

  const xml::Document& document_;
  pugi::xml_node device_;
  XddParameters parameters_;
  Problems& problems_;
  std::vector<Section> sections_;
  std::unordered_map<std::string, unsigned> lines_;  // of the objects and sub-indexes read
};

}  // namespace

bool is_xml(std::string_view text) noexcept {
  if (text.starts_with("\xFF\xFE")) return text.substr(2, 2) == std::string_view("<\0", 2);
  if (text.starts_with("\xFE\xFF")) return text.substr(2, 2) == std::string_view("\0<", 2);
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  const std::size_t start = text.find_first_not_of(" \t\r\n\v\f");
  return start != std::string_view::npos && text[start] == '<';
}

namespace {

/// gb2312 of <?xml version="1.0" encoding="gb2312". Empty: it names none.
std::string_view encoding_in(std::string_view declaration) {
  const std::size_t key = declaration.find("encoding");
  const std::size_t begin = declaration.find_first_of("\"'", key == std::string_view::npos ? key : key + 8);
  if (key == std::string_view::npos || begin == std::string_view::npos) return {};
  const std::size_t end = declaration.find(declaration[begin], begin + 1);
  return end == std::string_view::npos ? std::string_view() : declaration.substr(begin + 1, end - begin - 1);
}

}  // namespace

std::optional<XmlText> xml_text(std::string_view text, Problems& problems) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    problems.note(1, "the file is UTF-16 text: converted");
    return XmlText{from_utf16(text.substr(2), text.starts_with("\xFE\xFF"))};
  }
  if (is_utf8(text)) return XmlText{std::string(text)};
  const std::string declaration = ascii::lower(text.substr(0, std::min<std::size_t>(text.find("?>"), 200)));
  unsigned line = 1;
  for (std::string_view rest = text; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    if (!is_utf8(rest.substr(0, end))) break;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (const auto encoding = encoding_of_name(encoding_in(declaration))) {
    if (auto decoded = decode(text, *encoding)) {
      problems.note(line, "bytes that are not UTF-8: read as " + std::string(encoding->name) + " text");
      return XmlText{*std::move(decoded), encoding};
    }
    problems.error(line,
                   "bytes that are not " + std::string(encoding->name) + ", as which the file is declared");
    return std::nullopt;
  }
  problems.error(line, "bytes that are not UTF-8, as which an XML file is read that names no other encoding");
  return std::nullopt;
}

std::optional<unsigned> read_hexadecimal(std::string_view text, unsigned highest) {
  text = trim(text);
  if (ascii::has_hex_prefix(text)) text.remove_prefix(2);
  const auto number = ascii::parse_number<unsigned>(text, 16);
  return number && *number <= highest ? number : std::nullopt;
}

std::optional<IniFile> read_xdd(std::string_view text, Problems& problems) {
  const auto utf8 = xml_text(text, problems);
  if (!utf8) return std::nullopt;
  const auto document = xml::Document::parse(utf8->text);
  if (!document) {
    problems.report(Severity::error, document.error().position.line,
                    "this cannot be read as XML: " + document.error().message,
                    document.error().position.column);
    return std::nullopt;
  }
  const pugi::xml_node network = xml::network_profile(**document);
  if (!network) {
    const xml::Mistake mistake = xml::missing_profile(**document);
    problems.report(Severity::error, mistake.position.line, mistake.message, mistake.position.column);
    return std::nullopt;
  }
  return IniFile(XddReader(**document, xml::device_profile(**document), problems).read(network));
}

}  // namespace canopus::eds
