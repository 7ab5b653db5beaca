#pragma once
// Settings of a Modbus server besides its map: functions, points per request, device identification.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "canopus/plc/modbus/map.hpp"
#include "canopus/plc/rack/write_permission.hpp"

namespace canopus::plc::modbus {

/// Points per request, and the functions that not every server has. The defaults are the protocol's own.
struct Limits {
  std::uint16_t read_bits = 2000;
  std::uint16_t write_bits = 1968;
  std::uint16_t read_words = 125;
  std::uint16_t write_words = 123;
  std::uint16_t read_words_of_23 = 125;
  std::uint16_t write_words_of_23 = 121;
  bool mask_write = true;      ///< function 22
  bool identification = true;  ///< function 43/14
};

/// The objects of function 43/14, 00H to 06H; empty: the server does not have it. [Modbus V1.1b3 6.21]
struct Identification {
  static constexpr std::size_t object_count = 7;
  static constexpr std::size_t basic_count = 3;  ///< those that every server has
  /// Vendor name, product code, revision; vendor URL, product name, model name, user application name.
  std::array<std::string, object_count> objects{};
};

/// What is around function code and data on a TCP connection.
enum class Framing : std::uint8_t {
  mbap,  ///< the header of Modbus TCP
  rtu    ///< unit and CRC, as on a serial line: what converters and some clients send over TCP
};

/// The settings of a port.
struct Settings {
  Map map{};
  Limits limits{};
  Identification identification{};
  WritePermission write = WritePermission::always;
  Framing framing = Framing::mbap;
  /// The unit identifier it answers to, besides 0 and 255, which address the server of the port itself. None:
  /// any.
  std::optional<std::uint8_t> unit{};
};

}  // namespace canopus::plc::modbus
