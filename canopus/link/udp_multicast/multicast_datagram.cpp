#include "canopus/link/udp_multicast/multicast_datagram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace canopus::link {
namespace {

// First bytes of a value [MessagePack specification, Overview].
constexpr std::uint8_t nil = 0xC0, no = 0xC2, yes = 0xC3, bin8 = 0xC4, float64 = 0xCB, uint32 = 0xCE;
constexpr std::uint8_t fixed_map = 0x80, fixed_string = 0xA0;

class Writer {
 public:
  explicit Writer(std::uint8_t* out) : start_(out), p_(out) {}
  void byte(std::uint8_t value) { *p_++ = value; }
  void number(std::uint64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  void key(std::string_view name) {
    byte(static_cast<std::uint8_t>(fixed_string | name.size()));
    p_ = std::ranges::copy(name, p_).out;
  }
  void flag(std::string_view name, bool value) {
    key(name);
    byte(value ? yes : no);
  }
  void bytes(std::span<const std::uint8_t> data) { p_ = std::ranges::copy(data, p_).out; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(p_ - start_); }

 private:
  std::uint8_t* start_;
  std::uint8_t* p_;
};

struct Value {
  enum class Kind : std::uint8_t { nothing, flag, number, real, bytes, text, array, map, other };
  Kind kind = Kind::nothing;
  bool negative = false;
  std::uint64_t number = 0;  // flag, number; elements of an array, pairs of a map
  double real = 0;
  std::span<const std::uint8_t> bytes{};
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}
  [[nodiscard]] bool empty() const { return rest_.empty(); }

  /// The next value; of an array or a map only its head. None: the bytes end before it does.
  std::optional<Value> value() {
    const auto first = number(1);
    if (!first) return std::nullopt;
    const auto head = static_cast<std::uint8_t>(*first);
    using Kind = Value::Kind;
    if (head <= 0x7F) return Value{.kind = Kind::number, .number = head};
    if (head <= 0x8F) return Value{.kind = Kind::map, .number = head & 0x0FU};
    if (head <= 0x9F) return Value{.kind = Kind::array, .number = head & 0x0FU};
    if (head <= 0xBF) return bytes(Kind::text, head & 0x1FU);
    if (head >= 0xE0) return Value{.kind = Kind::number, .negative = true};
    switch (head) {
      case nil: return Value{};
      case no: return Value{.kind = Kind::flag, .number = 0};
      case yes: return Value{.kind = Kind::flag, .number = 1};
      case 0xC4:
      case 0xC5:
      case 0xC6: return bytes(Kind::bytes, number(1 << (head - 0xC4)));
      case 0xC7:
      case 0xC8:
      case 0xC9: return extension(number(1 << (head - 0xC7)));
      case 0xCA: {
        const auto raw = number(4);
        if (!raw) return std::nullopt;
        return Value{.kind = Kind::real,
                     .real = double{std::bit_cast<float>(static_cast<std::uint32_t>(*raw))}};
      }
      case float64: {
        const auto raw = number(8);
        if (!raw) return std::nullopt;
        return Value{.kind = Kind::real, .real = std::bit_cast<double>(*raw)};
      }
      case 0xCC:
      case 0xCD:
      case 0xCE:
      case 0xCF: return headed(Kind::number, number(1 << (head - 0xCC)));
      case 0xD0:
      case 0xD1:
      case 0xD2:
      case 0xD3: {
        const int size = 1 << (head - 0xD0);
        auto value = headed(Kind::number, number(size));
        if (value) value->negative = (value->number >> (8 * size - 1) & 1U) != 0;
        return value;
      }
      case 0xD4:
      case 0xD5:
      case 0xD6:
      case 0xD7:
      case 0xD8: return extension(std::uint64_t{1} << (head - 0xD4));
      case 0xD9:
      case 0xDA:
      case 0xDB: return bytes(Kind::text, number(1 << (head - 0xD9)));
      case 0xDC:
      case 0xDD: return headed(Kind::array, number(2 << (head - 0xDC)));
      case 0xDE:
      case 0xDF: return headed(Kind::map, number(2 << (head - 0xDE)));
      default: return std::nullopt;  // C1H is never used
    }
  }
  /// Skips the contents of a value whose head was read. Every element is at least a byte, so a count that is
  /// too high ends soon.
  bool pass(const Value& value) {
    std::uint64_t left = contents(value);
    while (left > 0) {
      const auto next = this->value();
      if (!next) return false;
      const std::uint64_t more = contents(*next);
      if (more > rest_.size()) return false;
      left += more - 1;
    }
    return true;
  }

 private:
  static std::uint64_t contents(const Value& value) {
    if (value.kind == Value::Kind::array) return value.number;
    return value.kind == Value::Kind::map ? 2 * value.number : 0;
  }
  std::optional<std::uint64_t> number(int bytes) {
    if (rest_.size() < static_cast<std::size_t>(bytes)) return std::nullopt;
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value = value << 8 | rest_[static_cast<std::size_t>(i)];
    rest_ = rest_.subspan(static_cast<std::size_t>(bytes));
    return value;
  }
  static std::optional<Value> headed(Value::Kind kind, std::optional<std::uint64_t> number) {
    if (!number) return std::nullopt;
    return Value{.kind = kind, .number = *number};
  }
  std::optional<Value> bytes(Value::Kind kind, std::optional<std::uint64_t> size) {
    if (!size || rest_.size() < *size) return std::nullopt;
    const Value value{.kind = kind, .bytes = rest_.first(static_cast<std::size_t>(*size))};
    rest_ = rest_.subspan(static_cast<std::size_t>(*size));
    return value;
  }
  std::optional<Value> extension(std::optional<std::uint64_t> size) {
    if (!number(1)) return std::nullopt;  // its type
    return bytes(Value::Kind::other, size);
  }

