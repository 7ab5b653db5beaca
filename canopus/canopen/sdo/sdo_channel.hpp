#pragma once
// One SDO client channel as 1280H-12FFH describe it [CiA 301].

#include <cstdint>

namespace canopus::canopen {

/// Parameters of one SDO client channel, for SdoClient::set_channel().
struct SdoClientChannel {
  std::uint32_t request = 0;   ///< client to server: identifier, bit 29 = extended
  std::uint32_t response = 0;  ///< server to client
  std::uint8_t node_id = 0;    ///< of the server
};

}  // namespace canopus::canopen
