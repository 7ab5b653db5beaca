#include "canopus/trace/file/capture_writer.hpp"

#include <algorithm>
#include <bit>

#include "canopus/trace/file/capture_packet.hpp"

namespace canopus::trace {
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
