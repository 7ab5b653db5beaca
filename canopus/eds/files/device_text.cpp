#include "canopus/eds/files/device_text.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "canopus/eds/encoding.hpp"
#include "canopus/eds/problems.hpp"
#include "canopus/eds/words.hpp"
#include "canopus/eds/xdd.hpp"
#include "canopus/eds/xml/profiles.hpp"

namespace canopus::eds {
namespace {

using Done = std::expected<void, std::string>;

pugi::xml_node object_list(const xml::Document& document) {
  return xml::child(xml::child(xml::network_profile(document), "ApplicationLayers"), "CANopenObjectList");
}

/// The first child of this name whose attribute is this hexadecimal number.
pugi::xml_node numbered(pugi::xml_node parent, std::string_view name, std::string_view attribute,
                        unsigned number) {
  return parent.find_child([&](pugi::xml_node node) {
    return xml::local_name(node.name()) == name &&
           read_hexadecimal(xml::attribute(node, attribute).value(), 0xFFFF) == number;
  });
}

/// The element that describes a sub-index, or an empty one.
pugi::xml_node described(const xml::Document& document, std::uint16_t index, std::uint8_t sub) {
  const pugi::xml_node object = numbered(object_list(document), "CANopenObject", "index", index);
  if (const auto member = numbered(object, "CANopenSubObject", "subIndex", sub)) return member;
  return sub == 0 && !xml::child(object, "CANopenSubObject") ? object : pugi::xml_node{};
}

unsigned references(const xml::Document& document, std::string_view id) {
  unsigned count = 0;
  const auto count_reference = [&](pugi::xml_node node) {
    if (xml::attribute(node, "uniqueIDRef").value() == id) ++count;
  };
  for (const pugi::xml_node object : object_list(document)) {
    count_reference(object);
    for (const pugi::xml_node member : object) count_reference(member);
  }
  return count;
}

/// actualValue of the parameter that an object refers to, when the object alone does; else an empty element.
pugi::xml_node value_of_parameter(const xml::Document& document, pugi::xml_node element) {
  const std::string_view id = xml::attribute(element, "uniqueIDRef").value();
  if (id.empty() || xml::attribute(element, "actualValue")) return {};
  const pugi::xml_node list =
      xml::child(xml::child(xml::device_profile(document), "ApplicationProcess"), "parameterList");
  for (const pugi::xml_node parameter : list) {
    if (xml::attribute(parameter, "uniqueID").value() != id) continue;
    const pugi::xml_node value = xml::child(parameter, "actualValue");
    return value && references(document, id) == 1 ? value : pugi::xml_node{};
  }
  return {};
}

std::expected<std::shared_ptr<const DeviceFile>, std::string> device_of(std::string_view text) {
  const ReadResult read = read_device_file(text);
  if (read.file != nullptr) return read.file;
  const Problem& problem = read.problems.front();
  return std::unexpected("line " + std::to_string(problem.line) + ": " + problem.message);
}

}  // namespace

DeviceText::DeviceText(std::string_view text) : file_(read(text)) {}

std::variant<IniText, DeviceText::Xdd, DeviceText::Unreadable> DeviceText::read(std::string_view text) {
  if (!eds::is_xml(text)) return IniText(text);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return Unreadable{std::string(text), "the file is UTF-16 text: save it as UTF-8 before it is changed"};
  }
  Problems problems;
  const auto utf8 = xml_text(text, problems);
  if (!utf8) return Unreadable{std::string(text), problems.release().front().message};
  auto parsed = xml::Text::parse(utf8->text, utf8->encoding.has_value());
  if (!parsed) {
    return Unreadable{std::string(text), "line " + std::to_string(parsed.error().position.line) +
                                             ": this cannot be read as XML: " + parsed.error().message};
  }
  return Xdd{std::move(*parsed), utf8->encoding};
}

std::string DeviceText::bytes(const Xdd& file) {
  // What is new in it is ASCII.
  return file.encoding ? encode(file.text.text(), *file.encoding).value_or("") : file.text.text();
}

std::string DeviceText::text() const {
  if (const auto* ini = std::get_if<IniText>(&file_)) return ini->text();
  if (const auto* xdd = std::get_if<Xdd>(&file_)) return bytes(*xdd);
  return std::get<Unreadable>(file_).bytes;
}

