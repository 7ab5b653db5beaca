#include "canopus/client/plc_client.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "canopus/plc/melsec/end_code.hpp"
#include "canopus/text/text_values.hpp"

namespace canopus::client {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using plc::melsec::DataCode;
using plc::melsec::FieldReader;
using plc::melsec::FieldWriter;
using plc::melsec::Target;

namespace {

constexpr std::uint16_t batch_read = 0x0401;
constexpr std::uint16_t batch_write = 0x1401;
constexpr std::uint16_t extended = 0x0080;
constexpr std::uint16_t single_bits = 0x0001;
constexpr std::size_t words_per_request = 960;
constexpr std::size_t bits_per_request = 3584;
constexpr std::size_t request_capacity = 8192;
constexpr std::string_view broken_reply = "the answer is no reply of the MELSEC protocol";

void write_target(FieldWriter& out, const Target& target) {
  const bool ascii = out.code() == DataCode::ascii;
  const auto number_24 = [&out](std::uint32_t number) {
    out.u16(static_cast<std::uint16_t>(number));
    out.u8(static_cast<std::uint8_t>(number >> 16U));
  };
  if (target.is_buffer) {
    const unsigned unit = target.head_address / 16U;
    if (ascii) {
      out.text(fmt::format("00U{:03X}000G*{:06}000", unit, target.number));
    } else {
      out.u16(0);
      number_24(target.number);
      out.u8(plc::melsec::buffer_memory_code);
      out.u16(0);
      out.u16(static_cast<std::uint16_t>(unit));
      out.u8(plc::melsec::module_access);
    }
    return;
  }
  if (ascii) {
    const std::string_view code = plc::melsec::device_text(target.device, false);
    const bool hexadecimal = plc::device_info(target.device).hexadecimal;
    out.text(hexadecimal ? fmt::format("{:*<2}{:06X}", code, target.number)
                         : fmt::format("{:*<2}{:06}", code, target.number));
  } else {
    number_24(target.number);
    out.u8(plc::melsec::device_code(target.device));
  }
}

Target further(Target target, std::size_t points) {
  target.number += static_cast<std::uint32_t>(points);
  return target;
}

}  // namespace

struct PlcClient::Parts {
  explicit Parts(const PlcConnection& the_connection)
      : connection(the_connection),
        code(the_connection.ascii ? DataCode::ascii : DataCode::binary),
        socket(context) {}

  [[nodiscard]] std::string failed(std::string_view what) const {
    return fmt::format("{}:{}: {}", connection.host, connection.port, what);
  }

  [[nodiscard]] std::string within() const {
    return " within " + text::describe_duration(connection.timeout);
  }

  /// Runs the operation that was started, at most for the time-out.
  bool finish() {
    context.restart();
    context.run_for(connection.timeout);
    if (context.stopped()) return true;
    error_code ignored;
    socket.close(ignored);
    context.run();
    return false;
  }

  Result<void> open();
  Result<void> receive(std::span<std::uint8_t> into);
  /// Sends a request whose data `write` writes; gives the reply's data.
  template <typename Write>
  Result<FieldReader> request(std::uint16_t command, std::uint16_t subcommand, Write write);
  Result<FieldReader> reply();

