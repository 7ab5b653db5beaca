// The reader of Vector's BLF files. Objects of CAN FD channels hold classical frames, too; what is none is left out.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include <zlib.h>

#include "canopus/trace/file/capture_packet.hpp"
#include "canopus/trace/file/reader_base.hpp"
#include "canopus/trace/file/trace_input.hpp"
#include "canopus/trace/file/words.hpp"

namespace canopus::trace {
namespace {

/// The containers of a BLF file: their unpacked contents as one stream of objects. Memory use does not depend
/// on the size that a container declares.
class BlfContainers {
 public:
  /// `input` is positioned behind the header of the file.
  explicit BlfContainers(TraceInput input);
  ~BlfContainers();
  BlfContainers(const BlfContainers&) = delete;
  BlfContainers& operator=(const BlfContainers&) = delete;

  /// The next bytes of the objects, 0 at their end. Objects outside of containers come as they are.
  std::size_t read(std::span<char> out);
  /// The error of the file, with its name and the offset; empty: none.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  enum class Content : std::uint8_t { none, plain, deflated };
  struct Inflater;

  bool find_object();
  std::size_t read_plain(std::span<char> out);
  std::size_t read_deflated(std::span<char> out);
  void fail(const std::string& expected);

  TraceInput input_;
  Content content_ = Content::none;
  std::uint64_t left_ = 0;  // bytes of the container or object that are not read yet
  std::unique_ptr<Inflater> inflater_;
  std::string error_{};
};

constexpr std::uint32_t log_container = 10;
constexpr std::size_t object_header = 16;
constexpr std::size_t container_header = 32;

struct BlfContainers::Inflater {
  Inflater() { ready = inflateInit(&stream) == Z_OK; }
  ~Inflater() {
    if (ready) (void)inflateEnd(&stream);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  z_stream stream{};
  bool ready = false;
};

BlfContainers::BlfContainers(TraceInput input)
    : input_(std::move(input)), inflater_(std::make_unique<Inflater>()) {
  if (!inflater_->ready) fail("no memory to unpack containers");
}

BlfContainers::~BlfContainers() = default;

void BlfContainers::fail(const std::string& expected) {
  if (error_.empty())
    error_ = input_.name() + ": offset " + std::to_string(input_.offset()) + ": " + expected;
}

std::size_t BlfContainers::read(std::span<char> out) {
  while (error_.empty() && !out.empty()) {
    if (content_ == Content::none && !find_object()) return 0;
    if (content_ == Content::none) continue;
    const std::size_t size = content_ == Content::plain ? read_plain(out) : read_deflated(out);
    if (size > 0) return size;
  }
  return 0;
}

/// False at the end of the file, or when there is a mistake.
bool BlfContainers::find_object() {
  using std::endian;
  std::string_view bytes = input_.peek(8);
  // up to 3 bytes fill up the object before
  const std::size_t at = bytes.substr(0, 7).find("LOBJ");
  if (at == std::string_view::npos) {
    if (auto failure = input_.failure()) {
      error_ = *failure;
    } else if (bytes.size() >= 4) {
      fail("expected an object (LOBJ)");
    }
    return false;
  }
  (void)input_.skip(at);
  bytes = input_.peek(container_header);
  if (bytes.size() < object_header) {
    fail("expected the header of an object, found the end of the file");
    return false;
  }
  const auto size = number_at<std::uint32_t>(bytes, 8, endian::little);
  const bool is_container = number_at<std::uint32_t>(bytes, 12, endian::little) == log_container;
  if (size < (is_container ? container_header : object_header) ||
      (is_container && bytes.size() < container_header)) {
    fail("expected an object of at least " + std::to_string(is_container ? container_header : object_header) +
         " bytes, found " + std::to_string(std::min<std::size_t>(size, bytes.size())));
    return false;
  }
  left_ = size;
  content_ = Content::plain;
  if (!is_container) return true;
  const auto method = number_at<std::uint16_t>(bytes, 16, endian::little);
  if (method != 0 && method != 2) {
    fail("expected a container of compression 0 (none) or 2 (zlib), found " + std::to_string(method));
    return false;
  }
  (void)input_.skip(container_header);
  left_ -= container_header;
  if (method == 2) {
    content_ = Content::deflated;
    (void)inflateReset(&inflater_->stream);
  }
  return true;
}

std::size_t BlfContainers::read_plain(std::span<char> out) {
  if (left_ == 0) {
    content_ = Content::none;
    return 0;
  }
  const std::string_view bytes = input_.peek(1);
  if (bytes.empty()) {
    fail("expected " + std::to_string(left_) + " more bytes of an object, found the end of the file");
    return 0;
  }
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>({bytes.size(), left_, out.size()}));
  std::copy_n(bytes.data(), size, out.data());
  (void)input_.skip(size);
  left_ -= size;
  return size;
}

std::size_t BlfContainers::read_deflated(std::span<char> out) {
  const std::string_view bytes = input_.peek(left_ > 0 ? 1 : 0);
  const auto available = static_cast<std::size_t>(std::min<std::uint64_t>({bytes.size(), left_, 1U << 30}));
  z_stream& stream = inflater_->stream;
  // zlib does not write to what it reads
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(available);
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(std::min<std::size_t>(out.size(), 1U << 30));
  const uInt room = stream.avail_out;
  const int result = inflate(&stream, Z_NO_FLUSH);
  const std::size_t taken = available - stream.avail_in;
  const std::size_t made = room - stream.avail_out;
  if (result == Z_STREAM_END) {
    if (!input_.skip(left_)) fail("expected a whole container, found the end of the file");
    left_ = 0;
    content_ = Content::none;
  } else if (result != Z_OK && (result != Z_BUF_ERROR || (taken == 0 && made == 0))) {
    fail(available == 0 ? "expected the rest of a compressed container, found its end"
                        : "expected a container that zlib can unpack");
  } else {
    (void)input_.skip(taken);
    left_ -= taken;
  }
  return made;
}

enum ObjectType : std::uint32_t {
  can_message = 1,
  can_error = 2,
  can_statistic = 4,
  app_text = 65,
  can_error_ext = 73,
  can_message2 = 86,
  event_comment = 92,
  can_fd_message = 100,
  can_fd_message_64 = 101,
  can_fd_error_64 = 104,
  data_lost_end = 126,
};

LeftOutKind kind_of(std::uint32_t type) {
  switch (type) {
    case can_statistic: return LeftOutKind::statistics;
    case app_text:
    case event_comment: return LeftOutKind::comment;
    default: return LeftOutKind::other;
  }
}

constexpr std::size_t smallest_file_header = 72;
constexpr std::size_t base_header = 16;
constexpr std::uint32_t largest_read_object = 4096;  // those that are read have 48 to 100 bytes
constexpr std::uint32_t time_in_10_us = 1;

template <typename T>
T number(std::string_view bytes, std::size_t at) {
  return number_at<T>(bytes, at, std::endian::little);
}

class BlfReader final : public ReaderBase {
 public:
  BlfReader(std::string name, std::shared_ptr<BlfContainers> containers, can::Time start)
      : ReaderBase(TraceInput(std::move(name),
                              [containers](std::span<char> out) -> std::expected<std::size_t, int> {
                                return containers->read(out);
                              }),
                   FileFormat::blf),
        containers_(std::move(containers)),
        start_(start) {}

