#pragma once
// A CAN frame as pcap and pcapng files hold it [tcpdump.org: LINKTYPE_CAN_SOCKETCAN 227, LINKTYPE_LINUX_SLL 113,
// LINKTYPE_LINUX_SLL2 276].

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "canopus/trace/file/left_out.hpp"
#include "canopus/trace/file/trace_record.hpp"

namespace canopus::trace {

inline constexpr std::uint32_t linktype_linux_sll = 113;
inline constexpr std::uint32_t linktype_can_socketcan = 227;
inline constexpr std::uint32_t linktype_linux_sll2 = 276;
/// In the identifier of a SocketCAN frame.
inline constexpr std::uint32_t extended_flag = 0x8000'0000;
inline constexpr std::uint32_t remote_flag = 0x4000'0000;
inline constexpr std::uint32_t error_flag = 0x2000'0000;
/// The bytes of a packet that are read at most: a cooked header and the largest CAN FD frame.
inline constexpr std::size_t capture_packet_room = 20 + 72;

[[nodiscard]] constexpr bool holds_can(std::uint32_t linktype) noexcept {
  return linktype == linktype_can_socketcan || linktype == linktype_linux_sll ||
         linktype == linktype_linux_sll2;
}

/// Reads the packets of one capture. In a cooked packet the identifier is in network order or, from libpcap
/// before 1.9.1 or so, in the order of the host that recorded; the packets so far decide.
class CapturePackets {
 public:
  explicit CapturePackets(std::endian host) : cooked_order_(host) {}
  /// Fills frame, error_frame and, of a cooked packet, transmitted; returns what it is if it is no classical frame. The
  /// error names what was expected.
  [[nodiscard]] std::expected<std::optional<LeftOutKind>, std::string> read(std::uint32_t linktype,
                                                                            std::string_view packet,
                                                                            TraceRecord& record);

 private:
  std::endian cooked_order_;
};

/// An unsigned number of sizeof(T) bytes; `bytes` must hold them.
template <typename T>
[[nodiscard]] T number_at(std::string_view bytes, std::size_t at, std::endian order) noexcept {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    const std::size_t byte = order == std::endian::big ? i : sizeof(T) - 1 - i;
    value =
        static_cast<T>(static_cast<std::uint64_t>(value) << 8 | static_cast<std::uint8_t>(bytes[at + byte]));
  }
  return value;
}

// Records as pcap and pcapng hold them: link type 227 (CAN over SocketCAN), nanoseconds, host byte order
// [tcpdump.org: LINKTYPE_CAN_SOCKETCAN, pcap-savefile; draft-ietf-opsawg-pcapng].

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
