// The client's side of Modbus TCP, for an AS300 by its devices and for any server by its addresses.

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "canopus/client/plc_protocol.hpp"
#include "canopus/plc/modbus/as300_map.hpp"

namespace canopus::client {

namespace {

using PointKind = PlcPoint::Kind;
using plc::Device;

std::string_view exception_text(unsigned code) {
  switch (code) {
    case 1: return "this function is not there, or writing is not allowed";
    case 2: return "no such address, or it cannot be written";
    case 3: return "a number of points or a value out of range";
    case 4: return "failure of the device";
    case 6: return "busy";
    case 0x0A: return "the gateway has no path to this unit";
    case 0x0B: return "no device has this unit identifier";
    default: return "unknown exception";
  }
}

class ModbusClient final : public PlcProtocol {
 public:
  explicit ModbusClient(PlcLink& link) : link_(link) {}

  // The limit of an AS300; other servers accept more.
  [[nodiscard]] std::size_t most_words() const noexcept override { return 100; }
  [[nodiscard]] std::size_t most_bits() const noexcept override { return 1600; }

  Result<void> read_words(const PlcPoint& first, std::span<std::uint16_t> words) override {
    const auto address = address_of(first, words.size());
    if (!address) return std::unexpected(address.error());
    const std::uint8_t function = first.kind == PointKind::input_registers ? 4 : 3;
    begin(function);
    u16(*address);
    u16(words.size());
    const auto data = request(2 * words.size());
    if (!data) return std::unexpected(data.error());
    for (std::size_t i = 0; i < words.size(); ++i)
      words[i] = static_cast<std::uint16_t>(unsigned{(*data)[2 * i]} << 8U | (*data)[2 * i + 1]);
    return {};
  }

  Result<void> write_words(const PlcPoint& first, std::span<const std::uint16_t> words) override {
    const auto address = address_of(first, words.size());
    if (!address) return std::unexpected(address.error());
    if (first.kind == PointKind::input_registers) return std::unexpected(only_read(first));
    begin(16);
    u16(*address);
    u16(words.size());
    u8(2 * words.size());
    for (const std::uint16_t word : words) u16(word);
    return written();
  }

  Result<void> read_bits(const PlcPoint& first, std::span<std::uint8_t> bits) override {
    const auto address = address_of(first, bits.size());
    if (!address) return std::unexpected(address.error());
    const bool is_input = first.kind == PointKind::discrete_inputs ||
                          (first.kind == PointKind::rack && first.at.device == Device::x);
    begin(is_input ? 2 : 1);
    u16(*address);
    u16(bits.size());
    const auto data = request((bits.size() + 7) / 8);
    if (!data) return std::unexpected(data.error());
    for (std::size_t i = 0; i < bits.size(); ++i)
      bits[i] = static_cast<std::uint8_t>((*data)[i / 8] >> (i % 8) & 1U);
    return {};
  }

  Result<void> write_bits(const PlcPoint& first, std::span<const std::uint8_t> bits) override {
    const auto address = address_of(first, bits.size());
    if (!address) return std::unexpected(address.error());
    if (first.kind == PointKind::discrete_inputs) return std::unexpected(only_read(first));
    begin(15);
    u16(*address);
    u16(bits.size());
    u8((bits.size() + 7) / 8);
    for (std::size_t i = 0; i < bits.size(); i += 8) {
      unsigned byte = 0;
      for (std::size_t bit = 0; bit < 8 && i + bit < bits.size(); ++bit)
        byte |= (bits[i + bit] != 0 ? 1U : 0U) << bit;
      u8(byte);
    }
    return written();
  }

  Result<void> operate(PlcOperation /*operation*/) override {
    return std::unexpected(std::string("Modbus TCP has no remote operation of a CPU"));
  }

  /// By device identification; an AS300 does not have it.
  Result<PlcType> read_type() override {
    begin(43);
    u8(0x0E);
    u8(1);
    u8(0);
    const auto reply = exchange();
    if (!reply) return std::unexpected(reply.error());
    // MEI type, code, conformity, more follows, next object, number; then each object: number, length, text.
    std::string name;
    for (std::size_t at = 6; at + 2 <= reply->size();) {
      const std::size_t length = std::min<std::size_t>((*reply)[at + 1], reply->size() - at - 2);
      if (!name.empty()) name += ' ';
      for (const std::uint8_t character : reply->subspan(at + 2, length))
        if (character >= 0x20 && character < 0x7F) name += static_cast<char>(character);
      at += 2 + length;
    }
    return PlcType{name, 0};
  }

