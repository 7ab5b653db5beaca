#pragma once

#include "canopus/module/interface/configuration_tool.hpp"

namespace canopus::module::fx3u_can {

/// The FX3U-CAN in CANopen 405 mode [FX3U-CAN 15.1.2].
extern const ConfigurationTool configuration_tool;

}  // namespace canopus::module::fx3u_can
