#include "canopus/client/gateway/gateway_error.hpp"

namespace canopus::client {

std::string_view describe(GatewayError error) noexcept {
  switch (error) {
    case GatewayError::none: return "no error";
    case GatewayError::not_supported: return "request not supported";
    case GatewayError::syntax: return "syntax error";
    case GatewayError::state: return "request not processed due to the internal state";
    case GatewayError::time_out: return "time-out";
    case GatewayError::no_network: return "no default network set";
    case GatewayError::no_node: return "no default node set";
    case GatewayError::unsupported_network: return "unsupported network";
    case GatewayError::unsupported_node: return "unsupported node";
    case GatewayError::guarding_lost: return "lost guarding message";
    case GatewayError::connection_lost: return "lost connection";
    case GatewayError::heartbeat_started: return "heartbeat started";
    case GatewayError::heartbeat_lost: return "heartbeat lost";
    case GatewayError::wrong_state: return "wrong NMT state";
    case GatewayError::error_passive: return "error passive";
    case GatewayError::bus_off: return "bus-off";
    case GatewayError::overflow: return "CAN buffer overflow";
    case GatewayError::controller: return "CAN init";
    case GatewayError::pdo_in_use: return "PDO already used";
    case GatewayError::pdo_length: return "PDO length exceeded";
    case GatewayError::lss: return "LSS error of the device";
    case GatewayError::lss_node_id: return "LSS node-ID not supported";
    case GatewayError::lss_bit_rate: return "LSS bit rate not supported";
    case GatewayError::lss_store: return "LSS parameter storing failed";
    case GatewayError::lss_media: return "LSS command failed because of a media error";
    case GatewayError::memory: return "running out of memory";
  }
  return "error";
}

}  // namespace canopus::client