  NextRecord next() override {
    while (!ended_) {
      TraceRecord record;
      const auto found = read_object(record);
      if (!found) return std::unexpected(found.error());
      if (*found) return record;
    }
    return std::nullopt;
  }

 private:
  using Object = std::expected<bool, std::string>;  // whether there is a record

  [[nodiscard]] std::unexpected<std::string> fail(const std::string& expected) const {
    return std::unexpected(input_.name() + ": object at byte " + std::to_string(input_.offset()) +
                           " of what the containers hold: " + expected);
  }
  Object end() {
    ended_ = true;
    if (!containers_->error().empty()) return std::unexpected(containers_->error());
    return false;
  }

  Object read_object(TraceRecord& record) {
    std::string_view bytes = input_.peek(base_header + 8);
    const std::size_t at = bytes.substr(0, 11).find("LOBJ");
    if (at == std::string_view::npos) {
      if (bytes.size() < 8) return end();
      ended_ = true;
      return fail("expected an object (LOBJ)");
    }
    (void)input_.skip(at);
    bytes = input_.peek(base_header);
    if (bytes.size() < base_header) return end();
    const auto version = number<std::uint16_t>(bytes, 6);
    const auto size = number<std::uint32_t>(bytes, 8);
    const auto type = number<std::uint32_t>(bytes, 12);
    if (size < base_header) {
      ended_ = true;
      return fail("expected an object of at least 16 bytes, found " + std::to_string(size));
    }
    const std::size_t least = least_body(type);
    if (least == 0 || size > largest_read_object || (version != 1 && version != 2)) {
      left_out_.add(least == 0 ? kind_of(type) : LeftOutKind::other);
      return input_.skip(size) ? Object(false) : end();
    }
    bytes = input_.peek(size);
    if (bytes.size() < size) {
      if (!containers_->error().empty()) return end();
      ended_ = true;
      return fail("expected " + std::to_string(size) + " bytes, found " + std::to_string(bytes.size()));
    }
    auto found = read_message(type, version == 1 ? 32 : 40, bytes.substr(0, size), record);
    (void)input_.skip(size);
    return found;
  }

