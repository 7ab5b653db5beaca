#include "canopus/client/plc_client.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/plc/melsec/frame_1e.hpp"
#include "canopus/plc/melsec/target.hpp"

namespace canopus::client {

using Frame = PlcConnection::Frame;

namespace {

std::size_t points_per_word(const PlcPoint& point) { return point.is_bit() ? 16 : 1; }

}  // namespace

PlcClient::PlcClient(std::unique_ptr<PlcLink> link, std::unique_ptr<PlcProtocol> protocol) noexcept
    : link_(std::move(link)), protocol_(std::move(protocol)) {}

PlcClient::Result<PlcClient> PlcClient::connect(const PlcConnection& connection) {
  auto link = std::make_unique<PlcLink>(connection);
  if (auto opened = link->open(); !opened) return std::unexpected(opened.error());
  std::unique_ptr<PlcProtocol> protocol;
  switch (connection.frame) {
    case Frame::frame_3e:
    case Frame::frame_4e: protocol = melsec_client(*link); break;
    case Frame::frame_1e: protocol = melsec_1e_client(*link); break;
    case Frame::modbus: protocol = modbus_client(*link); break;
  }
  if (!connection.remote_password.empty()) {
    if (auto unlocked = protocol->unlock(); !unlocked) return std::unexpected(unlocked.error());
  }
  return PlcClient(std::move(link), std::move(protocol));
}

PlcClient::Result<void> PlcClient::leave() {
  const PlcConnection& connection = link_->connection();
  if (!connection.udp || connection.remote_password.empty() || is_reset_) return {};
  return protocol_->lock();
}

PlcClient::Result<std::vector<std::uint16_t>> PlcClient::read_words(const PlcPoint& first,
                                                                    std::uint32_t count) {
  std::vector<std::uint16_t> words(count);
  for (std::size_t done = 0; done < count;) {
    const std::size_t part = std::min(protocol_->most_words(), count - done);
    const auto read = protocol_->read_words(first.further(done * points_per_word(first)),
                                            std::span(words).subspan(done, part));
    if (!read) return std::unexpected(read.error());
    done += part;
  }
  return words;
}

PlcClient::Result<void> PlcClient::write_words(const PlcPoint& first, std::span<const std::uint16_t> words) {
  for (std::size_t done = 0; done < words.size();) {
    const auto part = words.subspan(done, std::min(protocol_->most_words(), words.size() - done));
    const auto written = protocol_->write_words(first.further(done * points_per_word(first)), part);
    if (!written) return written;
    done += part.size();
  }
  return {};
}

PlcClient::Result<std::vector<std::uint8_t>> PlcClient::read_bits(const PlcPoint& first,
                                                                  std::uint32_t count) {
  std::vector<std::uint8_t> bits(count);
  for (std::size_t done = 0; done < count;) {
    const std::size_t part = std::min(protocol_->most_bits(), count - done);
    const auto read = protocol_->read_bits(first.further(done), std::span(bits).subspan(done, part));
    if (!read) return std::unexpected(read.error());
    done += part;
  }
  return bits;
}

PlcClient::Result<void> PlcClient::write_bits(const PlcPoint& first, std::span<const std::uint8_t> bits) {
  for (std::size_t done = 0; done < bits.size();) {
    const auto part = bits.subspan(done, std::min(protocol_->most_bits(), bits.size() - done));
    const auto written = protocol_->write_bits(first.further(done), part);
    if (!written) return written;
    done += part.size();
  }
  return {};
}

std::string why_not_reached(const PlcPoint& point, Frame frame, bool octal) {
  if (frame == Frame::modbus || point.at.is_buffer) return {};
  const std::string_view name = plc::device_info(point.at.device).name;
  if (frame == Frame::frame_1e) {
    if (octal && point.at.device == plc::Device::cn && point.at.number >= plc::melsec::first_wide_counter)
      return "the values of C200 to C255 of an FX have 32 bits, which one word cannot show";
    if (plc::melsec::device_code_1e(point.at.device)) return {};
    return fmt::format("1E frames cannot name {}; they know X Y M L F B S D W R, TS TC TN and CS CC CN",
                       name);
  }
  if (plc::melsec::device_code(point.at.device) != 0) return {};
  return fmt::format("the MC protocol cannot name {}, a device of an AS300 (--modbus)", name);
}

}  // namespace canopus::client
