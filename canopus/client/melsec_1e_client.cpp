// The client's side of 1E frames. The points of a request are those that an FX3 takes, too.

#include <array>
#include <string_view>

#include <fmt/format.h>

#include "canopus/client/melsec_reply.hpp"
#include "canopus/client/plc_protocol.hpp"
#include "canopus/plc/melsec/end_code.hpp"
#include "canopus/plc/melsec/field.hpp"
#include "canopus/plc/melsec/frame_1e.hpp"

namespace canopus::client {

namespace {

using plc::melsec::Command1e;
using plc::melsec::DataCode;
using plc::melsec::EndCode1e;
using plc::melsec::FieldReader;
using plc::melsec::FieldWriter;

class Melsec1eClient final : public PlcProtocol {
 public:
  explicit Melsec1eClient(PlcLink& link)
      : link_(link), code_(link.connection().ascii ? DataCode::ascii : DataCode::binary) {}

  [[nodiscard]] std::size_t most_words() const noexcept override { return 64; }
  [[nodiscard]] std::size_t most_bits() const noexcept override { return 160; }

  Result<void> read_words(const PlcPoint& first, std::span<std::uint16_t> words) override {
    const auto command = first.at.is_buffer ? Command1e::read_buffer : Command1e::read_words;
    auto data = request(command, 2 * words.size(), [&](FieldWriter& out) {
      if (first.at.is_buffer) return write_buffer(out, first.at, words.size());
      write_device(out, first.at, words.size());
    });
    if (!data) return std::unexpected(data.error());
    for (std::uint16_t& word : words) word = first.at.is_buffer ? low_byte_first(*data) : data->u16();
    return whole(*data, link_);
  }

  Result<void> write_words(const PlcPoint& first, std::span<const std::uint16_t> words) override {
    const auto command = first.at.is_buffer ? Command1e::write_buffer : Command1e::write_words;
    return completed(request(command, 0, [&](FieldWriter& out) {
      if (!first.at.is_buffer) {
        write_device(out, first.at, words.size());
        for (const std::uint16_t word : words) out.u16(word);
        return;
      }
      write_buffer(out, first.at, words.size());
      for (const std::uint16_t word : words) {
        out.u8(static_cast<std::uint8_t>(word));
        out.u8(static_cast<std::uint8_t>(word >> 8U));
      }
    }));
  }

  Result<void> read_bits(const PlcPoint& first, std::span<std::uint8_t> bits) override {
    auto data = request(Command1e::read_bits, (bits.size() + 1) / 2,
                        [&](FieldWriter& out) { write_device(out, first.at, bits.size()); });
    if (!data) return std::unexpected(data.error());
    if (!data->bits(bits)) return std::unexpected(link_.not_a_reply());
    return whole(*data, link_);
  }

  Result<void> write_bits(const PlcPoint& first, std::span<const std::uint8_t> bits) override {
    return completed(request(Command1e::write_bits, 0, [&](FieldWriter& out) {
      write_device(out, first.at, bits.size());
      out.bits(bits);
      if (code_ == DataCode::ascii && bits.size() % 2 != 0) out.text("0");  // the other half of a byte
    }));
  }

  Result<void> operate(PlcOperation operation) override {
    if (operation == PlcOperation::pause || operation == PlcOperation::reset)
      return std::unexpected(std::string("1E frames have no remote PAUSE and reset; 3E frames do"));
    const auto command = operation == PlcOperation::run ? Command1e::remote_run : Command1e::remote_stop;
    return completed(request(command, 0, [](FieldWriter& /*out*/) {}));
  }

  Result<PlcType> read_type() override {
    auto data = request(Command1e::read_model, 2, [](FieldWriter& /*out*/) {});
    if (!data) return std::unexpected(data.error());
    PlcType type;
    type.code = low_byte_first(*data);
    type.name = "unknown CPU";
    for (const std::string_view name : plc::cpu_model_names())
      if (const auto* model = plc::cpu_model_named(name); model->code == type.code && type.code != 0)
        type.name = name;
    if (auto complete = whole(*data, link_); !complete) return std::unexpected(complete.error());
    return type;
  }

 private:
  static void write_device(FieldWriter& out, const plc::RackAddress& at, std::size_t points) {
    const std::uint16_t name = plc::melsec::device_code_1e(at.device).value_or(0);
    if (out.code() == DataCode::ascii) {  // the name first
      out.u16(name);
      out.u32(at.number);
    } else {
      out.u32(at.number);
      out.u16(name);
    }
    out.u8(static_cast<std::uint8_t>(points));
    out.u8(0);
  }
  static void write_buffer(FieldWriter& out, const plc::RackAddress& at, std::size_t words) {
    const std::uint32_t start = 2 * at.number;
    if (out.code() == DataCode::ascii) {
      out.u8(static_cast<std::uint8_t>(start >> 16U));
      out.u16(static_cast<std::uint16_t>(start));
    } else {
      out.u16(static_cast<std::uint16_t>(start));
      out.u8(static_cast<std::uint8_t>(start >> 16U));
    }
    out.u8(static_cast<std::uint8_t>(2 * words));
    out.u8(static_cast<std::uint8_t>(at.head_address / 16));
    out.u8(0);
  }
  /// The bytes of buffer memory and of a CPU's code are in this order in both data codes.
  static std::uint16_t low_byte_first(FieldReader& data) {
    const unsigned low = data.u8();
    return static_cast<std::uint16_t>(low | static_cast<unsigned>(data.u8()) << 8U);
  }

  /// `bytes`: of the reply's data, in ASCII two characters each. 1E frames have no length.
  template <typename Write>
  Result<FieldReader> request(Command1e command, std::size_t bytes, Write write) {
    constexpr std::uint16_t no_time_limit = 0;
    FieldWriter out{std::span{buffer_}, code_};
    out.u8(static_cast<std::uint8_t>(command));
    out.u8(0xFF);
    out.u16(no_time_limit);
    write(out);
    if (auto sent = link_.send(std::span{buffer_}.first(out.size())); !sent)
      return std::unexpected(sent.error());

    const std::size_t scale = code_ == DataCode::ascii ? 2 : 1;
    auto header = receive(2 * scale);
    if (!header) return std::unexpected(header.error());
    const bool is_reply = header->u8() == (static_cast<unsigned>(command) | 0x80U);
    const std::uint8_t end_code = header->u8();
    if (!is_reply || header->fault() != FieldReader::Fault::none) return std::unexpected(link_.not_a_reply());
    if (end_code == 0) {
      auto data = receive(scale * bytes);
      if (data && !link_.is_taken()) return std::unexpected(link_.not_a_reply());
      return data;
    }
    std::uint8_t abnormal_code = 0;
    if (end_code == static_cast<std::uint8_t>(EndCode1e::cpu_refuses)) {
      auto more = receive(2 * scale);
      if (!more) return std::unexpected(more.error());
      abnormal_code = more->u8();
    }
    return std::unexpected("the PLC answers " + plc::melsec::describe_end_code_1e(end_code, abnormal_code));
  }

  Result<FieldReader> receive(std::size_t size) {
    const auto into = std::span{buffer_}.first(size);
    if (size != 0) {
      if (auto received = link_.receive(into); !received) return std::unexpected(received.error());
    }
    return FieldReader{into, code_};
  }

  PlcLink& link_;
  DataCode code_;
  std::array<std::uint8_t, 1024> buffer_{};
};

}  // namespace

std::unique_ptr<PlcProtocol> melsec_1e_client(PlcLink& link) {
  return std::make_unique<Melsec1eClient>(link);
}

}  // namespace canopus::client