  /// Bytes behind the header of the objects that are read; 0: of a type that is left out.
  static std::size_t least_body(std::uint32_t type) {
    switch (type) {
      case can_message:
      case can_message2: return 16;
      case can_error:
      case can_error_ext:
      case can_fd_error_64: return 4;
      case can_fd_message: return 28;
      case can_fd_message_64: return 40;
      case data_lost_end: return 16;
      default: return 0;
    }
  }

  Object read_message(std::uint32_t type, std::size_t header, std::string_view object, TraceRecord& record) {
    if (object.size() < header + least_body(type)) return fail("expected a larger object of this type");
    const std::uint64_t ticks = number<std::uint64_t>(object, 24);
    const std::int64_t unit = number<std::uint32_t>(object, 16) == time_in_10_us ? 10'000 : 1;
    if (ticks > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max() / unit)) {
      return fail("expected a time before the year 2262");
    }
    record.time = can::later(start_, can::Duration(static_cast<std::int64_t>(ticks) * unit));
    const std::string_view body = object.substr(header);
    switch (type) {
      case can_message:
      case can_message2: return read_can_message(body, record);
      case can_fd_message: return read_can_fd_message(body, record);
      case can_fd_message_64: return read_can_fd_message_64(body, record);
      case data_lost_end: left_out_.add_lost(number<std::uint32_t>(body, 12)); return false;
      default: break;
    }
    // the details of Vector's error have no place in a SocketCAN error frame
    record.frame.dlc = 8;
    set_error_frame(record, unspecified_error);
    const bool is_short = type == can_fd_error_64;
    return on_channel(is_short ? static_cast<std::uint8_t>(body[0]) : number<std::uint16_t>(body, 0), record);
  }

  Object read_can_message(std::string_view body, TraceRecord& record) {
    const auto flags = static_cast<std::uint8_t>(body[2]);
    if ((flags & 0x0FU) == 2) {  // the frame itself follows
      left_out_.add(LeftOutKind::send_request);
      return false;
    }
    record.transmitted = (flags & 1U) != 0;
    record.frame.remote = (flags & 0x80U) != 0;
    return read_frame(static_cast<std::uint8_t>(body[3]), number<std::uint32_t>(body, 4), body.substr(8),
                      number<std::uint16_t>(body, 0), record);
  }

