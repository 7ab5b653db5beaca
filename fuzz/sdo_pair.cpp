// An SDO client and a node's SDO server with a bus between them that the input lets drop, repeat, reorder and
// change frames: every transfer ends in time, and one that reports success while no frame was changed has
// moved exactly the right bytes.

#include <array>
#include <deque>
#include <vector>

#include "canopus/canopen/node/node.hpp"
#include "canopus/canopen/sdo/sdo_client.hpp"

#include "input.hpp"

namespace {

using namespace canopus;
using namespace std::chrono_literals;
using canopen::AbortCode;
using canopen::DataType;
using fuzz::expect;
using fuzz::Input;

constexpr std::uint8_t server_id = 5;
constexpr can::Duration frame_time = 100us;
constexpr can::Duration client_time_out = 500ms;
constexpr std::size_t longest = 4096;

/// Bytes that do not repeat, so that a piece in the wrong place is seen.
const std::array<std::uint8_t, longest + 16>& pattern() {
  static const auto bytes = [] {
    std::array<std::uint8_t, longest + 16> all{};
    std::uint32_t state = 0x1234567;
    for (std::uint8_t& byte : all) {
      state = state * 1664525U + 1013904223U;
      byte = static_cast<std::uint8_t>(state >> 24);
    }
    return all;
  }();
  return bytes;
}

constexpr std::uint16_t number_object = 0x2000;  // ..2004H: U8, U16, U24, U32, U64
constexpr std::uint16_t octets_object = 0x2010;
constexpr std::uint16_t domain_object = 0x2011;
constexpr std::uint16_t stream_object = 0x2012;

std::shared_ptr<const canopen::DictionaryDescription> description() {
  static const auto built = [] {
    canopen::DictionaryBuilder builder;
    builder.variable(0x1000, {.name = "Device type", .access = canopen::Access::read_only});
    builder.variable(number_object, {.name = "U8", .type = DataType::unsigned8});
    builder.variable(number_object + 1, {.name = "U16", .type = DataType::unsigned16});
    builder.variable(number_object + 2, {.name = "U24", .type = DataType::unsigned24});
    builder.variable(number_object + 3, {.name = "U32", .type = DataType::unsigned32});
    builder.variable(number_object + 4, {.name = "U64", .type = DataType::unsigned64});
    builder.variable(octets_object, {.name = "Octets", .type = DataType::octet_string});
    builder.variable(domain_object, {.name = "Domain", .type = DataType::domain});
    builder.variable(stream_object, {.name = "Stream", .type = DataType::domain});
    return builder.build();
  }();
  return built;
}

/// The object that streams: never read or written unless open, and closed once for each time it was opened.
class Stream final : public canopen::ObjectHandler, public canopen::ObjectStream {
 public:
  canopen::ObjectStream* stream(const canopen::Entry&) override { return this; }
  std::expected<std::optional<std::size_t>, AbortCode> open_read(const canopen::Entry&, can::Time) override {
    expect(!reading && !writing);
    reading = true;
    position_ = 0;
    return size_known ? std::optional(content.size()) : std::nullopt;
  }
  AbortCode open_write(const canopen::Entry&, std::optional<std::size_t>, can::Time) override {
    expect(!reading && !writing);
    writing = true;
    incoming_.clear();
    return AbortCode::none;
  }
  AbortCode close(const canopen::Entry&, bool complete, can::Time) override {
    expect(reading != writing);
    if (writing && complete) content = incoming_;
    reading = writing = false;
    return AbortCode::none;
  }
  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
    expect(reading && !into.empty());
    const std::size_t count = std::min(into.size(), content.size() - position_);
    std::copy_n(content.begin() + static_cast<std::ptrdiff_t>(position_), count, into.begin());
    position_ += count;
    return count;
  }
  AbortCode write(std::span<const std::uint8_t> bytes) override {
    expect(writing && incoming_.size() + bytes.size() <= 16 * longest);
    incoming_.insert(incoming_.end(), bytes.begin(), bytes.end());
    return AbortCode::none;
  }

  std::vector<std::uint8_t> content;
  bool size_known = true;
  bool reading = false;
  bool writing = false;

 private:
  std::size_t position_ = 0;
  std::vector<std::uint8_t> incoming_;
};

