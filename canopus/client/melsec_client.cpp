// The client's side of 3E and 4E frames.

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "canopus/client/melsec_reply.hpp"
#include "canopus/client/plc_protocol.hpp"
#include "canopus/plc/melsec/end_code.hpp"
#include "canopus/plc/melsec/field.hpp"
#include "canopus/plc/melsec/target.hpp"

namespace canopus::client {

namespace {

using plc::melsec::DataCode;
using plc::melsec::FieldReader;
using plc::melsec::FieldWriter;
using Frame = PlcConnection::Frame;

constexpr std::uint16_t batch_read = 0x0401;
constexpr std::uint16_t batch_write = 0x1401;
constexpr std::uint16_t extended = 0x0080;
constexpr std::uint16_t single_bits = 0x0001;
constexpr std::size_t request_capacity = 8192;

/// U\G and U3E0\HG go with the extended device specification alone.
bool is_extended(const plc::RackAddress& target) {
  return target.is_buffer || target.device == plc::Device::hg;
}

void write_target(FieldWriter& out, const plc::RackAddress& target, bool octal) {
  const bool ascii = out.code() == DataCode::ascii;
  const auto number_24 = [&out](std::uint32_t number) {
    out.u16(static_cast<std::uint16_t>(number));
    out.u8(static_cast<std::uint8_t>(number >> 16U));
  };
  if (is_extended(target)) {
    const unsigned unit = target.is_buffer ? target.head_address / 16U : plc::melsec::own_cpu;
    if (ascii) {
      out.text(fmt::format("00U{:03X}000{}{:06}000", unit, target.is_buffer ? "G*" : "HG", target.number));
    } else {
      out.u16(0);
      number_24(target.number);
      out.u8(target.is_buffer ? plc::melsec::buffer_memory_code : plc::melsec::device_code(target.device));
      out.u16(0);
      out.u16(static_cast<std::uint16_t>(unit));
      out.u8(target.is_buffer ? plc::melsec::module_access : plc::melsec::cpu_buffer);
    }
    return;
  }
  if (ascii) {
    const std::string_view code = plc::melsec::device_text(target.device, false);
    const bool is_io = target.device == plc::Device::x || target.device == plc::Device::y;
    const bool hexadecimal = plc::device_info(target.device).hexadecimal;
    out.text(octal && is_io ? fmt::format("{:*<2}{:06o}", code, target.number)
             : hexadecimal  ? fmt::format("{:*<2}{:06X}", code, target.number)
                            : fmt::format("{:*<2}{:06}", code, target.number));
  } else {
    number_24(target.number);
    out.u8(plc::melsec::device_code(target.device));
  }
}

class MelsecClient final : public PlcProtocol {
 public:
  explicit MelsecClient(PlcLink& link)
      : link_(link),
        code_(link.connection().ascii ? DataCode::ascii : DataCode::binary),
        frame_4e_(link.connection().frame == Frame::frame_4e),
        octal_(link.connection().octal) {}

  [[nodiscard]] std::size_t most_words() const noexcept override { return 960; }
  [[nodiscard]] std::size_t most_bits() const noexcept override { return 3584; }

  Result<void> read_words(const PlcPoint& first, std::span<std::uint16_t> words) override {
    auto data = request(batch_read, subcommand(first), [&](FieldWriter& out) {
      write_target(out, first.at, octal_);
      out.u16(static_cast<std::uint16_t>(words.size()));
    });
    if (!data) return std::unexpected(data.error());
    for (std::uint16_t& word : words) word = data->u16();
    return whole(*data, link_);
  }

  Result<void> write_words(const PlcPoint& first, std::span<const std::uint16_t> words) override {
    return completed(request(batch_write, subcommand(first), [&](FieldWriter& out) {
      write_target(out, first.at, octal_);
      out.u16(static_cast<std::uint16_t>(words.size()));
      for (const std::uint16_t word : words) out.u16(word);
    }));
  }

  Result<void> read_bits(const PlcPoint& first, std::span<std::uint8_t> bits) override {
    auto data = request(batch_read, single_bits, [&](FieldWriter& out) {
      write_target(out, first.at, octal_);
      out.u16(static_cast<std::uint16_t>(bits.size()));
    });
    if (!data) return std::unexpected(data.error());
    if (!data->bits(bits)) return std::unexpected(link_.not_a_reply());
    return whole(*data, link_);
  }

  Result<void> write_bits(const PlcPoint& first, std::span<const std::uint8_t> bits) override {
    return completed(request(batch_write, single_bits, [&](FieldWriter& out) {
      write_target(out, first.at, octal_);
      out.u16(static_cast<std::uint16_t>(bits.size()));
      out.bits(bits);
    }));
  }

