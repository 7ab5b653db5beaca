#pragma once
// A client of a plant's control server over one blocking TCP connection, for the command line.

#include <chrono>
#include <cstdint>
#include <expected>
#include <string>

#include "canopus/text/json.hpp"

namespace canopus::client {

struct ControlConnection {
  std::string host = "127.0.0.1";
  std::uint16_t port = 29540;
  std::chrono::milliseconds timeout{3000};  ///< to connect, and for the answer
};

/// Sends one request and gives its answer, a JSON object whose "ok" is true. The error is a sentence: the
/// reason of the failure, or the plant's error message.
[[nodiscard]] std::expected<text::Json, std::string> request_control(const ControlConnection& connection,
                                                                     const text::Json& request);

}  // namespace canopus::client
