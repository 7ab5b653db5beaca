#include "canopus/plc/melsec/session.hpp"

#include <algorithm>
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

/// Clients of 1E frames were seen to send small letters, which FX modules take; 3E and 4E take capitals alone.
void capitalize(std::span<std::uint8_t> text) {
  for (std::uint8_t& character : text)
    if (character >= 'a' && character <= 'f') character = static_cast<std::uint8_t>(character - 'a' + 'A');
}

/// Characters of a 1E request in ASCII up to its data, without those of the next request. What a loopback carries
/// comes back as it was.
std::size_t head_of_1e(std::span<const std::uint8_t> text) {
  constexpr std::size_t header = 8;
  if (text.size() < 2) return text.size();
  if (text[0] == '1') return text[1] == '6' ? header + 2 : header;
  if (text[1] == '8' || text[1] == '9') return header;  // reading what is monitored
  const bool is_buffer_memory = text[1] == 'E' || text[1] == 'F' || text[1] == 'e' || text[1] == 'f';
  return is_buffer_memory ? header + 12 : header + 16;
}

}  // namespace

Session::Frame Session::frame_of(std::uint8_t first_byte) {
  if (settings_.takes_3e) {
    if (!code_) code_ = data_code_of(first_byte);
    if (code_ && data_code_of(first_byte) == code_) return Frame::is_3e;
  }
  if (!settings_.takes_1e) return Frame::none;
  const bool may_be_ascii = first_byte >= '0' && first_byte <= '3';  // the first digit of 00 to 3C
  if (!code_) code_ = may_be_ascii ? DataCode::ascii : DataCode::binary;
  if (*code_ == DataCode::ascii) return may_be_ascii ? Frame::is_1e : Frame::none;
  return first_byte <= last_subheader_1e ? Frame::is_1e : Frame::none;
}

bool Session::has_request() {
  if (over_ || input_size_ == 0) return false;
  const auto waiting = std::span(input_).first(input_size_);
  switch (frame_of(waiting[0])) {
    case Frame::is_3e: {
      const HeaderResult& head = head_.emplace(read_header(waiting, *code_));
      if (head.state != HeaderResult::State::complete) return head.state == HeaderResult::State::malformed;
      return head.header.length > maximum_length || waiting.size() >= head.size + head.header.length;
    }
    case Frame::is_1e: return measure_1e(waiting).state != Request1e::State::incomplete;
    case Frame::none: break;
  }
  return true;
}

std::size_t Session::process(can::Time now) {
  std::size_t answered = 0;
  std::size_t used = 0;
  while (!over_ && used < input_size_ && output_capacity - output_size_ >= maximum_reply) {
    const auto waiting = std::span(input_).subspan(used, input_size_ - used);
    const std::size_t waiting_output = output_size_;
    Step step;
    switch (frame_of(waiting[0])) {
      case Frame::is_3e: step = next_3e(head_ ? *head_ : read_header(waiting, *code_), waiting, now); break;
      case Frame::is_1e: step = next_1e(waiting, now); break;
      case Frame::none: step.state = Step::State::unreadable; break;
    }
    if (step.state == Step::State::incomplete) break;
    head_.reset();
    if (output_size_ != waiting_output) ++answered;
    over_ = step.state == Step::State::unreadable;
    used += step.size;
  }
  if (over_) used = input_size_;
  if (used != 0) std::memmove(input_.data(), input_.data() + used, input_size_ - used);
  input_size_ -= used;
  return answered;
}

Session::Step Session::next_3e(const HeaderResult& head, std::span<const std::uint8_t> waiting,
                               can::Time now) {
  if (head.state == HeaderResult::State::incomplete) return {};
  if (head.state == HeaderResult::State::malformed) return {Step::State::unreadable, 0};
  const std::size_t length = head.header.length;
  if (length > maximum_length) {
    refuse(head.header, {}, *code_ == DataCode::ascii ? EndCode::text_length : EndCode::data_length);
    return {Step::State::unreadable, 0};
  }
  if (waiting.size() < head.size + length) return {};
  Step step = answer(head.header, waiting.subspan(head.size, length), now);
  step.size = head.size + length;
  return step;
}

Request1e Session::measure_1e(std::span<std::uint8_t> waiting) {
  if (*code_ == DataCode::ascii) capitalize(waiting.first(std::min(head_of_1e(waiting), waiting.size())));
  return read_request_1e(waiting, *code_, rules_1e_.wide_counters);
}