  Result<void> operate(PlcOperation operation) override {
    constexpr std::uint16_t normal = 1;
    constexpr std::uint16_t forced = 3;
    switch (operation) {
      case PlcOperation::run:
        return completed(request(0x1001, 0, [](FieldWriter& out) {
          out.u16(forced);
          out.u8(0);  // nothing is cleared
          out.u8(0);
        }));
      case PlcOperation::stop:
        return completed(request(0x1002, 0, [](FieldWriter& out) { out.u16(normal); }));
      case PlcOperation::reset: {
        const auto reply = completed(request(0x1006, 0, [](FieldWriter& out) { out.u16(normal); }));
        if (!reply && link_.is_silent()) return {};
        return reply;
      }
      case PlcOperation::pause: break;
    }
    return completed(request(0x1003, 0, [](FieldWriter& out) { out.u16(forced); }));
  }

  Result<PlcType> read_type() override {
    constexpr std::size_t name_size = 16;
    auto data = request(0x0101, 0, [](FieldWriter& /*out*/) {});
    if (!data) return std::unexpected(data.error());
    PlcType type;
    for (const std::uint8_t character : data->raw(name_size)) type.name += static_cast<char>(character);
    type.code = data->u16();
    if (auto complete = whole(*data, link_); !complete) return std::unexpected(complete.error());
    type.name.erase(type.name.find_last_not_of(' ') + 1);
    return type;
  }

  Result<void> unlock() override { return send_password(0x1630); }
  Result<void> lock() override { return send_password(0x1631); }

 private:
  static std::uint16_t subcommand(const PlcPoint& point) { return is_extended(point.at) ? extended : 0; }

  Result<void> send_password(std::uint16_t command) {
    const std::string& password = link_.connection().remote_password;
    return completed(request(command, 0, [&](FieldWriter& out) {
      out.u16(static_cast<std::uint16_t>(password.size()));
      out.text(password);
    }));
  }

  /// Sends a request with the data of `write`; returns the reply's data.
  template <typename Write>
  Result<FieldReader> request(std::uint16_t command, std::uint16_t subcommand, Write write) {
    constexpr std::uint16_t no_time_limit = 0;
    FieldWriter out{std::span{buffer_}, code_};
    const bool ascii = code_ == DataCode::ascii;
    if (frame_4e_) {
      out.text(ascii ? std::string_view("5400") : std::string_view("\x54\0", 2));
      out.u16(++serial_);
      out.u16(0);
    } else {
      out.text(ascii ? std::string_view("5000") : std::string_view("\x50\0", 2));
    }
    out.u8(0);
    out.u8(0xFF);
    out.u16(link_.connection().module_io);
    out.u8(0);
    const std::size_t length_at = out.size();
    out.u16(0);
    const std::size_t begin = out.size();
    out.u16(no_time_limit);
    out.u16(command);
    out.u16(subcommand);
    write(out);
    const std::size_t size = out.size();
    out.rewind(length_at);
    out.u16(static_cast<std::uint16_t>(size - begin));
    if (auto sent = link_.send(std::span{buffer_}.first(size)); !sent) return std::unexpected(sent.error());
    return reply();
  }

  Result<FieldReader> reply() {
    const std::size_t scale = code_ == DataCode::ascii ? 2 : 1;
    const auto header = std::span{buffer_}.first(scale * (frame_4e_ ? 13 : 9));
    if (auto received = link_.receive(header); !received) return std::unexpected(received.error());
    FieldReader reader{header, code_};
    const std::uint16_t type = frame_4e_ ? 0xD4 : 0xD0;
    // The subheader's two bytes are in this order in both codes.
    if (reader.u8() != type || reader.u8() != 0) return std::unexpected(link_.not_a_reply());
    if (frame_4e_) {
      if (reader.u16() != serial_) return std::unexpected(link_.failed("the answer is for another request"));
      (void)reader.u16();
    }
    (void)reader.u32();  // network, PC, module I/O
    (void)reader.u8();   // station
    const std::size_t length = reader.u16();
    if (reader.fault() != FieldReader::Fault::none || length < 2 * scale || length > buffer_.size())
      return std::unexpected(link_.not_a_reply());
    const auto body = std::span{buffer_}.first(length);
    if (auto received = link_.receive(body); !received) return std::unexpected(received.error());
    if (!link_.is_taken()) return std::unexpected(link_.not_a_reply());
    FieldReader data{body, code_};
    if (const std::uint16_t end_code = data.u16(); end_code != 0) {
      return std::unexpected(
          fmt::format("the PLC answers {:04X}H: {}", end_code, plc::melsec::end_code_text(end_code)));
    }
    return data;
  }

  PlcLink& link_;
  DataCode code_;
  bool frame_4e_;
  bool octal_;
  std::uint16_t serial_ = 0;
  std::array<std::uint8_t, request_capacity> buffer_{};
};

}  // namespace

std::unique_ptr<PlcProtocol> melsec_client(PlcLink& link) { return std::make_unique<MelsecClient>(link); }

}  // namespace canopus::client