/// The client's own streams.
struct Source final : canopen::ByteSource {
  std::expected<std::size_t, AbortCode> read(std::span<std::uint8_t> into) override {
    const std::size_t count = std::min(into.size(), rest.size());
    std::copy_n(rest.begin(), count, into.begin());
    rest = rest.subspan(count);
    return count;
  }
  std::span<const std::uint8_t> rest;
};
struct Collector final : canopen::ByteSink {
  AbortCode write(std::span<const std::uint8_t> piece) override {
    expect(bytes.size() + piece.size() <= 16 * longest);
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    return AbortCode::none;
  }
  std::vector<std::uint8_t> bytes;
};

class Pair;

/// One direction of the bus. The input names the next frame that something happens to by its distance.
class Wire final : public can::Sink {
 public:
  explicit Wire(Pair& pair) : pair_(&pair) {}
  bool send(const can::Frame& frame) override;

  std::deque<can::Frame> frames;

 private:
  Pair* pair_;
};

class Pair final : canopen::SdoClientListener {
 public:
  explicit Pair(Input& input) : input_(input), node_(description(), server_id, to_client_, options(input)) {
    node_.attach(stream_object, stream_object, stream_);
    node_.power_on(now_);
    to_client_.frames.clear();
    client_.set_server(server_id);
    plan_disturbance();
  }

  void run() {
    for (unsigned transfers = 0; transfers < 6 && !input_.empty(); ++transfers) transfer();
  }

  /// What happens to the next frame; called for each one.
  bool pass(std::deque<can::Frame>& frames, can::Frame frame) {
    ++sent_;
    expect(sent_ < 200'000);
    if (frames_to_disturbance_ != 0 || !disturbed_) {
      if (disturbed_) --frames_to_disturbance_;
      frames.push_back(frame);
      return true;
    }
    ++disturbances_;
    bool accepted = true;
    switch (input_.choice(7)) {
      case 0: break;  // lost
      case 1:
        frames.push_back(frame);
        frames.push_back(frame);
        break;
      case 2:  // before the one that was sent before it
        frames.push_back(frame);
        if (frames.size() >= 2) std::swap(frames.back(), frames[frames.size() - 2]);
        break;
      case 3: accepted = false; break;  // the transmit queue is full
      case 4: {
        changed_ = true;
        const unsigned bit = input_.choice(64);
        frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ 1U << bit % 8);
        frames.push_back(frame);
        break;
      }
      case 5:  // cut short
        changed_ = true;
        frame.dlc = static_cast<std::uint8_t>(input_.choice(8));
        frames.push_back(frame);
        break;
      default: {
        changed_ = true;
        const can::Frame other = input_.frame(frame.identifier);
        frames.push_back(other);
      }
    }
    plan_disturbance();
    return accepted;
  }

 private:
  static canopen::NodeOptions options(Input& input) {
    canopen::NodeOptions options;
    const can::Duration time_outs[] = {1s, 0s, 100ms, 2s};
    options.sdo_server_time_out = input.one_of(time_outs);
    options.sdo_maximum_download = input.flag() ? 1U << 20 : 300;
    options.accepts_short_sdo_requests = input.flag();
    return options;
  }

  void plan_disturbance() {
    disturbed_ = !input_.empty();
    frames_to_disturbance_ = input_.byte();
  }

  void sdo_finished(canopen::SdoClient& client, can::Time) override {
    expect(&client == &client_ && running_ && !client_.busy());
    const can::Frame* const answer = client.short_answer();
    expect(answer == nullptr || (answer->dlc < 8 && client.abort_code() == AbortCode::length_too_low));
    running_ = false;
  }

