#pragma once
// Codes of the gateway's answers and events that are no SDO abort codes.

#include <cstdint>
#include <string_view>

namespace canopus::client {

/// [CiA 309-1; 309-3]
enum class GatewayError : std::uint16_t {
  none = 0,
  not_supported = 100,
  syntax = 101,
  state = 102,
  time_out = 103,
  no_network = 104,
  no_node = 105,
  unsupported_network = 106,
  unsupported_node = 107,
  guarding_lost = 200,
  connection_lost = 201,
  heartbeat_started = 202,
  heartbeat_lost = 203,
  wrong_state = 204,
  error_passive = 300,
  bus_off = 301,
  overflow = 303,
  controller = 304,
  pdo_in_use = 400,
  pdo_length = 401,
  lss = 501,
  lss_node_id = 502,
  lss_bit_rate = 503,
  lss_store = 504,
  lss_media = 505,
  memory = 600,
};
[[nodiscard]] std::string_view describe(GatewayError error) noexcept;

}  // namespace canopus::client
