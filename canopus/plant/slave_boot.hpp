#pragma once

#include "canopus/manager/boot/boot_record.hpp"
#include "canopus/plant/plant.hpp"

namespace canopus::plant {

/// The boot progress of a slave at a module of the plant; the slave may be an external node, or missing.
struct SlaveBoot {
  NodeLabel slave;
  NodeLabel master;
  manager::BootRecord record;
};

}  // namespace canopus::plant
