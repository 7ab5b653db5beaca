#pragma once
// A CAN frame as pcap and pcapng files hold it [tcpdump.org: LINKTYPE_CAN_SOCKETCAN 227, LINKTYPE_LINUX_SLL 113,
// LINKTYPE_LINUX_SLL2 276].

#include <bit>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
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

}  // namespace canopus::trace
