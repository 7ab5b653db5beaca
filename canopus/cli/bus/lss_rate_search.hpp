#pragma once

#include "canopus/cli/bus/lss_device.hpp"

namespace canopus::cli {

/// `lss search`: finds one device at every bit rate of LSS, and assigns a node-ID and the bit rate of this
/// network. Returns an exit code.
int lss_rate_search(const LssArguments& arguments);

}  // namespace canopus::cli
