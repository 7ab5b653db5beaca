#pragma once

#include "canopus/module/engine/module_model.hpp"

namespace canopus::module::fx3u_can {

extern const ModuleModel model;

}  // namespace canopus::module::fx3u_can
