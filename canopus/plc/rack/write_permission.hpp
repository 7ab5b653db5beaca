#pragma once

#include <cstdint>

namespace canopus::plc {

class Rack;

/// The write permission of a port's clients, as in the open settings of an Ethernet module.
enum class WritePermission : std::uint8_t {
  always,
  in_stop,  ///< "online change" is not enabled: only while the CPU is in STOP
  never     ///< the client may only read: no remote operation either
};

[[nodiscard]] bool may_write(WritePermission permission, const Rack& rack) noexcept;

}  // namespace canopus::plc
