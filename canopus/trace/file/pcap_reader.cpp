// The reader of pcap files [tcpdump.org: pcap-savefile].

#include <bit>
#include <memory>

#include "canopus/ascii/counted.hpp"
#include "canopus/trace/file/capture_packet.hpp"
#include "canopus/trace/file/reader_base.hpp"

namespace canopus::trace {
namespace {

constexpr std::uint32_t microsecond_magic = 0xA1B2'C3D4;
constexpr std::uint32_t nanosecond_magic = 0xA1B2'3C4D;
constexpr std::size_t file_header = 24;
constexpr std::size_t packet_header = 16;
constexpr std::uint32_t longest_read_packet = 262'144;  // MAXIMUM_SNAPLEN of tcpdump

class PcapReader final : public ReaderBase {
 public:
  PcapReader(TraceInput input, std::endian order, bool nanoseconds, std::uint32_t linktype)
      : ReaderBase(std::move(input), FileFormat::pcap),
        packets_(order),
        order_(order),
        nanoseconds_(nanoseconds),
        linktype_(linktype) {
    (void)channels_.number_of("can0");  // a pcap names none
  }

  NextRecord next() override {
    while (!ended_) {
      const std::uint64_t start = input_.offset();
      const std::string_view header = input_.peek(packet_header);
      if (header.size() < packet_header) {
        ended_ = true;
        if (auto failure = input_.failure()) return std::unexpected(std::move(*failure));
        if (header.empty()) return std::nullopt;
        return fail(start, "expected a packet header of 16 bytes, found the end of the file");
      }
      const auto seconds = number_at<std::uint32_t>(header, 0, order_);
      const auto fraction = number_at<std::uint32_t>(header, 4, order_);
      const auto length = number_at<std::uint32_t>(header, 8, order_);
      if (length > longest_read_packet) {
        ended_ = true;
        return fail(start + 8, "expected a packet of at most 262144 bytes, found " + std::to_string(length));
      }
      (void)input_.skip(packet_header);
      const std::string_view packet =
          input_.peek(std::min<std::size_t>(length, capture_packet_room)).substr(0, length);
      TraceRecord record;
      const auto found = packets_.read(linktype_, packet, record);
      if (!input_.skip(length)) {
        ended_ = true;
        return fail(start,
                    "expected a packet of " + ascii::counted(length, "byte") + ", found the end of the file");
      }
      if (!found) return fail(start + packet_header, found.error());
      if (fraction >= (nanoseconds_ ? 1'000'000'000U : 1'000'000U)) {
        return fail(start + 4, "expected a fraction of a second, found " + std::to_string(fraction));
      }
      if (*found) {
        left_out_.add(**found);
        continue;
      }
      record.time = can::Time(std::chrono::seconds(seconds) +
                              can::Duration(nanoseconds_ ? fraction : fraction * std::int64_t{1000}));
      return record;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::unexpected<std::string> fail(std::uint64_t offset, const std::string& expected) const {
    return std::unexpected(input_.name() + ": offset " + std::to_string(offset) + ": " + expected);
  }

  CapturePackets packets_;
  std::endian order_;
  bool nanoseconds_;
  std::uint32_t linktype_;
  bool ended_ = false;
};

}  // namespace

OpenedReader open_pcap(TraceInput input) {
  const std::string_view header = input.peek(file_header);
  const auto wrong = [&](std::size_t offset, const std::string& expected) {
    return std::unexpected(input.name() + ": offset " + std::to_string(offset) + ": expected " + expected);
  };
  if (header.size() < file_header) return wrong(header.size(), "the header of a pcap file, found its end");
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const auto magic = number_at<std::uint32_t>(header, 0, order);
    if (magic != microsecond_magic && magic != nanosecond_magic) continue;
    // the upper bits announce a checksum behind the packets [pcap-savefile]
    const std::uint32_t linktype = number_at<std::uint32_t>(header, 20, order) & 0x03FF'FFFF;
    if (!holds_can(linktype)) {
      return wrong(20, "link type 227 (CAN over SocketCAN), 113 or 276 (Linux cooked), found " +
                           std::to_string(linktype));
    }
    (void)input.skip(file_header);
    return std::make_unique<PcapReader>(std::move(input), order, magic == nanosecond_magic, linktype);
  }
  return wrong(0, "the magic number of a pcap file");
}

}  // namespace canopus::trace
