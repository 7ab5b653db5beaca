#pragma once

#include "canopus/module/interface/configuration_tool.hpp"

namespace canopus::module::rj71cn91 {

/// The RJ71CN91 in CANopen 405 mode [RJ71CN91 3.1].
extern const ConfigurationTool configuration_tool;

}  // namespace canopus::module::rj71cn91
