#pragma once
// `canopus lss scan`: finds every device without a node-ID and numbers them if asked to.

#include "canopus/cli/bus/lss_device.hpp"

namespace canopus::cli {

/// An exit code.
int lss_scan(const LssArguments& arguments);

}  // namespace canopus::cli
