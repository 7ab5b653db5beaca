#pragma once
// One client's conversation: bytes in, bytes out. No socket, no clock, no thread; memory is fixed when it
// begins and nothing is allocated afterwards.
//
// The owner puts received bytes into space(), says how many with received(), and lets process() answer every
// complete request. What is in output() is to be sent, then sent() says so. A client that does not take its
// replies fills output() and is not answered further until it does: it blocks nobody else.
//
// The data code is that of the connection's first byte and stays. A request whose beginning is no request's,
// or whose length no request can have, makes the rest of the stream unreadable: the session is over() then,
// and the connection is to be closed when output() is sent. Any other mistake is answered with an end code.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopus/plc/melsec/commands.hpp"

namespace canopus::plc::melsec {

class Session {
 public:
  /// Largest `length` field of a request that is read to its end. The largest that can be executed is 1406 in
  /// ASCII with 5292 characters.
  static constexpr std::size_t maximum_length = 6144;

  explicit Session(Rack& rack) noexcept : commands_(rack) {}

  /// Where the next bytes go; never empty after process() unless output() is waiting to be sent.
  [[nodiscard]] std::span<std::uint8_t> space() noexcept { return std::span(input_).subspan(input_size_); }
  void received(std::size_t count) noexcept { input_size_ += count; }

  /// Answers complete requests, in order, while output has room. Returns how many it answered.
  std::size_t process(can::Time now);

  [[nodiscard]] std::span<const std::uint8_t> output() const noexcept {
    return std::span(output_).subspan(output_sent_, output_size_ - output_sent_);
  }
  void sent(std::size_t count) noexcept;

  /// The stream cannot be read any further.
  [[nodiscard]] bool over() const noexcept { return over_; }
  /// A request has begun but is not complete.
  [[nodiscard]] bool half_request() const noexcept { return input_size_ != 0 && !over_; }

 private:
  static constexpr std::size_t input_capacity = 16384;
  static constexpr std::size_t output_capacity = 65536;
  static constexpr std::size_t maximum_reply = maximum_reply_data + 64;  // with its header

  void answer(const FrameHeader& header, std::span<const std::uint8_t> body, can::Time now);
  void refuse(const FrameHeader& header, const Command& command, EndCode end_code);

  Commands commands_;
  std::optional<DataCode> code_;
  bool over_ = false;
  std::size_t input_size_ = 0;
  std::size_t output_size_ = 0;
  std::size_t output_sent_ = 0;
  std::array<std::uint8_t, input_capacity> input_{};
  std::array<std::uint8_t, output_capacity> output_{};
};

}  // namespace canopus::plc::melsec
