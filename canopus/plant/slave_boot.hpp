#pragma once

#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::plant {

/// How far a module of the plant is with the boot of a slave, which may be a node outside of the plant, or
/// missing.
struct SlaveBoot {
  NodeLabel slave;
  NodeLabel master;
  manager::BootRecord record;
};

}  // namespace canopus::plant
