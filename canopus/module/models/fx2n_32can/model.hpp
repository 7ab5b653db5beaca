#pragma once

#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::fx2n_32can {

extern const ModuleModel model;

}  // namespace canopus::module::fx2n_32can