  std::span<const std::uint8_t> rest_;
};

/// The fields that matter, as far as they came.
struct Fields {
  std::optional<std::uint64_t> identifier, dlc;
  std::optional<bool> extended, remote;
  std::optional<std::span<const std::uint8_t>> data;
  bool error = false;
  bool fd = false;
  double time = 0;
};

bool set_field(Fields& fields, std::string_view key, const Value& value) {
  using Kind = Value::Kind;
  const bool is_number = value.kind == Kind::number && !value.negative;
  const bool is_flag = value.kind == Kind::flag;
  const bool flag = value.number != 0;
  if (key == "arbitration_id") return is_number && (fields.identifier = value.number, true);
  if (key == "dlc") return is_number && (fields.dlc = value.number, true);
  if (key == "is_extended_id") return is_flag && (fields.extended = flag, true);
  if (key == "is_remote_frame") return is_flag && (fields.remote = flag, true);
  if (key == "is_error_frame") return is_flag && (fields.error = flag, true);
  if (key == "is_fd") return is_flag && (fields.fd = flag, true);
  if (key == "data")
    return (value.kind == Kind::bytes || value.kind == Kind::nothing) && (fields.data = value.bytes, true);
  if (key == "timestamp" && value.kind == Kind::real) fields.time = value.real;
  return true;
}

std::expected<MulticastMessage, std::string_view> message_of(const Fields& fields) {
  if (!fields.identifier || !fields.extended || !fields.remote || !fields.dlc || !fields.data) {
    return std::unexpected("a field of the message is missing");
  }
  MulticastMessage message;
  // Up to the year 9999; beyond that, or not a number: no time.
  if (fields.time > 0 && fields.time < 253402300800.0) {
    const double seconds = std::floor(fields.time);
    message.time = std::chrono::seconds(static_cast<std::int64_t>(seconds)) +
                   std::chrono::nanoseconds(static_cast<std::int64_t>((fields.time - seconds) * 1e9));
    if (fields.time > 9e9) message.time = {};  // more than fits into 64 bits of nanoseconds
  }
  if (fields.fd) {
    message.kind = MulticastMessage::Kind::fd_frame;
    return message;
  }
  can::Frame& frame = message.frame;
  const std::uint64_t most =
      *fields.extended || fields.error ? can::max_extended_identifier : can::max_base_identifier;
  if (*fields.identifier > most) return std::unexpected("its identifier is too high");
  if (*fields.dlc > 8) return std::unexpected("its length is above 8");
  if (*fields.remote ? !fields.data->empty() : fields.data->size() != *fields.dlc) {
    return std::unexpected("its data are not as long as its length says");
  }
  frame.identifier = static_cast<std::uint32_t>(*fields.identifier);
  frame.extended = *fields.extended;
  frame.remote = *fields.remote;
  frame.dlc = static_cast<std::uint8_t>(*fields.dlc);
  std::ranges::copy(*fields.data, frame.data.begin());
  if (fields.error) message.kind = MulticastMessage::Kind::error_frame;
  return message;
}

}  // namespace

std::size_t write_multicast_datagram(std::span<std::uint8_t, multicast_max_datagram> out,
                                     const can::Frame& frame, std::chrono::nanoseconds time) noexcept {
  Writer writer(out.data());
  writer.byte(fixed_map | 11);
  writer.key("timestamp");
  writer.byte(float64);
  writer.number(std::bit_cast<std::uint64_t>(std::chrono::duration<double>(time).count()), 8);
  writer.key("arbitration_id");
  writer.byte(uint32);
  writer.number(frame.identifier, 4);
  writer.flag("is_extended_id", frame.extended);
  writer.flag("is_remote_frame", frame.remote);
  writer.flag("is_error_frame", false);
  writer.key("channel");
  writer.byte(nil);
  writer.key("dlc");
  writer.byte(std::min<std::uint8_t>(frame.dlc, 8));
  writer.key("data");
  writer.byte(bin8);
  writer.byte(static_cast<std::uint8_t>(frame.length()));
  writer.bytes(frame.bytes());
  writer.flag("is_fd", false);
  writer.flag("bitrate_switch", false);
  writer.flag("error_state_indicator", false);
  return writer.size();
}

std::expected<MulticastMessage, std::string_view> read_multicast_datagram(
    std::span<const std::uint8_t> datagram) noexcept {
  constexpr std::string_view cut = "it is cut, or no MessagePack";
  Reader reader(datagram);
  const auto map = reader.value();
  if (!map) return std::unexpected(cut);
  if (map->kind != Value::Kind::map) return std::unexpected("it is no map of a message's fields");
  Fields fields;
  for (std::uint64_t pair = 0; pair < map->number; ++pair) {
    const auto key = reader.value();
    if (!key) return std::unexpected(cut);
    if (key->kind != Value::Kind::text) return std::unexpected("the name of a field is no text");
    const auto value = reader.value();
    if (!value) return std::unexpected(cut);
    const std::string_view name(reinterpret_cast<const char*>(key->bytes.data()), key->bytes.size());
    if (!set_field(fields, name, *value)) return std::unexpected("a field of the message has another type");
    if (!reader.pass(*value)) return std::unexpected(cut);
  }
  if (!reader.empty()) return std::unexpected("there are bytes behind the message");
  return message_of(fields);
}

}  // namespace canopus::link
