#include "canopus/eds/xml/profiles.hpp"

#include <algorithm>
#include <string>

#include "canopus/ascii/words.hpp"

namespace canopus::eds::xml {
namespace {

/// By its xsi:type or, where it has none, by a child element of it.
pugi::xml_node profile(const Document& document, std::string_view type, std::string_view typical_child) {
  for (const pugi::xml_node outer : document.root()) {
    const pugi::xml_node body =
        local_name(outer.name()) == "ProfileBody" ? outer : child(outer, "ProfileBody");
    const std::string_view found = local_name(attribute(body, "type").value());
    if (found == type || (found.empty() && child(body, typical_child))) return body;
  }
  return {};
}

struct ForeignRoot {
  std::string_view element;
  std::string_view kind;
};
constexpr ForeignRoot foreign_roots[] = {
    {"EtherCATInfo", "an EtherCAT device file (ESI)"},
    {"EtherCATConfig", "an EtherCAT network configuration (ENI)"},
    {"IODevice", "an IO-Link device file (IODD)"},
    {"ExternalTextDocument", "a text file of an IO-Link device (IODD)"},
    {"FDT", "an FDT file"},
    {"UANodeSet", "an OPC UA node set"},
    {"NetworkDefinition", "a KCD network description"},
    {"html", "a web page"},
};

/// Networks of ISO 15745 by a word in the type of a profile body, or in what its header calls itself.
constexpr ForeignRoot foreign_profiles[] = {
    {"powerlink", "an Ethernet POWERLINK device file (XDD)"},
    {"profinet", "a PROFINET device file (GSDML)"},
    {"ethernetip", "an EtherNet/IP device file (XML)"},
    {"devicenet", "a DeviceNet device file (XML)"},
    {"controlnet", "a ControlNet device file (XML)"},
    {"profibus", "a PROFIBUS device file (XML)"},
    {"cc-link", "a CC-Link device file (CSP+)"},
    {"modbus", "a Modbus device file (XML)"},
};

/// "an EtherCAT device file (ESI)" ...; empty: not known.
std::string_view foreign_kind(const Document& document) {
  const std::string_view name = local_name(document.root().name());
  const auto* const root = std::ranges::find(foreign_roots, name, &ForeignRoot::element);
  if (root != std::end(foreign_roots)) return root->kind;
  const auto known = [](std::string_view text) -> std::string_view {
    const std::string lower = ascii::lower(text);
    for (const ForeignRoot& one : foreign_profiles) {
      if (lower.find(one.element) != std::string::npos) return one.kind;
    }
    return {};
  };
  const auto kind_of = [&](pugi::xml_node profile) -> std::string_view {
    if (const auto kind = known(attribute(child(profile, "ProfileBody"), "type").value()); !kind.empty())
      return kind;
    const pugi::xml_node header = child(profile, "ProfileHeader");
    for (const std::string_view element : {"ProfileIdentification", "ProfileName"}) {
      if (const auto kind = known(child(header, element).child_value()); !kind.empty()) return kind;
    }
    return known(child(child(header, "ISO15745Reference"), "ProfileTechnology").child_value());
  };
  if (const auto kind = kind_of(document.root()); !kind.empty()) return kind;
  for (const pugi::xml_node outer : document.root()) {
    if (const auto kind = kind_of(outer); !kind.empty()) return kind;
  }
  return {};
}

}  // namespace

pugi::xml_node network_profile(const Document& document) {
  return profile(document, "ProfileBody_CommunicationNetwork_CANopen", "ApplicationLayers");
}

pugi::xml_node device_profile(const Document& document) {
  return profile(document, "ProfileBody_Device_CANopen", "DeviceIdentity");
}

Mistake missing_profile(const Document& document) {
  const pugi::xml_node root = document.root();
  pugi::xml_attribute network;  // the type of another network's profile
  for (const pugi::xml_node outer : root) {
    const auto type = attribute(child(outer, "ProfileBody"), "type");
    if (!network && std::string_view(type.value()).find("CommunicationNetwork") != std::string_view::npos)
      network = type;
  }
  const Position position = network ? document.position(network) : document.position(root);
  if (const std::string_view kind = foreign_kind(document); !kind.empty()) {
    return {position,
            "this is " + std::string(kind) + " and no device file of CANopen (EDS, DCF, XDD or XDC)"};
  }
  if (network) {
    return {position,
            "the network is not described as ProfileBody_CommunicationNetwork_CANopen: this is a device of "
            "another network"};
  }
  const std::string_view name = local_name(root.name());
  if (name != "ISO15745ProfileContainer" && name != "ISO15745Profile") {
    return {position, "the root element is no ISO15745ProfileContainer, as an XDD [CiA 311] has it"};
  }
  return {position, "there is no ProfileBody_CommunicationNetwork_CANopen: no object is described"};
}

}  // namespace canopus::eds::xml
