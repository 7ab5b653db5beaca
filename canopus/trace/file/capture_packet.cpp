#include "canopus/trace/file/capture_packet.hpp"

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

}  // namespace canopus::trace
