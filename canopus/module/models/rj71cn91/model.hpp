#pragma once
// The RJ71CN91 as the engine reads it: bits, emergency messages, LEDs, what it does otherwise than its sister ME3CAN1-Q, and
// the tables beside this file.

#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::rj71cn91 {

extern const ModuleModel model;

}  // namespace canopus::module::rj71cn91
