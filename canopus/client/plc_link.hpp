#pragma once
// A client's way to a PLC: one TCP connection, or UDP to one port; blocking, with a time-out.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace canopus::client {

/// The settings of the PLC's port.
struct PlcConnection {
  enum class Frame : std::uint8_t { frame_3e, frame_4e, frame_1e, modbus };

  std::string host = "127.0.0.1";
  std::uint16_t port = 5007;
  Frame frame = Frame::frame_3e;
  bool ascii = false;                ///< not with Modbus
  bool udp = false;                  ///< not with Modbus
  bool octal = false;                ///< 3E and 4E in ASCII write X and Y so, as an FX5 takes them
  std::string remote_password{};     ///< 3E and 4E: unlocks the port first; empty: it has none
  std::uint16_t module_io = 0x03FF;  ///< 3E and 4E: 03FFH: the control CPU; 03E0H to 03E3H: CPU No.1 to No.4
  std::uint8_t unit = 255;           ///< Modbus: unit identifier; 255: the server of the port itself
  std::chrono::milliseconds timeout{3000};  ///< to connect, and for each reply
};

class PlcLink {
 public:
  /// The error is a sentence that begins with the PLC's address.
  template <typename Value>
  using Result = std::expected<Value, std::string>;

  explicit PlcLink(PlcConnection connection);
  ~PlcLink();
  PlcLink(const PlcLink&) = delete;
  PlcLink& operator=(const PlcLink&) = delete;

  [[nodiscard]] const PlcConnection& connection() const noexcept { return connection_; }
  Result<void> open();
  /// A whole request; over UDP one datagram.
  Result<void> send(std::span<const std::uint8_t> request);
  /// The next bytes of the reply, of this number; over UDP out of its datagram.
  Result<void> receive(std::span<std::uint8_t> into);
  /// Nothing of the reply's datagram is left. A TCP connection has no such end.
  [[nodiscard]] bool is_taken() const noexcept;

  /// receive() found the end of the connection, or waited in vain.
  [[nodiscard]] bool is_silent() const noexcept { return silent_; }

  /// "127.0.0.1:5007: the answer is cut off"
  [[nodiscard]] std::string failed(std::string_view what) const;
  /// The error for data that is no reply to the request.
  [[nodiscard]] std::string not_a_reply() const;

 private:
  struct Parts;

  [[nodiscard]] std::string nobody_there(std::string_view error) const;
  [[nodiscard]] std::string no_answer() const;
  bool finish();

  PlcConnection connection_;
  bool silent_ = false;
  std::unique_ptr<Parts> parts_;
};

}  // namespace canopus::client