 private:
  [[nodiscard]] static std::string only_read(const PlcPoint& point) {
    return to_text(point, 0, PlcNotation::modbus) + " can only be read";
  }

  /// Of `count` points from the first one on.
  static Result<std::uint16_t> address_of(const PlcPoint& first, std::size_t count) {
    const bool is_named = first.kind == PointKind::rack || first.kind == PointKind::words_of_bits;
    const bool words = !first.is_bit();
    const auto address = [&](std::uint32_t number) -> std::optional<std::uint32_t> {
      if (is_named) return plc::modbus::as300_address(first.at.device, words, number);
      return number <= 0xFFFF ? std::optional(number) : std::nullopt;
    };
    const auto last = static_cast<std::uint32_t>(first.at.number + count - 1);
    const auto found = address(first.at.number);
    if (!found || !address(last)) {
      return std::unexpected(fmt::format("{} is beyond the last one{}",
                                         to_text(first, last - first.at.number, PlcNotation::modbus),
                                         is_named ? " of an AS300" : ""));
    }
    return static_cast<std::uint16_t>(*found);
  }

  void u8(std::size_t value) { request_[size_++] = static_cast<std::uint8_t>(value); }
  void u16(std::size_t value) {
    u8(value >> 8U);
    u8(value & 0xFFU);
  }
  void begin(std::uint8_t function) {
    size_ = 0;
    u16(++transaction_);
    u16(0);  // protocol
    u16(0);  // length, when it is known
    u8(link_.connection().unit);
    u8(function);
  }

  /// Sends the request; gives what is behind the reply's function code.
  Result<std::span<const std::uint8_t>> exchange() {
    constexpr std::size_t header_size = 6;
    constexpr std::size_t longest = 254;
    request_[4] = static_cast<std::uint8_t>((size_ - header_size) >> 8U);
    request_[5] = static_cast<std::uint8_t>(size_ - header_size);
    const std::span<const std::uint8_t> request(request_.data(), size_);
    if (auto sent = link_.send(request); !sent) return std::unexpected(sent.error());
    const auto header = std::span(reply_).first(header_size);
    if (auto received = link_.receive(header); !received) return std::unexpected(received.error());
    const std::size_t length = static_cast<std::size_t>(header[4]) << 8U | header[5];
    if (!std::ranges::equal(header.first(4), request.first(4)) || length < 3 || length > longest)
      return std::unexpected(link_.not_a_reply());
    const auto body = std::span(reply_).first(length);
    if (auto received = link_.receive(body); !received) return std::unexpected(received.error());
    const std::uint8_t function = request[7];
    if (body[0] != request[6] || (body[1] & 0x7FU) != function) return std::unexpected(link_.not_a_reply());
    if (body[1] != function) {
      return std::unexpected(
          fmt::format("the PLC answers exception {:02X}H: {}", body[2], exception_text(body[2])));
    }
    return body.subspan(2);
  }

  /// The data of a reply that counts its bytes.
  Result<std::span<const std::uint8_t>> request(std::size_t bytes) {
    const auto reply = exchange();
    if (!reply) return reply;
    if ((*reply)[0] != bytes || reply->size() != bytes + 1) return std::unexpected(link_.not_a_reply());
    return reply->subspan(1);
  }

  /// The reply to a write repeats its first address and number of points.
  Result<void> written() {
    const auto reply = exchange();
    if (!reply) return std::unexpected(reply.error());
    if (!std::ranges::equal(*reply, std::span(request_).subspan(8, 4)))
      return std::unexpected(link_.not_a_reply());
    return {};
  }

  PlcLink& link_;
  std::uint16_t transaction_ = 0;
  std::array<std::uint8_t, 260> request_{};
  std::size_t size_ = 0;
  std::array<std::uint8_t, 260> reply_{};
};

}  // namespace

std::unique_ptr<PlcProtocol> modbus_client(PlcLink& link) { return std::make_unique<ModbusClient>(link); }

}  // namespace canopus::client
