#pragma once
// A client of the MELSEC communication protocol over one blocking TCP connection, for the command line.

#include <chrono>
#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canopus/plc/melsec/field.hpp"
#include "canopus/plc/melsec/target.hpp"

namespace canopus::client {

struct PlcConnection {
  std::string host = "127.0.0.1";
  std::uint16_t port = 5007;
  bool frame_4e = false;
  bool ascii = false;
  std::chrono::milliseconds timeout{3000};  ///< to connect, and for each reply
};

class PlcClient {
 public:
  /// What could not be done, as a sentence: "127.0.0.1:5007: Connection refused", or the PLC's end code in
  /// hexadecimal and words.
  template <typename Value>
  using Result = std::expected<Value, std::string>;

  [[nodiscard]] static Result<PlcClient> connect(const PlcConnection& connection);
  PlcClient(PlcClient&&) noexcept;
  PlcClient& operator=(PlcClient&&) noexcept;
  ~PlcClient();

  /// Any number of words from the target on; several requests when one cannot hold them.
  Result<std::vector<std::uint16_t>> read_words(const plc::melsec::Target& target, std::uint32_t count);
  Result<void> write_words(const plc::melsec::Target& target, std::span<const std::uint16_t> words);
  /// Bit devices: 0 or 1 per point.
  Result<std::vector<std::uint8_t>> read_bits(const plc::melsec::Target& target, std::uint32_t count);
  Result<void> write_bits(const plc::melsec::Target& target, std::span<const std::uint8_t> bits);

  /// Remote RUN, forced when another client stopped the CPU; nothing is cleared.
  Result<void> remote_run();
  Result<void> remote_stop();
  /// Remote PAUSE, forced when another client stopped the CPU.
  Result<void> remote_pause();

  struct Type {
    std::string name;
    std::uint16_t code = 0;
  };
  Result<Type> read_type();

 private:
  struct Parts;
  explicit PlcClient(std::unique_ptr<Parts> parts) noexcept;

  std::unique_ptr<Parts> parts_;
};

}  // namespace canopus::client
