#pragma once
// Modular devices: bus couplers whose objects depend on the modules plugged into them [CiA 306].

#include "canopus/eds/draft.hpp"

namespace canopus::eds {

/// Reads [SupportedModules] and [MxModuleInfo] into the device, and from a DCF [ConnectedModules]; the
/// objects of the connected modules are added to the draft.
void read_modules(const IniFile& file, Draft& draft, DeviceFile& device, Problems& problems);

}  // namespace canopus::eds
