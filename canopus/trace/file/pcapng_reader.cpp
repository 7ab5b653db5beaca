// The reader of pcapng files [draft-ietf-opsawg-pcapng].

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "canopus/ascii/counted.hpp"
#include "canopus/trace/file/capture_packet.hpp"
#include "canopus/trace/file/reader_base.hpp"

namespace canopus::trace {
namespace {

enum BlockType : std::uint32_t {
  section_header = 0x0A0D'0D0A,
  interface_description = 1,
  old_packet = 2,
  simple_packet = 3,
  interface_statistics = 5,
  enhanced_packet = 6,
};
constexpr std::uint32_t byte_order_magic = 0x1A2B'3C4D;
constexpr std::uint32_t largest_read_block = 1U << 20;  // blocks that matter here take a hundred bytes
constexpr std::size_t most_interfaces = ChannelNames::max_channels;

__extension__ using WideTicks = unsigned __int128;

/// The time unit and offset of an interface.
struct InterfaceClock {
  std::uint64_t ticks_per_second = 1'000'000;
  std::int64_t offset = 0;  ///< s

  /// Nothing when a can::Time cannot hold it.
  [[nodiscard]] std::optional<can::Time> time_of(std::uint64_t ticks) const {
    constexpr std::int64_t most_seconds = std::numeric_limits<std::int64_t>::max() / 1'000'000'000;
    const std::uint64_t whole = ticks / ticks_per_second;
    const auto fraction =
        static_cast<std::int64_t>(WideTicks{ticks % ticks_per_second} * 1'000'000'000U / ticks_per_second);
    if (whole >= static_cast<std::uint64_t>(most_seconds) || offset <= -most_seconds ||
        offset >= most_seconds)
      return std::nullopt;
    const std::int64_t seconds = static_cast<std::int64_t>(whole) + offset;
    if (seconds <= -most_seconds || seconds >= most_seconds) return std::nullopt;
    return can::Time(can::Duration(seconds * 1'000'000'000 + fraction));
  }
};

struct Interface {
  std::uint32_t linktype = 0;
  std::uint16_t channel = 0;
  InterfaceClock clock{};
  std::uint64_t dropped = 0;  ///< frames that the interface or the system lost so far
};

class PcapngReader final : public ReaderBase {
 public:
  explicit PcapngReader(TraceInput input) : ReaderBase(std::move(input), FileFormat::pcapng) {}

  NextRecord next() override {
    while (!ended_) {
      TraceRecord record;
      const auto found = read_block(record);
      if (!found) return std::unexpected(found.error());
      if (*found) return record;
    }
    return std::nullopt;
  }

 private:
  using Block = std::expected<bool, std::string>;  // whether there is a record

  [[nodiscard]] std::unexpected<std::string> fail(std::size_t at, const std::string& expected) const {
    return std::unexpected(input_.name() + ": offset " + std::to_string(block_ + at) + ": " + expected);
  }
  [[nodiscard]] std::unexpected<std::string> end_with(std::size_t at, const std::string& expected) {
    ended_ = true;
    return fail(at, expected);
  }
  template <typename T>
  [[nodiscard]] T number(std::string_view bytes, std::size_t at) const noexcept {
    return number_at<T>(bytes, at, order_);
  }

  Block read_block(TraceRecord& record);
  Block read_content(std::uint32_t type, std::string_view body, TraceRecord& record);
  Block read_interface(std::string_view body);
  Block read_packet(const Interface& interface, std::uint64_t ticks, std::string_view packet,
                    TraceRecord& record);
  Block read_timed_packet(bool old, std::string_view body, TraceRecord& record);
  Block read_statistics(std::string_view body);
  /// Calls `visit(code, value)` for each option.
  template <typename Take>
  void for_each_option(std::string_view options, Take&& visit) const;

  std::uint64_t block_ = 0;  // offset of the block
  std::endian order_ = std::endian::little;
  std::vector<Interface> interfaces_{};
  std::vector<CapturePackets> packets_{};  // of the section: one
  bool ended_ = false;
};

PcapngReader::Block PcapngReader::read_block(TraceRecord& record) {
  block_ = input_.offset();
  std::string_view header = input_.peek(12);
  if (header.size() < 12) {
    ended_ = true;
    if (auto failure = input_.failure()) return std::unexpected(std::move(*failure));
    if (header.empty()) return false;
    return fail(0, "expected a block of at least 12 bytes, found the end of the file");
  }
  // a section's type reads the same in both orders
  if (number<std::uint32_t>(header, 0) == section_header) {
    if (number_at<std::uint32_t>(header, 8, std::endian::little) == byte_order_magic) {
      order_ = std::endian::little;
    } else if (number_at<std::uint32_t>(header, 8, std::endian::big) == byte_order_magic) {
      order_ = std::endian::big;
    } else {
      return end_with(8, "expected the byte-order magic 1A2B3C4D");
    }
    interfaces_.clear();
    packets_.assign(1, CapturePackets(order_));
  } else if (packets_.empty()) {
    return end_with(0, "expected a section header block");
  }
  const auto type = number<std::uint32_t>(header, 0);
  const auto length = number<std::uint32_t>(header, 4);
  if (length < 12 || length % 4 != 0) {
    return end_with(
        4, "expected the length of a block, a multiple of 4 from 12, found " + std::to_string(length));
  }
  const bool is_read = type == interface_description || type == old_packet || type == simple_packet ||
                       type == enhanced_packet || type == interface_statistics;
  if (!is_read || length > largest_read_block) {
    if (!input_.skip(length)) {
      return end_with(0,
                      "expected a block of " + std::to_string(length) + " bytes, found the end of the file");
    }
    if (is_read) return fail(4, "expected a block of at most 1048576 bytes, found " + std::to_string(length));
    return false;
  }
  const std::string_view whole = input_.peek(length);
  if (whole.size() < length) {
    return end_with(0, "expected a block of " + std::to_string(length) + " bytes, found the end of the file");
  }
  if (number<std::uint32_t>(whole, length - 4) != length) {
    return end_with(length - 4, "expected the length of the block, " + std::to_string(length) + ", again");
  }
  auto found = read_content(type, whole.substr(8, length - 12), record);
  (void)input_.skip(length);
  return found;
}

PcapngReader::Block PcapngReader::read_content(std::uint32_t type, std::string_view body,
                                               TraceRecord& record) {
  switch (type) {
    case interface_description: return read_interface(body);
    case old_packet: return read_timed_packet(true, body, record);
    case enhanced_packet: return read_timed_packet(false, body, record);
    case interface_statistics: return read_statistics(body);
    default: break;
  }
  if (interfaces_.empty()) return fail(0, "expected an interface description before a packet");
  if (body.size() < 4) return fail(8, "expected the length of a packet");
  const std::size_t length =
      std::min<std::size_t>(number<std::uint32_t>(body, 0), body.size() - 4);  // the rest is padding
  return read_packet(interfaces_.front(), 0, body.substr(4, length), record);
}

template <typename Take>
void PcapngReader::for_each_option(std::string_view options, Take&& visit) const {
  while (options.size() >= 4) {
    const auto code = number<std::uint16_t>(options, 0);
    const std::size_t length = number<std::uint16_t>(options, 2);
    if (code == 0 || length > options.size() - 4) return;
    visit(code, options.substr(4, length));
    options.remove_prefix(std::min(options.size(), 4 + (length + 3) / 4 * 4));
  }
}

PcapngReader::Block PcapngReader::read_interface(std::string_view body) {
  if (body.size() < 8) return end_with(8, "expected an interface description");
  if (interfaces_.size() == most_interfaces) {
    return end_with(0, "expected at most " + std::to_string(most_interfaces) + " interfaces");
  }
  Interface interface { .linktype = number<std::uint16_t>(body, 0) };
  std::string name = "can" + std::to_string(interfaces_.size());
  bool is_clock = true;
  for_each_option(body.substr(8), [&](std::uint16_t code, std::string_view value) {
    if (code == 2 && !value.empty() && value.front() != '\0') {  // if_name
      name = value.substr(0, value.find('\0'));
    } else if (code == 9 && !value.empty()) {  // if_tsresol
      const auto resolution = static_cast<std::uint8_t>(value[0]);
      const unsigned exponent = resolution & 0x7FU;
      const bool binary = (resolution & 0x80U) != 0;
      is_clock = exponent <= (binary ? 63U : 19U);
      interface.clock.ticks_per_second = 1;
      for (unsigned i = 0; is_clock && i < exponent; ++i) interface.clock.ticks_per_second *= binary ? 2 : 10;
    } else if (code == 14 && value.size() == 8) {  // if_tsoffset
      interface.clock.offset = static_cast<std::int64_t>(number<std::uint64_t>(value, 0));
    }
  });
  if (!is_clock) return end_with(8, "expected a resolution of time stamps of 10^-19 s or 2^-63 s at most");
  if (holds_can(interface.linktype)) {
    const auto channel = channels_.number_of(name);
    if (!channel) {
      return end_with(8, "expected at most " + std::to_string(ChannelNames::max_channels) + " channels");
    }
    interface.channel = *channel;
  }
  interfaces_.push_back(interface);
  return false;
}

PcapngReader::Block PcapngReader::read_timed_packet(bool old, std::string_view body, TraceRecord& record) {
  if (body.size() < 20) return fail(8, "expected a packet with its time");
  const std::size_t number_of_interface =
      old ? number<std::uint16_t>(body, 0) : number<std::uint32_t>(body, 0);
  if (number_of_interface >= interfaces_.size()) {
    return fail(8, "expected one of " + std::to_string(interfaces_.size()) + " interfaces, found number " +
                       std::to_string(number_of_interface));
  }
  const std::uint64_t ticks =
      std::uint64_t{number<std::uint32_t>(body, 4)} << 32 | number<std::uint32_t>(body, 8);
  const std::size_t length = number<std::uint32_t>(body, 12);
  if (length > body.size() - 20) {
    return fail(20, "expected a packet that fits into its block, found " + ascii::counted(length, "byte"));
  }
  const std::size_t padded = (length + 3) / 4 * 4;
  for_each_option(body.substr(std::min(body.size(), 20 + padded)),
                  [&](std::uint16_t code, std::string_view value) {
                    if (code == 2 && value.size() == 4)
                      record.transmitted = (number<std::uint32_t>(value, 0) & 3U) == 2U;
                  });
  return read_packet(interfaces_[number_of_interface], ticks, body.substr(20, length), record);
}

/// Counters of an interface since the begin of its capture; a section may have several such blocks.
PcapngReader::Block PcapngReader::read_statistics(std::string_view body) {
  if (body.size() < 12) return fail(8, "expected statistics of an interface");
  const std::size_t number_of_interface = number<std::uint32_t>(body, 0);
  if (number_of_interface >= interfaces_.size()) return false;
  std::uint64_t dropped = 0;
  for_each_option(body.substr(12), [&](std::uint16_t code, std::string_view value) {
    // isb_ifdrop, isb_osdrop; a counter beyond any capture is none
    if ((code == 5 || code == 7) && value.size() == 8)
      dropped += std::min<std::uint64_t>(number<std::uint64_t>(value, 0), std::uint64_t{1} << 48);
  });
  Interface& interface = interfaces_[number_of_interface];
  if (dropped > interface.dropped) left_out_.add_lost(dropped - std::exchange(interface.dropped, dropped));
  return false;
}

PcapngReader::Block PcapngReader::read_packet(const Interface& interface, std::uint64_t ticks,
                                              std::string_view packet, TraceRecord& record) {
  if (!holds_can(interface.linktype)) {
    left_out_.add(LeftOutKind::other_bus);
    return false;
  }
  const auto found = packets_.front().read(interface.linktype, packet, record);
  if (!found) return fail(28, found.error());
  if (*found) {
    left_out_.add(**found);
    return false;
  }
  const auto time = interface.clock.time_of(ticks);
  if (!time) return fail(12, "expected a time before the year 2262");
  record.time = *time;
  record.channel = interface.channel;
  return true;
}

}  // namespace

OpenedReader open_pcapng(TraceInput input) {
  const std::string_view header = input.peek(12);
  if (header.size() < 12 || number_at<std::uint32_t>(header, 0, std::endian::little) != section_header) {
    return std::unexpected(input.name() + ": offset 0: expected the section header block of a pcapng file");
  }
  return std::make_unique<PcapngReader>(std::move(input));
}

}  // namespace canopus::trace