  PlcConnection connection;
  DataCode code;
  asio::io_context context;
  tcp::socket socket;
  std::uint16_t serial = 0;
  std::array<std::uint8_t, request_capacity> buffer{};
};

PlcClient::Result<void> PlcClient::Parts::open() {
  error_code error;
  tcp::resolver resolver(context);
  const auto found = resolver.resolve(connection.host, std::to_string(connection.port), error);
  if (error) return std::unexpected(failed(error.message()));
  error = asio::error::would_block;
  asio::async_connect(socket, found,
                      [&error](error_code result, const tcp::endpoint& /*endpoint*/) { error = result; });
  if (!finish()) return std::unexpected(failed("no connection" + within()));
  if (error == asio::error::connection_refused) {
    return std::unexpected(failed(
        error.message() +
        ". Is `canopus run` running, without --virtual? Its plant file says where the PLC listens: listen = "
        "\"127.0.0.1:5007\". A real CPU needs an open setting for the MC protocol, TCP"));
  }
  if (error) return std::unexpected(failed(error.message()));
  socket.set_option(tcp::no_delay(true), error);
  return {};
}

PlcClient::Result<void> PlcClient::Parts::receive(std::span<std::uint8_t> into) {
  error_code error = asio::error::would_block;
  asio::async_read(socket, asio::buffer(into.data(), into.size()),
                   [&error](error_code result, std::size_t /*count*/) { error = result; });
  if (!finish()) return std::unexpected(failed("no answer" + within()));
  if (error == asio::error::eof) return std::unexpected(failed("the PLC closed the connection"));
  if (error) return std::unexpected(failed(error.message()));
  return {};
}

template <typename Write>
PlcClient::Result<FieldReader> PlcClient::Parts::request(std::uint16_t command, std::uint16_t subcommand,
                                                         Write write) {
  constexpr std::uint16_t no_time_limit = 0;
  FieldWriter out{std::span{buffer}, code};
  const bool ascii = connection.ascii;
  if (connection.frame_4e) {
    out.text(ascii ? std::string_view("5400") : std::string_view("\x54\0", 2));
    out.u16(++serial);
    out.u16(0);
  } else {
    out.text(ascii ? std::string_view("5000") : std::string_view("\x50\0", 2));
  }
  out.u8(0);
  out.u8(0xFF);
  out.u16(0x03FF);
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

  error_code error;
  asio::write(socket, asio::buffer(buffer.data(), size), error);
  if (error) return std::unexpected(failed(error.message()));
  return reply();
}

PlcClient::Result<FieldReader> PlcClient::Parts::reply() {
  const std::size_t scale = connection.ascii ? 2 : 1;
  const std::size_t header_size = scale * (connection.frame_4e ? 13 : 9);
  const auto header = std::span{buffer}.first(header_size);
  if (auto received = receive(header); !received) return std::unexpected(received.error());
  FieldReader reader{header, code};
  const std::uint16_t type = connection.frame_4e ? 0xD4 : 0xD0;
  // The subheader's two bytes are in this order in both codes.
  if (reader.u8() != type || reader.u8() != 0) return std::unexpected(failed(broken_reply));
  if (connection.frame_4e) {
    if (reader.u16() != serial) return std::unexpected(failed("the answer is for another request"));
    (void)reader.u16();
  }
  (void)reader.u32();  // network, PC, module I/O
  (void)reader.u8();   // station
  const std::size_t length = reader.u16();
  if (reader.fault() != FieldReader::Fault::none || length < 2 * scale || length > buffer.size())
    return std::unexpected(failed(broken_reply));
  const auto body = std::span{buffer}.first(length);
  if (auto received = receive(body); !received) return std::unexpected(received.error());
  FieldReader data{body, code};
  if (const std::uint16_t end_code = data.u16(); end_code != 0)
    return std::unexpected(
        fmt::format("the PLC answers {:04X}H: {}", end_code, plc::melsec::end_code_text(end_code)));
  return data;
}

PlcClient::PlcClient(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
PlcClient::PlcClient(PlcClient&&) noexcept = default;
PlcClient& PlcClient::operator=(PlcClient&&) noexcept = default;
PlcClient::~PlcClient() = default;

PlcClient::Result<PlcClient> PlcClient::connect(const PlcConnection& connection) {
  auto parts = std::make_unique<Parts>(connection);
  if (auto opened = parts->open(); !opened) return std::unexpected(opened.error());
  return PlcClient(std::move(parts));
}

PlcClient::Result<std::vector<std::uint16_t>> PlcClient::read_words(const Target& target,
                                                                    std::uint32_t count) {
  std::vector<std::uint16_t> words;
  const std::size_t points_per_word = !target.is_buffer && plc::device_info(target.device).is_bit ? 16 : 1;
  while (words.size() < count) {
    const auto part = std::min<std::size_t>(words_per_request, count - words.size());
    auto data =
        parts_->request(batch_read, target.is_buffer ? extended : std::uint16_t{0}, [&](FieldWriter& out) {
          write_target(out, further(target, words.size() * points_per_word));
          out.u16(static_cast<std::uint16_t>(part));
        });
    if (!data) return std::unexpected(data.error());
    for (std::size_t i = 0; i < part; ++i) words.push_back(data->u16());
    if (data->fault() != FieldReader::Fault::none) return std::unexpected(parts_->failed(broken_reply));
  }
  return words;
}

PlcClient::Result<void> PlcClient::write_words(const Target& target, std::span<const std::uint16_t> words) {
  const std::size_t points_per_word = !target.is_buffer && plc::device_info(target.device).is_bit ? 16 : 1;
  for (std::size_t done = 0; done < words.size();) {
    const auto part = words.subspan(done, std::min(words_per_request, words.size() - done));
    auto data =
        parts_->request(batch_write, target.is_buffer ? extended : std::uint16_t{0}, [&](FieldWriter& out) {
          write_target(out, further(target, done * points_per_word));
          out.u16(static_cast<std::uint16_t>(part.size()));
          for (const std::uint16_t word : part) out.u16(word);
        });
    if (!data) return std::unexpected(data.error());
    done += part.size();
  }
  return {};
}

PlcClient::Result<std::vector<std::uint8_t>> PlcClient::read_bits(const Target& target, std::uint32_t count) {
  std::vector<std::uint8_t> bits;
  while (bits.size() < count) {
    const auto part = std::min<std::size_t>(bits_per_request, count - bits.size());
    auto data = parts_->request(batch_read, single_bits, [&](FieldWriter& out) {
      write_target(out, further(target, bits.size()));
      out.u16(static_cast<std::uint16_t>(part));
    });
    if (!data) return std::unexpected(data.error());
    const std::size_t from = bits.size();
    bits.resize(from + part);
    if (!data->bits(std::span{bits}.subspan(from)) || data->fault() != FieldReader::Fault::none)
      return std::unexpected(parts_->failed(broken_reply));
  }
  return bits;
}

PlcClient::Result<void> PlcClient::write_bits(const Target& target, std::span<const std::uint8_t> bits) {
  for (std::size_t done = 0; done < bits.size();) {
    const auto part = bits.subspan(done, std::min(bits_per_request, bits.size() - done));
    auto data = parts_->request(batch_write, single_bits, [&](FieldWriter& out) {
      write_target(out, further(target, done));
      out.u16(static_cast<std::uint16_t>(part.size()));
      out.bits(part);
    });
    if (!data) return std::unexpected(data.error());
    done += part.size();
  }
  return {};
}

PlcClient::Result<void> PlcClient::remote_run() {
  auto data = parts_->request(0x1001, 0, [](FieldWriter& out) {
    out.u16(3);  // forced
    out.u8(0);   // nothing is cleared
    out.u8(0);
  });
  if (!data) return std::unexpected(data.error());
  return {};
}

PlcClient::Result<void> PlcClient::remote_stop() {
  auto data = parts_->request(0x1002, 0, [](FieldWriter& out) { out.u16(1); });
  if (!data) return std::unexpected(data.error());
  return {};
}

PlcClient::Result<void> PlcClient::remote_pause() {
  auto data = parts_->request(0x1003, 0, [](FieldWriter& out) { out.u16(3); });
  if (!data) return std::unexpected(data.error());
  return {};
}

PlcClient::Result<PlcClient::Type> PlcClient::read_type() {
  constexpr std::size_t name_size = 16;
  auto data = parts_->request(0x0101, 0, [](FieldWriter& /*out*/) {});
  if (!data) return std::unexpected(data.error());
  Type type;
  for (const std::uint8_t character : data->raw(name_size)) type.name += static_cast<char>(character);
  type.code = data->u16();
  if (data->fault() != FieldReader::Fault::none) return std::unexpected(parts_->failed(broken_reply));
  type.name.erase(type.name.find_last_not_of(' ') + 1);
  return type;
}

}  // namespace canopus::client
