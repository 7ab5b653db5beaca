#pragma once
// Records as pcap and pcapng hold them: link type 227 (CAN over SocketCAN), nanoseconds, host byte order
// [tcpdump.org: LINKTYPE_CAN_SOCKETCAN, pcap-savefile; draft-ietf-opsawg-pcapng].

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/trace/file/trace_record.hpp"

namespace canopus::trace {

/// Octets of the header of a pcap file, and of one record in it at most.
inline constexpr std::size_t pcap_header_size = 24;
inline constexpr std::size_t pcap_max_record = 16 + 16;
/// Octets of the header of a pcapng file, of an interface and of a packet at most.
inline constexpr std::size_t pcapng_header_size = 28;
inline constexpr std::size_t pcapng_max_name = 128;
inline constexpr std::size_t pcapng_max_interface = 36 + pcapng_max_name;
inline constexpr std::size_t pcapng_max_packet = 32 + 16 + 12;

[[nodiscard]] std::array<std::uint8_t, pcap_header_size> pcap_header() noexcept;
/// Writes one record and returns its length. A pcap has no name of a channel and no direction. Times before 1970
/// are written as 1970; seconds are counted in 32 bits.
std::size_t write_pcap_record(std::span<std::uint8_t> out, const TraceRecord& record) noexcept;

[[nodiscard]] std::array<std::uint8_t, pcapng_header_size> pcapng_header() noexcept;
/// An interface description block; interfaces count from 0 in the order in which they are written.
std::size_t write_pcapng_interface(std::span<std::uint8_t> out, std::string_view name) noexcept;
/// An enhanced packet block of that interface.
std::size_t write_pcapng_packet(std::span<std::uint8_t> out, std::uint32_t interface,
                                const TraceRecord& record) noexcept;

}  // namespace canopus::trace
