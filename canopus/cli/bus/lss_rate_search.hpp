#pragma once

#include "canopus/cli/bus/lss_device.hpp"

namespace canopus::cli {

/// `lss search`: looks for one device at every bit rate of LSS, and gives it a node-ID and the bit rate of this network. An exit
/// code.
int lss_rate_search(const LssArguments& arguments);

}  // namespace canopus::cli
