#pragma once
// One client's conversation, in 3E, 4E and 1E frames: bytes in, bytes out. No socket, no clock, no thread; memory is fixed when it
// begins and nothing is allocated afterwards.
//
// The owner writes received bytes into space(), calls received() with their number, and process() answers
// every complete request. The owner sends the bytes of output() and calls sent(). A client that does not read
// its replies fills output() and gets no further replies until it reads: it does not block other clients.
//
// The data code is the port's, or that of the connection's first byte, and stays. A request whose beginning
// is no request's, or whose length no request can have, makes the rest of the stream unreadable, and a CPU
// reset discards it: the session is over() then, and the owner closes the connection when output() is sent.
// Any other mistake is answered with an end code.
//
// 1E frames have no length. Behind one that cannot be measured (an unknown subheader, ASCII that is no number) all
// that has been received counts as its rest.
//
// UDP: a datagram is one request, and datagram() answers it. What has no header, or is of another frame or code than the
// port takes, gets no answer.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "canopus/plc/melsec/commands.hpp"
#include "canopus/plc/melsec/commands_1e.hpp"
#include "canopus/plc/melsec/port_settings.hpp"

namespace canopus::plc::melsec {

class PasswordGuard;

class Session {
 public:
  /// Largest `length` field of a request that is read to its end. The largest that can be executed is 1406 in
  /// ASCII with 5292 characters.
  static constexpr std::size_t maximum_length = 6144;

  /// `rack` and `guard` must outlive the session; `settings` are those of the port, for this client.
  explicit Session(Rack& rack, PortSettings settings = {}, PasswordGuard* guard = nullptr)
      : settings_(std::move(settings)),
        code_(settings_.code),
        commands_(rack, settings_, guard),
        rules_1e_(rules_1e_of(rack.model())),
        commands_1e_(rack, rules_1e_) {}
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Where the next bytes go; never empty after process() unless output() has unsent bytes.
  [[nodiscard]] std::span<std::uint8_t> space() noexcept { return std::span(input_).subspan(input_size_); }
  void received(std::size_t count) noexcept {
    input_size_ += count;
    head_.reset();
  }

  /// process() has something to do: a request is complete, or what has come is none.
  [[nodiscard]] bool has_request();
  /// Answers complete requests, in order, while output has room. Returns how many it answered.
  std::size_t process(can::Time now);

  /// Answers one datagram; output() is its reply, or empty. For sessions that receive nothing else.
  void datagram(std::span<const std::uint8_t> request, can::Time now);

  [[nodiscard]] std::span<const std::uint8_t> output() const noexcept {
    return std::span(output_).subspan(output_sent_, output_size_ - output_sent_);
  }
  void sent(std::size_t count) noexcept;

  /// The stream cannot be read any further, or the CPU was reset.
  [[nodiscard]] bool over() const noexcept { return over_; }
  /// A request has begun but is not complete.
  [[nodiscard]] bool half_request() const noexcept { return input_size_ != 0 && !over_; }

 private:
  static constexpr std::size_t input_capacity = 16384;
  static constexpr std::size_t output_capacity = 65536;
  static constexpr std::size_t maximum_reply = maximum_reply_data + 64;  // with its header

  /// The result for the bytes at the front of the input.
  struct Step {
    enum class State : std::uint8_t { incomplete, answered, unreadable } state = State::incomplete;
    std::size_t size = 0;  // of the request
  };
  enum class Frame : std::uint8_t { none, is_3e, is_1e };

  /// The frame that begins so on this port, and the data code, where that is still open.
  [[nodiscard]] Frame frame_of(std::uint8_t first_byte);
  /// The length of the 1E request in front. In ASCII its letters become capitals.
  [[nodiscard]] Request1e measure_1e(std::span<std::uint8_t> waiting);
  Step next_3e(const HeaderResult& head, std::span<const std::uint8_t> waiting, can::Time now);
  Step next_1e(std::span<std::uint8_t> waiting, can::Time now);
  Step answer(const FrameHeader& header, std::span<const std::uint8_t> body, can::Time now);
  void refuse(const FrameHeader& header, const Command& command, EndCode end_code);
  void refuse_1e(std::uint8_t subheader, EndCode1e end_code);
  [[nodiscard]] FieldWriter writer() noexcept { return {std::span(output_).subspan(output_size_), *code_}; }

  PortSettings settings_;
  std::optional<DataCode> code_;
  std::optional<HeaderResult> head_;  // of the 3E or 4E request in front, as has_request() found it
  Commands commands_;
  const Rules1e& rules_1e_;
  Commands1e commands_1e_;
  bool over_ = false;
  std::size_t input_size_ = 0;
  std::size_t output_size_ = 0;
  std::size_t output_sent_ = 0;
  std::array<std::uint8_t, input_capacity> input_{};
  std::array<std::uint8_t, output_capacity> output_{};
};

}  // namespace canopus::plc::melsec
