#include "canopus/trace/file/capture_packet.hpp"

#include <algorithm>
#include <bit>

#include "canopus/trace/file/reader_base.hpp"

namespace canopus::trace {
namespace {

enum Protocol : std::uint16_t { cooked_can = 0x000C, cooked_can_fd = 0x000D, cooked_can_xl = 0x000E };
constexpr std::uint16_t packet_outgoing = 4;
constexpr std::uint8_t fd_frame_flag = 0x04;  // CANFD_FDF
constexpr std::uint8_t xl_frame_flag = 0x80;  // CANXL_XLF, where the others have their length

/// Whether these four bytes are a base identifier, perhaps with flags, in this order.
bool is_base_identifier(std::uint32_t identifier) {
  return (identifier & ~(remote_flag | error_flag)) <= can::max_base_identifier;
}

}  // namespace

std::expected<std::optional<LeftOutKind>, std::string> CapturePackets::read(std::uint32_t linktype,
                                                                            std::string_view packet,
                                                                            TraceRecord& record) {
  using enum std::endian;
  const std::size_t header = linktype == linktype_linux_sll ? 16 : linktype == linktype_linux_sll2 ? 20 : 0;
  if (packet.size() < header) {
    return std::unexpected("expected a cooked header of " + std::to_string(header) + " bytes, found " +
                           std::to_string(packet.size()));
  }
  if (header != 0) {
    const bool second = linktype == linktype_linux_sll2;
    const auto protocol = number_at<std::uint16_t>(packet, second ? 0 : 14, big);
    if (protocol == cooked_can_fd) return LeftOutKind::can_fd;
    if (protocol == cooked_can_xl) return LeftOutKind::can_xl;
    if (protocol != cooked_can) return LeftOutKind::other_bus;
    record.transmitted = second ? static_cast<std::uint8_t>(packet[10]) == packet_outgoing
                                : number_at<std::uint16_t>(packet, 0, big) == packet_outgoing;
    packet.remove_prefix(header);
  }
  if (packet.size() < 8) {
    return std::unexpected("expected a CAN frame of 8 to 16 bytes, found " + std::to_string(packet.size()));
  }
  if (header != 0) {
    const bool as_big = is_base_identifier(number_at<std::uint32_t>(packet, 0, big));
    const bool as_little = is_base_identifier(number_at<std::uint32_t>(packet, 0, little));
    if (as_big != as_little) cooked_order_ = as_big ? big : little;
  }
  const auto identifier = number_at<std::uint32_t>(packet, 0, header != 0 ? cooked_order_ : big);
  const auto length = static_cast<std::uint8_t>(packet[4]);
  const auto flags = static_cast<std::uint8_t>(packet[5]);
  const auto raw_dlc = static_cast<std::uint8_t>(packet[7]);
  if ((length & xl_frame_flag) != 0) return LeftOutKind::can_xl;
  if (length > 8 || (flags & fd_frame_flag) != 0) return LeftOutKind::can_fd;
  can::Frame& frame = record.frame;
  frame.dlc = length;
  if (length == 8 && raw_dlc > 8 && raw_dlc <= 15) frame.dlc = raw_dlc;  // len8_dlc of struct can_frame
  frame.remote = (identifier & remote_flag) != 0;
  if (packet.size() < 8 + frame.length()) {
    return std::unexpected("expected " + std::to_string(frame.length()) + " bytes of data, found " +
                           std::to_string(packet.size() - 8));
  }
  for (std::size_t i = 0; i < frame.data.size() && i < frame.length(); ++i) {
    frame.data[i] = static_cast<std::uint8_t>(packet[8 + i]);
  }
  if ((identifier & error_flag) != 0) {
    set_error_frame(record, identifier);
    return std::nullopt;
  }
  frame.extended = (identifier & extended_flag) != 0;
  frame.identifier = identifier & can::max_extended_identifier;
  if (!frame.extended && frame.identifier > can::max_base_identifier) {
    return std::unexpected("expected a base identifier up to 7FF, or the flag of an extended one");
  }
  return std::nullopt;
}

namespace {

constexpr std::uint32_t pcap_nanosecond_magic = 0xA1B2'3C4D;
constexpr std::uint32_t longest_packet = 65535;

/// The magic number of a capture defines its byte order: the host's.
template <typename T>
std::uint8_t* put_host(std::uint8_t* out, T value) noexcept {
  const auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
  return std::ranges::copy(bytes, out).out;
}

/// 8 to 16 octets.
std::uint8_t* put_frame(std::uint8_t* out, const TraceRecord& record) noexcept {
  const can::Frame& frame = record.frame;
  const std::uint32_t identifier = frame.identifier | (record.error_frame ? error_flag : 0U) |
                                   (frame.extended && !record.error_frame ? extended_flag : 0U) |
                                   (frame.remote ? remote_flag : 0U);
  for (const int shift : {24, 16, 8, 0}) *out++ = static_cast<std::uint8_t>(identifier >> shift);
  // A remote frame has no data, but the length that it requests.
  *out++ = static_cast<std::uint8_t>(std::min<unsigned>(frame.dlc, 8));
  *out++ = 0;
  *out++ = 0;
  *out++ = frame.dlc > 8 ? frame.dlc : std::uint8_t{0};  // len8_dlc of struct can_frame
  return std::ranges::copy(frame.bytes(), out).out;
}

std::uint64_t nanoseconds_of(const TraceRecord& record) noexcept {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, record.time.time_since_epoch().count()));
}

