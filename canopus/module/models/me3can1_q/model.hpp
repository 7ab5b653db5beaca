#pragma once
// The ME3CAN1-Q as the engine reads it: signals, bits, commands, emergency messages, LEDs, and the tables
// beside this file.

#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::me3can1_q {

extern const ModuleModel model;

}  // namespace canopus::module::me3can1_q
