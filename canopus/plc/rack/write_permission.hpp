#pragma once

#include <cstdint>

#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc {

/// What a client of a port may write, as the open settings of an Ethernet module have it.
enum class WritePermission : std::uint8_t {
  always,
  in_stop,  ///< "online change" is not enabled: only while the CPU is in STOP
  never     ///< the client may only look: no remote operation either
};

[[nodiscard]] inline bool may_write(WritePermission permission, const Rack& rack) noexcept {
  if (permission == WritePermission::in_stop) return rack.cpu_state() == module::CpuState::stop;
  return permission == WritePermission::always;
}

}  // namespace canopus::plc
