#include "canopus/plc/modbus/session.hpp"

#include <algorithm>
#include <cstring>

#include "canopus/plc/modbus/rtu_frame.hpp"

namespace canopus::plc::modbus {

namespace {

constexpr std::size_t fixed_size = 6;  // of the header, up to its length field
constexpr std::size_t unit_at = 6;
/// These two address the server of the port itself. [Modbus Messaging on TCP/IP V1.0b 4.4.2.1]
constexpr std::uint8_t unit_none = 0xFF;
constexpr std::uint8_t unit_broadcast = 0x00;

}  // namespace

Session::Head Session::head_of(std::span<const std::uint8_t> waiting) const noexcept {
  if (settings_.framing == Framing::rtu) {
    const RtuSize size = rtu_request_size(waiting);
    if (!size.is_known) return {.is_complete = size.is_none, .size = 0};
    if (waiting.size() < size.bytes) return {.is_complete = false, .size = size.bytes};
    return {.is_complete = true, .size = has_good_crc(waiting.first(size.bytes)) ? size.bytes : 0};
  }
  // A client that begins with RTU frames would be waited for, as their numbers pass for a header.
  if (!has_answered_ && is_rtu_request(waiting)) return {.is_complete = true, .size = 0};
  if (waiting.size() < fixed_size) return {};
  const unsigned protocol = word_at(waiting, 2);
  const std::size_t length = word_at(waiting, 4);
  if (protocol != 0 || length < 2 || length > 1 + maximum_pdu) return {.is_complete = true, .size = 0};
  return {.is_complete = waiting.size() >= fixed_size + length, .size = fixed_size + length};
}

std::string_view Session::refusal_of(std::span<const std::uint8_t> waiting) const noexcept {
  if (settings_.framing == Framing::rtu)
    return "sent no RTU frame with a good CRC: this port has framing = \"rtu\", clients of Modbus TCP need "
           "another";
  if (!has_answered_ && is_rtu_request(waiting))
    return "sent Modbus RTU, whose frames have no MBAP header: that takes a port with framing = \"rtu\"";
  return {};
}

bool Session::has_request() const noexcept {
  return !over_ && head_of(std::span(input_).first(input_size_)).is_complete;
}

std::size_t Session::process(can::Time now) {
  std::size_t answered = 0;
  std::size_t used = 0;
  while (!over_ && output_capacity - output_size_ >= maximum_frame) {
    const auto waiting = std::span<const std::uint8_t>(input_).subspan(used, input_size_ - used);
    const Head head = head_of(waiting);
    if (!head.is_complete) break;
    if (head.size == 0) {
      over_ = true;
      refusal_ = refusal_of(waiting);
      break;
    }
    has_answered_ = true;
    answer(waiting.first(head.size), now);
    ++answered;
    used += head.size;
  }
  if (over_) used = input_size_;
  if (used != 0) std::memmove(input_.data(), input_.data() + used, input_size_ - used);
  input_size_ -= used;
  return answered;
}

void Session::answer(std::span<const std::uint8_t> frame, can::Time now) {
  return settings_.framing == Framing::rtu ? answer_rtu(frame, now) : answer_mbap(frame, now);
}

void Session::answer_rtu(std::span<const std::uint8_t> frame, can::Time now) {
  constexpr std::size_t crc_size = 2;
  const std::uint8_t unit = frame[0];
  if (settings_.unit && unit != *settings_.unit && unit != unit_broadcast) return;
  const std::span<std::uint8_t> out = std::span(output_).subspan(output_size_, maximum_frame);
  out[0] = unit;
  const auto pdu = out.subspan<1, maximum_pdu>();
  const auto request = frame.subspan(1, frame.size() - 1 - crc_size);
  const std::size_t size = 1 + functions_.execute(request, pdu, permission_, now);
  if (unit == unit_broadcast) return;
  const std::uint16_t crc = rtu_crc(out.first(size));
  out[size] = static_cast<std::uint8_t>(crc);
  out[size + 1] = static_cast<std::uint8_t>(crc >> 8U);
  output_size_ += size + crc_size;
}

void Session::answer_mbap(std::span<const std::uint8_t> frame, can::Time now) {
  const std::span<std::uint8_t> out = std::span(output_).subspan(output_size_, maximum_frame);
  std::ranges::copy(frame.first(header_size), out.begin());
  const auto pdu = out.subspan<header_size, maximum_pdu>();
  const std::uint8_t unit = frame[unit_at];
  std::size_t size = 2;
  if (settings_.unit && unit != *settings_.unit && unit != unit_none && unit != unit_broadcast) {
    pdu[0] = static_cast<std::uint8_t>(frame[header_size] | 0x80U);
    pdu[1] = static_cast<std::uint8_t>(Exception::target_failed_to_respond);
  } else {
    size = functions_.execute(frame.subspan(header_size), pdu, permission_, now);
  }
  out[4] = static_cast<std::uint8_t>((size + 1) >> 8U);
  out[5] = static_cast<std::uint8_t>(size + 1);
  output_size_ += header_size + size;
}

void Session::sent(std::size_t count) noexcept {
  output_sent_ += count;
  if (output_sent_ != output_size_) return;
  output_sent_ = 0;
  output_size_ = 0;
}

}  // namespace canopus::plc::modbus
