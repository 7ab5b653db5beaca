#include "canopus/trace/file/blf_containers.hpp"

#include <algorithm>
#include <bit>

#include <zlib.h>

#include "canopus/trace/file/capture_packet.hpp"

namespace canopus::trace {
namespace {

constexpr std::uint32_t log_container = 10;
constexpr std::size_t object_header = 16;
constexpr std::size_t container_header = 32;

}  // namespace

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

}  // namespace canopus::trace