Session::Step Session::next_1e(std::span<std::uint8_t> waiting, can::Time now) {
  const Request1e request = measure_1e(waiting);
  switch (request.state) {
    case Request1e::State::incomplete: return {};
    case Request1e::State::unknown: refuse_1e(request.subheader, EndCode1e::unknown_subheader); break;
    case Request1e::State::not_a_number: refuse_1e(request.subheader, EndCode1e::not_convertible); break;
    case Request1e::State::complete: {
      const bool is_loopback = request.subheader == static_cast<std::uint8_t>(Command1e::loopback);
      if (*code_ == DataCode::ascii && !is_loopback) capitalize(waiting.first(request.size));
      FieldWriter out = writer();
      commands_1e_.answer(waiting.first(request.size), out, settings_.write, now);
      output_size_ += out.size();
      return {Step::State::answered, request.size};
    }
  }
  return {Step::State::answered, waiting.size()};
}

void Session::datagram(std::span<const std::uint8_t> request, can::Time now) {
  code_ = settings_.code;
  output_size_ = 0;
  output_sent_ = 0;
  if (request.empty()) return;
  switch (frame_of(request[0])) {
    case Frame::none: return;
    case Frame::is_3e: {
      const HeaderResult head = read_header(request, *code_);
      if (head.state != HeaderResult::State::complete) return;
      if (head.header.length > maximum_length || request.size() != head.size + head.header.length) {
        refuse(head.header, {}, *code_ == DataCode::ascii ? EndCode::text_length : EndCode::data_length);
        return;
      }
      (void)answer(head.header, request.subspan(head.size), now);
      return;
    }
    case Frame::is_1e: {
      if (request.size() > input_capacity) return;
      std::ranges::copy(request, input_.begin());
      const auto copy = std::span(input_).first(request.size());
      const Request1e found = measure_1e(copy);
      const bool fits = found.state != Request1e::State::incomplete &&
                        (found.state != Request1e::State::complete || found.size == request.size());
      if (fits)
        (void)next_1e(copy, now);
      else if (request.size() > 1)  // one character is not even a subheader
        refuse_1e(found.subheader, EndCode1e::points);
      return;
    }
  }
}

void Session::sent(std::size_t count) noexcept {
  output_sent_ += count;
  if (output_sent_ != output_size_) return;
  output_sent_ = 0;
  output_size_ = 0;
}

Session::Step Session::answer(const FrameHeader& header, std::span<const std::uint8_t> body, can::Time now) {
  constexpr Step answered{Step::State::answered, 0};
  FieldReader reader(body, *code_);
  (void)reader.u16();  // monitoring timer: the answer is immediate
  const Command command{reader.u16(), reader.u16()};
  if (reader.fault() != FieldReader::Fault::none) {
    const bool wrong_text = reader.fault() == FieldReader::Fault::not_a_number;
    const EndCode wrong_length = *code_ == DataCode::ascii ? EndCode::text_length : EndCode::data_length;
    refuse(header, {}, wrong_text ? EndCode::not_convertible : wrong_length);
    return answered;
  }
  if (!is_for_this_cpu(header.route)) {
    refuse(header, command, EndCode::other_target);
    return answered;
  }
  FieldWriter out = writer();
  const std::size_t length_at = begin_reply(out, header, EndCode::completed);
  const EndCode end_code = commands_.execute(command, reader, out, now);
  if (end_code != EndCode::completed) {
    refuse(header, command, end_code);
    return answered;
  }
  if (commands_.has_reset()) return {Step::State::unreadable, 0};
  end_reply(out, length_at);
  output_size_ += out.size();
  return answered;
}

void Session::refuse_1e(std::uint8_t subheader, EndCode1e end_code) {
  FieldWriter out = writer();
  Commands1e::refuse(subheader, {end_code, AbnormalCode::none}, out);
  output_size_ += out.size();
}

void Session::refuse(const FrameHeader& header, const Command& command, EndCode end_code) {
  FieldWriter out = writer();
  const std::size_t length_at = begin_reply(out, header, end_code);
  write_error_information(out, header.route, command);
  end_reply(out, length_at);
  output_size_ += out.size();
}

}  // namespace canopus::plc::melsec
