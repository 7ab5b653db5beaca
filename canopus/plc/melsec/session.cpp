#include "canopus/plc/melsec/session.hpp"

#include <cstring>

namespace canopus::plc::melsec {

namespace {

constexpr std::uint8_t own_network = 0x00;
constexpr std::uint8_t own_pc = 0xFF;
constexpr std::uint16_t control_cpu = 0x03FF;
constexpr std::uint16_t first_cpu = 0x03E0;

bool is_for_this_cpu(const Route& route) {
  return route.network == own_network && route.pc == own_pc && route.station == 0 &&
         (route.module_io == control_cpu || route.module_io == first_cpu);
}

}  // namespace

std::size_t Session::process(can::Time now) {
  std::size_t answered = 0;
  std::size_t used = 0;
  while (!over_ && used < input_size_ && output_capacity - output_size_ >= maximum_reply) {
    const auto waiting = std::span<const std::uint8_t>(input_).subspan(used, input_size_ - used);
    if (!code_) code_ = data_code_of(waiting[0]);
    if (!code_) {
      over_ = true;
      break;
    }
    const HeaderResult head = read_header(waiting, *code_);
    if (head.state == HeaderResult::State::incomplete) break;
    if (head.state == HeaderResult::State::malformed) {
      over_ = true;
      break;
    }
    const std::size_t length = head.header.length;
    if (length > maximum_length) {
      refuse(head.header, {}, *code_ == DataCode::ascii ? EndCode::text_length : EndCode::data_length);
      ++answered;
      over_ = true;
      break;
    }
    if (waiting.size() < head.size + length) break;
    answer(head.header, waiting.subspan(head.size, length), now);
    ++answered;
    used += head.size + length;
  }
  if (over_) used = input_size_;
  if (used != 0) std::memmove(input_.data(), input_.data() + used, input_size_ - used);
  input_size_ -= used;
  return answered;
}

void Session::sent(std::size_t count) noexcept {
  output_sent_ += count;
  if (output_sent_ != output_size_) return;
  output_sent_ = 0;
  output_size_ = 0;
}

void Session::answer(const FrameHeader& header, std::span<const std::uint8_t> body, can::Time now) {
  FieldReader reader(body, *code_);
  (void)reader.u16();  // monitoring timer: the answer is immediate
  const Command command{reader.u16(), reader.u16()};
  if (reader.fault() != FieldReader::Fault::none) {
    const bool wrong_text = reader.fault() == FieldReader::Fault::not_a_number;
    const EndCode wrong_length = *code_ == DataCode::ascii ? EndCode::text_length : EndCode::data_length;
    refuse(header, {}, wrong_text ? EndCode::not_convertible : wrong_length);
    return;
  }
  if (!is_for_this_cpu(header.route)) {
    refuse(header, command, EndCode::other_target);
    return;
  }
  FieldWriter writer{std::span{output_}.subspan(output_size_), *code_};
  const std::size_t length_at = begin_reply(writer, header, EndCode::completed);
  const EndCode end_code = commands_.execute(command, reader, writer, now);
  if (end_code != EndCode::completed) {
    refuse(header, command, end_code);
    return;
  }
  end_reply(writer, length_at);
  output_size_ += writer.size();
}

void Session::refuse(const FrameHeader& header, const Command& command, EndCode end_code) {
  FieldWriter writer{std::span{output_}.subspan(output_size_), *code_};
  const std::size_t length_at = begin_reply(writer, header, end_code);
  write_error_information(writer, header.route, command);
  end_reply(writer, length_at);
  output_size_ += writer.size();
}

}  // namespace canopus::plc::melsec
