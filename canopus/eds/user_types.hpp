#pragma once
// Data types that a file makes of a base type and limits, as CANFestival's editor does for every object with limits:
// [A0] is a DEFTYPE with [A0sub1] base type, [A0sub2] lowest and [A0sub3] highest value.

#include "canopus/eds/ini.hpp"

namespace canopus::eds {

/// The file with the base types and limits in the objects that have such a type; an object's own limits count before
/// those of its type.
[[nodiscard]] IniFile with_base_types(IniFile file, Problems& problems);

}  // namespace canopus::eds