  void transfer() {
    constexpr std::uint16_t objects[] = {number_object,     number_object + 1, number_object + 2,
                                         number_object + 3, number_object + 4, octets_object,
                                         domain_object,     stream_object};
    const std::uint16_t index = input_.one_of(objects);
    const std::uint8_t how = input_.byte();
    const bool is_number = index < octets_object;
    constexpr std::size_t number_lengths[] = {1, 2, 3, 4, 8};
    constexpr std::size_t lengths[] = {0,  1,   2,   3,   4,   5,   6,   7,    8,    13,   14,   15,
                                       20, 100, 300, 301, 888, 889, 890, 1024, 1778, 1779, 2000, 4000};
    const std::size_t length = is_number && (how & 0x40) == 0 ? number_lengths[index - number_object]
                                                              : lengths[input_.byte() % std::size(lengths)];
    const auto value = std::span(pattern()).subspan(input_.choice(16), length);
    const bool upload = (how & 1) != 0;
    const bool streams = (how & 2) != 0;
    const auto mode = (how & 4) != 0 ? canopen::SdoClient::Mode::block : canopen::SdoClient::Mode::segmented;
    const std::optional<std::uint32_t> announced =
        (how & 8) != 0 ? std::nullopt : std::optional(static_cast<std::uint32_t>(length));
    stream_.size_known = (how & 16) != 0;
    client_.set_maximum_size((how & 32) != 0 ? 200 : 0);

    changed_ = false;
    if (upload && !stream_.reading && !stream_.writing) put(index, value);
    const std::vector<std::uint8_t> before = held(index);
    Source source;
    source.rest = value;
    Collector collector;
    running_ = true;
    const can::Time began = now_;
    const unsigned disturbances_before = disturbances_;
    bool started;
    if (upload) {
      started = client_.upload(index, 0, *this, now_, client_time_out, mode, streams ? &collector : nullptr);
    } else if (streams) {
      started = client_.download(index, 0, source, announced, *this, now_, client_time_out, mode);
    } else {
      started = client_.download(index, 0, value, *this, now_, client_time_out, mode);
    }
    if (!started) {
      expect(!client_.busy());
      running_ = false;
    }
    const unsigned frames_before = sent_;
    while (running_) {
      step();
      const auto patience = client_time_out * (disturbances_ - disturbances_before + 2) +
                            frame_time * 4 * (sent_ - frames_before + 16);
      expect(now_ - began <= patience);
    }
    expect(!client_.busy() && client_.deadline() == can::never);
    const bool success = started && client_.abort_code() == AbortCode::none;
    if (success && !changed_) {
      if (upload) {
        const std::span<const std::uint8_t> got = streams ? collector.bytes : client_.data();
        expect(std::ranges::equal(got, before));
      } else {
        expect(std::ranges::equal(held(index), value));
      }
    }
    // What is still under way arrives, so that the next transfer does not take it for its own.
    while (!to_server_.frames.empty() || !to_client_.frames.empty()) step();
  }

  void put(std::uint16_t index, std::span<const std::uint8_t> value) {
    if (index == stream_object) {
      stream_.content.assign(value.begin(), value.end());
      return;
    }
    const canopen::Entry entry = node_.dictionary().description().find(index, 0);
    const std::size_t fixed = entry.description->length;
    node_.dictionary().assign(entry, fixed != 0 ? value.first(std::min(value.size(), fixed)) : value);
  }
  [[nodiscard]] std::vector<std::uint8_t> held(std::uint16_t index) const {
    if (index == stream_object) return stream_.content;
    const auto bytes = node_.dictionary().bytes(node_.dictionary().description().find(index, 0));
    return {bytes.begin(), bytes.end()};
  }

  /// The next frame of either direction arrives; without one, time goes on to the next deadline.
  void step() {
    if (!to_server_.frames.empty()) {
      const can::Frame frame = to_server_.frames.front();
      to_server_.frames.pop_front();
      now_ += frame_time;
      node_.receive(frame, now_);
    }
    if (!to_client_.frames.empty()) {
      const can::Frame frame = to_client_.frames.front();
      to_client_.frames.pop_front();
      now_ += frame_time;
      client_.receive(frame, now_);
    }
    if (to_server_.frames.empty() && to_client_.frames.empty() && running_) {
      const can::Time next = std::min(client_.deadline(), node_.deadline());
      expect(next != can::never && client_.deadline() != can::never);
      now_ = std::max(now_, next);
    }
    for (unsigned ticks = 0; client_.deadline() <= now_; ++ticks) {
      expect(ticks < 8);
      client_.tick(now_);
    }
    for (unsigned ticks = 0; node_.deadline() <= now_; ++ticks) {
      expect(ticks < 8);
      node_.tick(now_);
    }
  }

  Input& input_;
  can::Time now_{};
  Wire to_server_{*this};
  Wire to_client_{*this};
  Stream stream_;
  canopen::Node node_;
  canopen::SdoClient client_{to_server_};
  bool running_ = false;
  bool changed_ = false;
  bool disturbed_ = false;
  unsigned frames_to_disturbance_ = 0;
  unsigned disturbances_ = 0;
  unsigned sent_ = 0;
};

bool Wire::send(const can::Frame& frame) {
  fuzz::expect_well_formed(frame);
  return pair_->pass(frames, frame);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  Pair(input).run();
  return 0;
}
