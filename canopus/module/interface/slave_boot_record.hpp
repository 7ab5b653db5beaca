#pragma once

#include <cstdint>

#include "canopus/manager/boot/boot_record.hpp"

namespace canopus::module {

/// How the boot of one slave went or where it is.
struct SlaveBootRecord {
  std::uint8_t node_id = 0;
  manager::BootRecord record{};
};

}  // namespace canopus::module