Done DeviceText::set_parameter_value(std::uint16_t index, std::uint8_t sub, std::string_view value) {
  if (auto* ini = std::get_if<IniText>(&file_)) return eds::set_parameter_value(*ini, index, sub, value);
  auto* xdd = std::get_if<Xdd>(&file_);
  if (xdd == nullptr) return std::unexpected(std::get<Unreadable>(file_).reason);
  if (trim(value).empty()) return std::unexpected("no value is given for " + object_text(index, sub));
  const auto device = device_of(bytes(*xdd));
  if (!device) return std::unexpected(device.error());
  const canopen::DictionaryDescription& dictionary = *(*device)->dictionary;
  const canopen::Entry entry = dictionary.find(index, sub);
  if (!entry) return std::unexpected("the file has no sub-index " + object_text(index, sub));
  if (std::string problem = value_problem(dictionary, entry, "actualValue", value); !problem.empty()) {
    return std::unexpected(std::move(problem));
  }
  const pugi::xml_node element = described(xdd->text.document(), index, sub);
  if (!element) {
    return std::unexpected("the file has no element for " + object_text(index, sub) +
                           ", so no place for its value");
  }
  if (const auto parameter = value_of_parameter(xdd->text.document(), element)) {
    return xdd->text.set(parameter, "value", value);
  }
  return xdd->text.set(element, "actualValue", value);
}

Done DeviceText::remove_parameter_value(std::uint16_t index, std::uint8_t sub) {
  if (auto* ini = std::get_if<IniText>(&file_)) return eds::remove_parameter_value(*ini, index, sub);
  auto* xdd = std::get_if<Xdd>(&file_);
  if (xdd == nullptr) return std::unexpected(std::get<Unreadable>(file_).reason);
  const pugi::xml_node element = described(xdd->text.document(), index, sub);
  if (!element) return std::unexpected("the file has no sub-index " + object_text(index, sub));
  if (const auto parameter = value_of_parameter(xdd->text.document(), element)) {
    return xdd->text.remove(parameter);
  }
  return xdd->text.remove(element, "actualValue");
}

Done DeviceText::configure(const ConfigurationNames& names, const Commissioning& commissioning) {
  if (auto* ini = std::get_if<IniText>(&file_)) {
    auto made = make_configuration(ini->text(), names, commissioning);
    if (!made) return std::unexpected(std::move(made.error()));
    *ini = std::move(*made);
    return {};
  }
  auto* xdd = std::get_if<Xdd>(&file_);
  if (xdd == nullptr) return std::unexpected(std::get<Unreadable>(file_).reason);
  if (const auto device = device_of(bytes(*xdd)); !device) return std::unexpected(device.error());
  if (std::string problem = commissioning_problem(commissioning); !problem.empty()) {
    return std::unexpected(std::move(problem));
  }
  if (commissioning.lss_serial_number != 0) {
    return std::unexpected("an XDC has no place for an LSS serial number");
  }
  xml::Text changed = xdd->text;
  if (!names.file_name.empty()) {
    for (const auto profile : {xml::network_profile, xml::device_profile}) {
      const pugi::xml_node body = profile(changed.document());
      if (!body) continue;
      if (const Done done = changed.set(body, "fileName", names.file_name); !done) return done;
    }
  }
  const auto management = [&] {
    return xml::child(xml::network_profile(changed.document()), "NetworkManagement");
  };
  const auto commissioned = [&] { return xml::child(management(), "deviceCommissioning"); };
  const auto number = [](std::uint64_t value) { return value == 0 ? std::string() : std::to_string(value); };
  std::vector<std::pair<std::string_view, std::string>> attributes = {
      {"nodeID", number(*commissioning.node_id)},
      {"nodeName", commissioning.node_name},
      {"actualBaudRate", commissioning.bit_rate == 0 ? "" : number(commissioning.bit_rate / 1000) + " Kbps"},
      {"networkNumber", number(commissioning.net_number)},
      {"networkName", commissioning.network_name},
      {"CANopenManager", commissioning.canopen_manager ? "true" : ""}};
  if (commissioned()) {
    for (const auto& [name, value] : attributes) {
      if (value.empty()) continue;
      if (const Done done = changed.set(commissioned(), name, value); !done) return done;
    }
  } else {
    if (!management())
      return std::unexpected("the file has no NetworkManagement, in which deviceCommissioning belongs");
    if (attributes[3].second.empty()) attributes[3].second = "0";
    if (attributes[5].second.empty()) attributes[5].second = "false";
    if (const Done done = changed.append(management(), "deviceCommissioning", attributes); !done) return done;
  }
  xdd->text = std::move(changed);
  return {};
}

std::expected<DeviceText, std::string> make_device_configuration(std::string_view file,
                                                                 const ConfigurationNames& names,
                                                                 const Commissioning& commissioning) {
  DeviceText text(file);
  if (const Done done = text.configure(names, commissioning); !done) return std::unexpected(done.error());
  return text;
}

}  // namespace canopus::eds
