#pragma once

#include <cstdint>

namespace canopus::plc {

class Rack;

/// What a client of a port may write, as the open settings of an Ethernet module have it.
enum class WritePermission : std::uint8_t {
  always,
  in_stop,  ///< "online change" is not enabled: only while the CPU is in STOP
  never     ///< the client may only look: no remote operation either
};

[[nodiscard]] bool may_write(WritePermission permission, const Rack& rack) noexcept;

}  // namespace canopus::plc
