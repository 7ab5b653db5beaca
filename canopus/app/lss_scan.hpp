#pragma once
// `canopus lss scan`: finds every device without a node-ID and numbers them if asked to.

#include "canopus/app/lss_device.hpp"

namespace canopus::app {

/// An exit code.
int lss_scan(const LssArguments& arguments);

}  // namespace canopus::app
