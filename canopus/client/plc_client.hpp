#pragma once
// A client of a PLC for the command line: the MC protocol in 1E, 3E and 4E frames over TCP and UDP, and Modbus TCP.

#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canopus/client/plc_link.hpp"
#include "canopus/client/plc_point.hpp"
#include "canopus/client/plc_protocol.hpp"

namespace canopus::client {

class PlcClient {
 public:
  template <typename Value>
  using Result = PlcProtocol::Result<Value>;

  /// Connects, and unlocks the port when there is a remote password.
  [[nodiscard]] static Result<PlcClient> connect(const PlcConnection& connection);
  /// Locks a port of UDP again, which a TCP port does by itself when the connection ends.
  Result<void> leave();

  /// Any number of words from the point on; several requests when one cannot hold them. Of a bit device 16 points
  /// are a word.
  Result<std::vector<std::uint16_t>> read_words(const PlcPoint& first, std::uint32_t count);
  Result<void> write_words(const PlcPoint& first, std::span<const std::uint16_t> words);
  /// 0 or 1 per point.
  Result<std::vector<std::uint8_t>> read_bits(const PlcPoint& first, std::uint32_t count);
  Result<void> write_bits(const PlcPoint& first, std::span<const std::uint8_t> bits);

  Result<void> operate(PlcOperation operation) {
    is_reset_ = operation == PlcOperation::reset;  // locks a port as well
    return protocol_->operate(operation);
  }
  Result<PlcType> read_type() { return protocol_->read_type(); }

 private:
  PlcClient(std::unique_ptr<PlcLink> link, std::unique_ptr<PlcProtocol> protocol) noexcept;

  std::unique_ptr<PlcLink> link_;
  std::unique_ptr<PlcProtocol> protocol_;
  bool is_reset_ = false;
};

/// Why a point cannot be reached in this frame, as a sentence; empty: it can. `octal`: the PLC is an FX.
[[nodiscard]] std::string why_not_reached(const PlcPoint& point, PlcConnection::Frame frame, bool octal);

}  // namespace canopus::client
