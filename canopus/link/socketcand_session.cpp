#include "canopus/link/socketcand_session.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <utility>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/link/socketcand_words.hpp"

namespace canopus::link {
namespace {

using ascii::parse_number;

/// Seconds with six decimals, cut.
char* write_time(char* p, can::Time time) noexcept {
  const auto microseconds = static_cast<std::uint64_t>(std::max<std::int64_t>(
      0, std::chrono::floor<std::chrono::microseconds>(time.time_since_epoch()).count()));
  p = std::to_chars(p, p + 20, microseconds / 1'000'000).ptr;
  *p++ = '.';
  for (std::uint64_t unit = 100'000, rest = microseconds % 1'000'000; unit > 0; unit /= 10) {
    *p++ = static_cast<char>('0' + rest / unit % 10);
  }
  return p;
}

}  // namespace

std::size_t write_socketcand_error(std::span<char, socketcand_max_message> out, std::uint32_t error_class,
                                   can::Time time) noexcept {
  constexpr std::string_view start = "< error ";
  char* p = std::ranges::copy(start, out.data()).out;
  p = ascii::write_hex(p, error_class, 3);
  *p++ = ' ';
  p = write_time(p, time);
  *p++ = ' ';
  *p++ = '>';
  return static_cast<std::size_t>(p - out.data());
}

std::size_t write_socketcand_frame(std::span<char, socketcand_max_message> out, const can::Frame& frame,
                                   can::Time time) noexcept {
  constexpr std::string_view start = "< frame ";
  char* p = std::ranges::copy(start, out.data()).out;
  p = ascii::write_hex(p, frame.identifier, frame.extended ? 8 : 3);
  *p++ = ' ';
  p = write_time(p, time);
  *p++ = ' ';
  for (const std::uint8_t byte : frame.bytes()) p = ascii::write_hex(p, byte, 2);
  *p++ = ' ';
  *p++ = '>';
  return static_cast<std::size_t>(p - out.data());
}

SocketcandSession::SocketcandSession(std::string bus_name, can::Sink& bus, Peer& peer)
    : bus_name_(std::move(bus_name)), bus_(bus), peer_(peer) {}

void SocketcandSession::start() { peer_.message("< hi >"); }

void SocketcandSession::receive(std::string_view bytes) {
  if (state_ == State::closed) return;
  input_.append(bytes);
  read_input();
}

void SocketcandSession::resume() {
  if (!refused_ || state_ == State::closed) return;
  if (!bus_.send(*refused_)) return;
  refused_.reset();
  read_input();
}

void SocketcandSession::drop_waiting() {
  while (refused_ && state_ != State::closed) {
    refused_.reset();
    ++frames_dropped_;
    read_input();
  }
}

void SocketcandSession::drop() {
  if (state_ == State::closed || state_ == State::dropped) return;
  state_ = State::dropped;
  if (refused_) ++frames_dropped_;
  refused_.reset();
  read_input();
}

void SocketcandSession::read_input() {
  std::size_t used = 0;
  while (!refused_ && state_ != State::closed) {
    used = static_cast<std::size_t>(
        std::find_if_not(input_.begin() + static_cast<std::ptrdiff_t>(used), input_.end(), is_blank) -
        input_.begin());
    if (used == input_.size()) break;
    if (input_[used] != '<') {
      close_with("< error expected an element in angle brackets >");
      break;
    }
    const std::size_t end = input_.find_first_of("<>", used + 1);
    if (std::min(end, input_.size()) - used >= socketcand_max_element) {
      close_with("< error element longer than 128 characters >");
      break;
    }
    if (end == std::string::npos) break;  // the rest of the element is still to come
    if (input_[end] == '<') {
      error("expected a closing bracket, found another opening one");
      used = end;
      continue;
    }
    const std::string_view text(input_.data() + used + 1, end - used - 1);
    used = end + 1;
    element(text);
  }
  if (state_ == State::closed) {
    input_.clear();
  } else {
    input_.erase(0, used);
  }
}

void SocketcandSession::element(std::string_view text) {
  const std::string_view command = take_word(text);
  std::string_view rest = text;
  const std::string_view second = take_word(rest);
  const bool alone = second.empty();
  if (state_ != State::dropped && state_ != State::closed) {
    if (command == bus_name_ && second == "B") return set_bit_rate(rest);
    if (command == "B") return set_bit_rate(text);
  }
  switch (state_) {
    case State::no_bus:
      if (command != "open") return error("unknown command, expected open");
      if (const auto name = take_word(text);
          (!name.empty() && name != bus_name_) || !take_word(text).empty()) {
        return close_with("< error could not open bus >");
      }
      state_ = State::quiet;
      return peer_.message("< ok >");
    case State::quiet:
    case State::raw:
      if (command == "send") return send(text, false);
      if (command == "sendrtr") return send(text, true);
      if (command == "echo" && alone) return peer_.message("< echo >");
      if (command == "rawmode" && alone) {
        state_ = State::raw;
        return peer_.message("< ok >");
      }
      if (command == "bcmmode" && alone) {
        state_ = State::quiet;
        return peer_.message("< ok >");
      }
      return error("unknown command");
    case State::dropped:
      if (command == "send" || command == "sendrtr") ++frames_dropped_;
      return;
    case State::closed: return;
  }
}

// Behind the bit rate there may be the sample point and the parts of a bit, which a simulated bus has not.
void SocketcandSession::set_bit_rate(std::string_view arguments) {
  const auto bit_rate = parse_number<std::uint32_t>(take_word(arguments));
  if (!bit_rate || std::ranges::find(can::bit_rates, *bit_rate) == std::end(can::bit_rates)) {
    return error("B: expected 10000 to 1000000 bit/s, of those that CAN networks have");
  }
  if (!peer_.restart(*bit_rate)) return error("B: the bit rate of this bus is not set from here");
  peer_.message("< ok >");
}

void SocketcandSession::send(std::string_view arguments, bool remote) {
  can::Frame frame{.remote = remote};
  const std::string_view identifier_word = take_word(arguments);
  const auto identifier = parse_number<std::uint32_t>(identifier_word, 16);
  if (!identifier || identifier_word.size() > 8) {
    return error("send: expected an identifier of 1 to 8 hexadecimal digits");
  }
  frame.extended = identifier_word.size() == 8;
  if (*identifier > (frame.extended ? can::max_extended_identifier : can::max_base_identifier)) {
    return error("send: expected an identifier up to 7FF, or of 8 digits up to 1FFFFFFF");
  }
  frame.identifier = *identifier;

  const auto length = parse_number<std::uint8_t>(take_word(arguments));
  if (!length || *length > 8) return error("send: expected a length of 0 to 8");
  frame.dlc = *length;

  for (std::uint8_t& byte : std::span(frame.data).first(frame.length())) {
    const auto value = parse_number<std::uint8_t>(take_word(arguments), 16);
    if (!value) return error("send: expected as many bytes as the length says, 0 to FF");
    byte = *value;
  }
  if (!take_word(arguments).empty()) return error("send: expected no more bytes than the length says");
  if (!bus_.send(frame)) refused_ = frame;
}

void SocketcandSession::error(std::string_view text) {
  if (state_ == State::dropped) return;
  std::array<char, socketcand_max_message> message;
  char* p = std::ranges::copy(std::string_view("< error "), message.data()).out;
  p = std::ranges::copy(text.substr(0, message.size() - 10), p).out;
  p = std::ranges::copy(std::string_view(" >"), p).out;
  peer_.message({message.data(), p});
}

void SocketcandSession::close_with(std::string_view text) {
  peer_.message(text);
  state_ = State::closed;
}

}  // namespace canopus::link
