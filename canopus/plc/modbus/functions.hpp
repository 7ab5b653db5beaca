#pragma once
// The functions of Modbus: a request's function code and data in, the reply's out. [Modbus Application Protocol
// V1.1b3 6]
//
//   1 2  read coils, discrete inputs      5 6  write one coil, one register      22  mask write register
//   3 4  read holding, input registers    15 16  write several                   23  write, then read registers
//   43/14  read device identification
//
// Everything else is exception 01. A request is judged as a whole before anything is written: one that is refused
// has changed nothing.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "canopus/can/time.hpp"
#include "canopus/plc/modbus/settings.hpp"
#include "canopus/plc/rack/rack.hpp"

namespace canopus::plc::modbus {

/// Function code and data, of a request or a reply.
inline constexpr std::size_t maximum_pdu = 253;
/// Numbers are big-endian.
[[nodiscard]] constexpr unsigned word_at(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return static_cast<unsigned>(bytes[at]) << 8U | bytes[at + 1];
}

class Functions {
 public:
  /// Both must outlive this.
  Functions(Rack& rack, const Settings& settings) noexcept : rack_(rack), settings_(settings) {}

  /// `pdu` has 1 to 253 bytes, and so has what is written into `reply`; returns its size.
  std::size_t execute(std::span<const std::uint8_t> pdu, std::span<std::uint8_t, maximum_pdu> reply,
                      WritePermission permission, can::Time now);

 private:
  struct Reply {
    std::span<std::uint8_t, maximum_pdu> bytes;
    std::size_t size = 0;
    void u8(unsigned value) { bytes[size++] = static_cast<std::uint8_t>(value); }
    void u16(unsigned value) {
      u8(value >> 8U);
      u8(value);
    }
  };
  using Request = std::span<const std::uint8_t>;

  Exception dispatch(Request pdu, Reply& reply, WritePermission permission, can::Time now);
  Exception read_bits(Table table, Request pdu, Reply& reply, can::Time now);
  Exception read_words(Table table, Request pdu, Reply& reply, can::Time now);
  Exception write_coil(Request pdu, Reply& reply, can::Time now);
  Exception write_register(Request pdu, Reply& reply, can::Time now);
  Exception write_coils(Request pdu, Reply& reply, can::Time now);
  Exception write_registers(Request pdu, Reply& reply, can::Time now);
  Exception mask_write(Request pdu, Reply& reply, can::Time now);
  Exception write_and_read(Request pdu, Reply& reply, can::Time now);
  Exception identify(Request pdu, Reply& reply) const;

  Rack& rack_;
  const Settings& settings_;
  std::array<std::uint8_t, 2000> bits_{};
  std::array<std::uint16_t, 125> words_{};
};

}  // namespace canopus::plc::modbus
