#pragma once
// The two profiles of an XDD or XDC [CiA 311]: of the device, and of its communication network.

#include "canopus/eds/xml/document.hpp"

namespace canopus::eds::xml {

/// The body of the profile of the communication network, with the objects; an empty element: there is none.
[[nodiscard]] pugi::xml_node network_profile(const Document& document);
/// The body of the profile of the device: its maker, and its application process; an empty element: there is none.
[[nodiscard]] pugi::xml_node device_profile(const Document& document);
/// Why a document without network_profile() describes no CANopen device.
[[nodiscard]] Mistake missing_profile(const Document& document);

}  // namespace canopus::eds::xml
