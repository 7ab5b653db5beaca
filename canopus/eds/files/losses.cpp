#include "canopus/eds/files/losses.hpp"

#include <algorithm>
#include <map>

#include "canopus/eds/draft.hpp"
#include "canopus/eds/problems.hpp"
#include "canopus/eds/xdd.hpp"
#include "canopus/eds/xml/profiles.hpp"

namespace canopus::eds {
namespace {

constexpr std::size_t most_losses = 20;

/// Sections that become part of a DeviceFile, or for which the writer reports that they do not.
bool is_carried(const Section& section) {
  constexpr std::string_view known[] = {"fileinfo",
                                        "deviceinfo",
                                        "dummyusage",
                                        "comments",
                                        "mandatoryobjects",
                                        "optionalobjects",
                                        "manufacturerobjects",
                                        "devicecomissioning",
                                        "devicecommissioning",
                                        "supportedmodules",
                                        "connectedmodules"};
  const std::string_view name = section.folded_name;
  if (std::ranges::find(known, name) != std::end(known)) return true;
  if (const auto object = object_section(name)) {
    return object->index >= 0x1000 && object->kind != ObjectSection::Kind::links;
  }
  return name.size() > 1 && name[0] == 'm' && name[1] >= '0' && name[1] <= '9';  // of a module
}

std::vector<std::string> beyond_ini(std::string_view text) {
  std::vector<std::string> lost;
  Problems unheard;
  const IniFile file(text, unheard);
  constexpr std::string_view keys[] = {"paramrefd", "srdomapping", "objectlinks"};
  std::map<std::string_view, std::size_t> found;
  for (const Section& section : file.sections()) {
    if (!is_carried(section) && lost.size() < most_losses) {
      lost.push_back("[" + section.name + "] has no place in a file written anew: left out");
    }
    for (const std::string_view key : keys) {
      if (section.find_value(key) != nullptr) ++found[key];
    }
  }
  for (const auto& [key, count] : found) {
    lost.push_back(std::string(key) + " of " + counted(count, "object") +
                   " has no place in a file written anew: left out");
  }
  return lost;
}

/// Whether an ApplicationProcess says more than what its parameters give to objects.
bool has_more_than_descriptions(pugi::xml_node process) {
  constexpr std::string_view beyond[] = {"unit", "property", "substituteValue", "conditionalSupport",
                                         "variableRef"};
  for (const pugi::xml_node list : process) {
    if (list.type() != pugi::node_element) continue;
    if (xml::local_name(list.name()) != "parameterList") return true;
    for (const pugi::xml_node parameter : list) {
      if (std::ranges::any_of(beyond, [&](std::string_view name) { return !!xml::child(parameter, name); }))
        return true;
    }
  }
  return false;
}

std::vector<std::string> beyond_xdd(std::string_view xdd) {
  std::vector<std::string> lost;
  Problems unheard;
  const auto text = xml_text(xdd, unheard);
  if (!text) return lost;
  const auto document = xml::Document::parse(text->text);
  if (!document) return lost;
  const pugi::xml_node device = xml::device_profile(**document);
  const auto name = [&](pugi::xml_node parent, std::string_view element, std::string_view what) {
    if (xml::child(parent, element).first_child()) {
      lost.push_back(std::string(element) + " (" + std::string(what) +
                     ") has no place in other device files: left out");
    }
  };
  if (has_more_than_descriptions(xml::child(device, "ApplicationProcess"))) {
    lost.emplace_back(
        "ApplicationProcess (units and groups of parameters, types of their own) has no place in other "
        "device "
        "files: left out");
  }
  name(device, "DeviceManager", "indicators and modules of the device");
  const pugi::xml_node layers = xml::child(xml::network_profile(**document), "ApplicationLayers");
  name(layers, "dynamicChannels", "segments of a programmable device");
  name(layers, "moduleManagement", "interfaces and modules of the device");
  for (const pugi::xml_node element : xml::child(device, "DeviceIdentity")) {
    constexpr std::string_view carried[] = {"vendorName", "vendorID",    "productName",
                                            "productID",  "productText", "orderNumber"};
    const std::string_view found = xml::local_name(element.name());
    if (element.type() != pugi::node_element || std::ranges::find(carried, found) != std::end(carried))
      continue;
    if (lost.size() < most_losses)
      lost.push_back(printable(found) + " of DeviceIdentity has no place in other device files: left out");
  }
  return lost;
}

}  // namespace

std::vector<std::string> beyond_device_file(std::string_view text) {
  return is_xml(text) ? beyond_xdd(text) : beyond_ini(text);
}

}  // namespace canopus::eds
