#pragma once
// One client's conversation in Modbus TCP: bytes in, bytes out. No socket, no clock, no thread; memory is fixed
// when it begins and nothing is allocated afterwards.
//
//   transaction 2 | protocol 2 (0) | length 2, of what follows | unit identifier 1 | function 1 | data
//
// All numbers high byte first; the reply carries the request's transaction and unit. Requests may be sent one behind
// the other, the replies come in order. A header that is none makes the rest of the stream unreadable: the
// session is over() then. [Modbus Messaging on TCP/IP V1.0b 3.1]
//
// With Framing::rtu the frames are those of a serial line [Modbus over Serial Line V1.02 2.5.1]:
//
//   unit identifier 1 | function 1 | data | CRC 2, low byte first
//
// There are no pauses between frames, so that a request ends where its function says. Unit 0 (all) is carried out without a
// reply, another unit than the port's is ignored.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "canopus/plc/modbus/functions.hpp"

namespace canopus::plc::modbus {

class Session {
 public:
  /// Both must outlive the session. `permission`: of this client.
  Session(Rack& rack, const Settings& settings, WritePermission permission) noexcept
      : settings_(settings), permission_(permission), functions_(rack, settings) {}

  /// Where the next bytes go; never empty after process() unless output() has unsent bytes.
  [[nodiscard]] std::span<std::uint8_t> space() noexcept { return std::span(input_).subspan(input_size_); }
  void received(std::size_t count) noexcept { input_size_ += count; }

  /// process() has something to do: a request is complete, or what has come is none.
  [[nodiscard]] bool has_request() const noexcept;
  /// Answers complete requests, in order, while output has room. Returns how many it answered.
  std::size_t process(can::Time now);

  [[nodiscard]] std::span<const std::uint8_t> output() const noexcept {
    return std::span(output_).subspan(output_sent_, output_size_ - output_sent_);
  }
  void sent(std::size_t count) noexcept;

  /// The stream cannot be read any further.
  [[nodiscard]] bool over() const noexcept { return over_; }
  /// Why it is over, for a report; empty: it is no request at all.
  [[nodiscard]] std::string_view refusal() const noexcept { return refusal_; }
  /// A request has begun but is not complete.
  [[nodiscard]] bool half_request() const noexcept { return input_size_ != 0 && !over_; }

 private:
  static constexpr std::size_t header_size = 7;  // with the unit identifier
  static constexpr std::size_t maximum_frame = header_size + maximum_pdu;
  static constexpr std::size_t input_capacity = 16 * maximum_frame;
  static constexpr std::size_t output_capacity = 64 * maximum_frame;

  /// The request at the front of the input: `size` bytes of a request, or 0 where there is no header of one.
  struct Head {
    bool is_complete = false;
    std::size_t size = 0;
  };
  [[nodiscard]] Head head_of(std::span<const std::uint8_t> waiting) const noexcept;
  [[nodiscard]] std::string_view refusal_of(std::span<const std::uint8_t> waiting) const noexcept;
  /// `frame`: a whole request. The reply goes behind what is in output_.
  void answer(std::span<const std::uint8_t> frame, can::Time now);
  void answer_mbap(std::span<const std::uint8_t> frame, can::Time now);
  void answer_rtu(std::span<const std::uint8_t> frame, can::Time now);

  const Settings& settings_;
  WritePermission permission_;
  Functions functions_;
  bool over_ = false;
  bool has_answered_ = false;  // a request of the port's framing has come
  std::string_view refusal_{};
  std::size_t input_size_ = 0;
  std::size_t output_size_ = 0;
  std::size_t output_sent_ = 0;
  std::array<std::uint8_t, input_capacity> input_{};
  std::array<std::uint8_t, output_capacity> output_{};
};

}  // namespace canopus::plc::modbus