std::uint8_t* put_padding(std::uint8_t* out, std::size_t size) noexcept {
  return std::fill_n(out, (4 - size % 4) % 4, std::uint8_t{0});
}

/// Writes the length of the whole block at both of its ends.
std::size_t end_block(std::uint8_t* begin, std::uint8_t* end) noexcept {
  const auto size = static_cast<std::uint32_t>(end - begin + 4);
  (void)put_host(begin + 4, size);
  (void)put_host(end, size);
  return size;
}

}  // namespace

std::array<std::uint8_t, pcap_header_size> pcap_header() noexcept {
  std::array<std::uint8_t, pcap_header_size> header{};
  std::uint8_t* p = put_host(header.data(), pcap_nanosecond_magic);
  p = put_host<std::uint16_t>(p, 2);  // version 2.4
  p = put_host<std::uint16_t>(p, 4);
  p += 8;  // time zone and accuracy: always 0
  p = put_host(p, longest_packet);
  put_host(p, linktype_can_socketcan);
  return header;
}

std::size_t write_pcap_record(std::span<std::uint8_t> out, const TraceRecord& record) noexcept {
  const std::uint64_t nanoseconds = nanoseconds_of(record);
  const auto size = static_cast<std::uint32_t>(8U + record.frame.length());
  std::uint8_t* p = put_host(out.data(), static_cast<std::uint32_t>(nanoseconds / 1'000'000'000));
  p = put_host(p, static_cast<std::uint32_t>(nanoseconds % 1'000'000'000));
  p = put_host(p, size);
  p = put_host(p, size);
  return static_cast<std::size_t>(put_frame(p, record) - out.data());
}

std::array<std::uint8_t, pcapng_header_size> pcapng_header() noexcept {
  std::array<std::uint8_t, pcapng_header_size> header{};
  std::uint8_t* p = put_host<std::uint32_t>(header.data(), 0x0A0D'0D0A);
  p = put_host<std::uint32_t>(p + 4, 0x1A2B'3C4D);
  p = put_host<std::uint16_t>(p, 1);  // version 1.0
  p = put_host<std::uint16_t>(p, 0);
  p = put_host<std::uint64_t>(p, ~std::uint64_t{0});  // length of the section: unknown
  (void)end_block(header.data(), p);
  return header;
}

std::size_t write_pcapng_interface(std::span<std::uint8_t> out, std::string_view name) noexcept {
  name = name.substr(0, pcapng_max_name);
  std::uint8_t* p = put_host<std::uint32_t>(out.data(), 1);
  p = put_host<std::uint16_t>(p + 4, linktype_can_socketcan);
  p = put_host<std::uint16_t>(p, 0);
  p = put_host(p, longest_packet);
  p = put_host<std::uint16_t>(p, 2);  // if_name
  p = put_host(p, static_cast<std::uint16_t>(name.size()));
  p = std::ranges::transform(name, p, [](char c) { return static_cast<std::uint8_t>(c); }).out;
  p = put_padding(p, name.size());
  p = put_host<std::uint16_t>(p, 9);  // if_tsresol: 10^-9 s
  p = put_host<std::uint16_t>(p, 1);
  *p++ = 9;
  p = put_padding(p, 1);
  p = put_host<std::uint32_t>(p, 0);  // end of options
  return end_block(out.data(), p);
}

std::size_t write_pcapng_packet(std::span<std::uint8_t> out, std::uint32_t interface,
                                const TraceRecord& record) noexcept {
  const std::uint64_t nanoseconds = nanoseconds_of(record);
  const auto size = static_cast<std::uint32_t>(8U + record.frame.length());
  std::uint8_t* p = put_host<std::uint32_t>(out.data(), 6);
  p = put_host(p + 4, interface);
  p = put_host(p, static_cast<std::uint32_t>(nanoseconds >> 32));
  p = put_host(p, static_cast<std::uint32_t>(nanoseconds));
  p = put_host(p, size);
  p = put_host(p, size);
  p = put_padding(put_frame(p, record), size);
  if (record.transmitted) {
    p = put_host<std::uint16_t>(p, 2);  // epb_flags: outbound
    p = put_host<std::uint16_t>(p, 4);
    p = put_host<std::uint32_t>(p, 2);
    p = put_host<std::uint32_t>(p, 0);  // end of options
  }
  return end_block(out.data(), p);
}

}  // namespace canopus::trace