  Object read_can_fd_message(std::string_view body, TraceRecord& record) {
    constexpr unsigned is_fd_frame = 1;  // EDL
    if ((static_cast<std::uint8_t>(body[13]) & is_fd_frame) != 0) return leave_out_fd();
    const auto flags = static_cast<std::uint8_t>(body[2]);
    record.transmitted = (flags & 1U) != 0;
    record.frame.remote = (flags & 0x80U) != 0;
    return read_frame(static_cast<std::uint8_t>(body[3]), number<std::uint32_t>(body, 4), body.substr(20),
                      number<std::uint16_t>(body, 0), record);
  }

  Object read_can_fd_message_64(std::string_view body, TraceRecord& record) {
    constexpr std::uint32_t is_remote = 0x10, is_fd_frame = 0x1000;
    const auto flags = number<std::uint32_t>(body, 12);
    if ((flags & is_fd_frame) != 0) return leave_out_fd();
    const auto direction = static_cast<std::uint8_t>(body[34]);
    if (direction == 2) {
      left_out_.add(LeftOutKind::send_request);
      return false;
    }
    record.transmitted = direction == 1;
    record.frame.remote = (flags & is_remote) != 0;
    const std::size_t valid = static_cast<std::uint8_t>(body[2]);
    return read_frame(static_cast<std::uint8_t>(body[1]), number<std::uint32_t>(body, 4),
                      body.substr(40, valid), static_cast<std::uint8_t>(body[0]), record);
  }

  Object leave_out_fd() {
    left_out_.add(LeftOutKind::can_fd);
    return false;
  }

  /// `data`: where it is shorter than the DLC says, the rest of the frame is 0.
  Object read_frame(std::uint8_t dlc, std::uint32_t identifier, std::string_view data, std::uint16_t channel,
                    TraceRecord& record) {
    can::Frame& frame = record.frame;
    frame.extended = (identifier & 0x8000'0000U) != 0;
    frame.identifier = identifier & can::max_extended_identifier;
    if (dlc > 15) return fail("expected a DLC of 0 to 15, found " + std::to_string(dlc));
    if (!frame.extended && frame.identifier > can::max_base_identifier) {
      return fail("expected a base identifier up to 7FF");
    }
    frame.dlc = dlc;
    for (std::size_t i = 0; i < frame.length() && i < data.size(); ++i) {
      frame.data[i] = static_cast<std::uint8_t>(data[i]);
    }
    return on_channel(channel, record);
  }

  Object on_channel(std::uint16_t number_of_channel, TraceRecord& record) {
    const auto channel = channels_.number_of(name_of_numbered_channel(number_of_channel));
    if (!channel) return fail("expected at most " + std::to_string(ChannelNames::max_channels) + " channels");
    record.channel = *channel;
    return true;
  }

  std::shared_ptr<BlfContainers> containers_;
  can::Time start_;
  bool ended_ = false;
};

/// A SYSTEMTIME of Windows: year, month, day of the week, day, hour, minute, second, ms. Zeros: no time.
can::Time start_of(std::string_view bytes) {
  const auto field = [&](std::size_t index) { return number<std::uint16_t>(bytes, 2 * index); };
  return utc_time(field(0), field(1), field(3),
                  std::chrono::hours(field(4)) + std::chrono::minutes(field(5)) +
                      std::chrono::seconds(field(6)) + std::chrono::milliseconds(field(7)))
      .value_or(can::Time{});
}

}  // namespace

OpenedReader open_blf(TraceInput input) {
  const std::string_view header = input.peek(smallest_file_header);
  const auto wrong = [&](const std::string& expected) {
    return std::unexpected(input.name() + ": offset 0: expected " + expected);
  };
  if (header.size() < smallest_file_header || !header.starts_with("LOGG")) {
    return wrong("the header of a BLF file, LOGG and 140 bytes more");
  }
  const auto size = number<std::uint32_t>(header, 4);
  const can::Time start = start_of(header.substr(40, 16));
  if (size < smallest_file_header || !input.skip(size)) {
    return wrong("a file of more than its header of " + std::to_string(size) + " bytes");
  }
  std::string name = input.name();
  return std::make_unique<BlfReader>(std::move(name), std::make_shared<BlfContainers>(std::move(input)),
                                     start);
}

}  // namespace canopus::trace
