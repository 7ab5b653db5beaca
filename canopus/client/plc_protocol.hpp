#pragma once
// One request to a PLC and its reply, in the protocol of its port.

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>

#include "canopus/client/plc_link.hpp"
#include "canopus/client/plc_point.hpp"

namespace canopus::client {

/// The model that a CPU reports.
struct PlcType {
  std::string name;
  std::uint16_t code = 0;  ///< of the MC protocol
};

enum class PlcOperation : std::uint8_t { run, stop, pause, reset };

class PlcProtocol {
 public:
  /// The error is a sentence: "127.0.0.1:5007: Connection refused", or the PLC's end code in hexadecimal and
  /// words.
  template <typename Value>
  using Result = std::expected<Value, std::string>;

  virtual ~PlcProtocol() = default;

  /// Points that one request can carry.
  [[nodiscard]] virtual std::size_t most_words() const noexcept = 0;
  [[nodiscard]] virtual std::size_t most_bits() const noexcept = 0;

  virtual Result<void> read_words(const PlcPoint& first, std::span<std::uint16_t> words) = 0;
  virtual Result<void> write_words(const PlcPoint& first, std::span<const std::uint16_t> words) = 0;
  /// 0 or 1 per point.
  virtual Result<void> read_bits(const PlcPoint& first, std::span<std::uint8_t> bits) = 0;
  virtual Result<void> write_bits(const PlcPoint& first, std::span<const std::uint8_t> bits) = 0;
  /// RUN and PAUSE are forced when another client stopped the CPU; nothing is cleared. A CPU that was reset answers
  /// nothing, so silence is success then.
  virtual Result<void> operate(PlcOperation operation) = 0;
  virtual Result<PlcType> read_type() = 0;
  /// Brings the remote password of the connection; and takes the leave back.
  virtual Result<void> unlock() { return {}; }
  virtual Result<void> lock() { return {}; }
};

/// 3E and 4E frames, 1E frames, Modbus TCP. The link must outlive what they make.
[[nodiscard]] std::unique_ptr<PlcProtocol> melsec_client(PlcLink& link);
[[nodiscard]] std::unique_ptr<PlcProtocol> melsec_1e_client(PlcLink& link);
[[nodiscard]] std::unique_ptr<PlcProtocol> modbus_client(PlcLink& link);

}  // namespace canopus::client
