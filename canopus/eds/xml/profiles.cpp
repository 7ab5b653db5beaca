#include "canopus/eds/xml/profiles.hpp"

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

}  // namespace

pugi::xml_node network_profile(const Document& document) {
  return profile(document, "ProfileBody_CommunicationNetwork_CANopen", "ApplicationLayers");
}

pugi::xml_node device_profile(const Document& document) {
  return profile(document, "ProfileBody_Device_CANopen", "DeviceIdentity");
}

Mistake missing_profile(const Document& document) {
  const pugi::xml_node root = document.root();
  const std::string_view name = local_name(root.name());
  if (name != "ISO15745ProfileContainer" && name != "ISO15745Profile") {
    return {document.position(root),
            "the root element is no ISO15745ProfileContainer, as an XDD [CiA 311] has it"};
  }
  for (const pugi::xml_node outer : root) {
    const auto type = attribute(child(outer, "ProfileBody"), "type");
    if (std::string_view(type.value()).find("CommunicationNetwork") == std::string_view::npos) continue;
    return {document.position(type),
            "the network is not described as ProfileBody_CommunicationNetwork_CANopen: this is a device of "
            "another "
            "network"};
  }
  return {document.position(root),
          "there is no ProfileBody_CommunicationNetwork_CANopen: no object is described"};
}

}  // namespace canopus::eds::xml
