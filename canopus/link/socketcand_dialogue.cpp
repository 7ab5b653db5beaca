#include "canopus/link/socketcand_dialogue.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "canopus/ascii/hex.hpp"
#include "canopus/ascii/number.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/link/controller_status.hpp"
#include "canopus/link/socketcand_words.hpp"

namespace canopus::link {
namespace {

/// No element of a server is longer; more without an end is no socketcand server.
constexpr std::size_t longest_element = 512;

/// The printable characters of the server's bytes.
std::string printable(std::string_view text) {
  std::string shown(text.substr(0, 40));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return shown;
}

}  // namespace

std::size_t write_socketcand_send(std::span<char, socketcand_max_send> out,
                                  const can::Frame& frame) noexcept {
  const std::string_view start = frame.remote ? "< sendrtr " : "< send ";
  char* p = std::ranges::copy(start, out.data()).out;
  p = ascii::write_hex(p, frame.identifier, frame.extended ? 8 : 3);
  *p++ = ' ';
  *p++ = static_cast<char>('0' + std::min<unsigned>(frame.dlc, 8));
  for (const std::uint8_t byte : frame.bytes()) {
    *p++ = ' ';
    p = ascii::write_hex(p, byte, byte >= 0x10 ? 2 : 1);
  }
  *p++ = ' ';
  *p++ = '>';
  return static_cast<std::size_t>(p - out.data());
}

SocketcandDialogue::SocketcandDialogue(std::string bus_name, Peer& peer)
    : bus_name_(std::move(bus_name)), peer_(peer) {}

void SocketcandDialogue::receive(std::string_view bytes) {
  if (state_ == State::failed) return;
  input_.append(bytes);
  std::size_t used = 0;
  while (state_ != State::failed) {
    while (used < input_.size() && is_blank(input_[used])) ++used;
    if (used == input_.size()) break;
    if (input_[used] != '<') {
      fail("this is no socketcand server: it says \"" + printable(std::string_view(input_).substr(used)) +
           '"');
      break;
    }
    const std::size_t end = input_.find('>', used);
    if (std::min(end, input_.size()) - used >= longest_element) {
      fail("this is no socketcand server: what it says has no end");
      break;
    }
    if (end == std::string::npos) break;  // the rest is still to come
    const std::string_view text(input_.data() + used + 1, end - used - 1);
    used = end + 1;
    element(ascii::trim(text, is_blank));
  }
  if (state_ == State::failed) {
    input_.clear();
  } else {
    input_.erase(0, used);
  }
}

void SocketcandDialogue::request_bit_rate(std::uint32_t bit_rate) {
  bit_rate_asked_ = true;
  peer_.message("< " + bus_name_ + (bus_name_.empty() ? "B " : " B ") + std::to_string(bit_rate) + " >");
}

void SocketcandDialogue::element(std::string_view text) {
  std::string_view rest = text;
  const std::string_view word = next_word(rest);
  switch (state_) {
    case State::greeting:
      if (word != "hi") return fail("expected its greeting, found \"" + printable(text) + '"');
      state_ = State::opening;
      return peer_.message(bus_name_.empty() ? std::string("< open >") : "< open " + bus_name_ + " >");
    case State::opening:
      if (word == "ok") {
        state_ = State::entering_raw;
        return peer_.message("< rawmode >");
      }
      if (bus_name_.empty()) return fail("the server wants the name of the bus: socketcand:HOST:PORT/BUS");
      return fail("the server does not open the bus \"" + bus_name_ + "\": " + printable(text));
    case State::entering_raw:
      if (word != "ok") return fail("the server does not give the frames of the bus: " + printable(text));
      state_ = State::raw;
      return;
    case State::raw:
      if (word == "frame") return frame(rest);
      if (word == "error") return error_element(ascii::trim(rest, is_blank));
      if (word == "echo") return peer_.echoed();
      if (word == "ok" && std::exchange(bit_rate_asked_, false)) return peer_.bit_rate_changed();
      return;  // answers to nothing we asked
    case State::failed: return;
  }
}

// `581 12.000345 4318100101000000`; some servers put blanks between the bytes.
void SocketcandDialogue::frame(std::string_view arguments) {
  const std::string_view identifier_word = next_word(arguments);
  const auto identifier = ascii::parse_number<std::uint32_t>(identifier_word, 16);
  can::Frame frame{.extended = identifier_word.size() == 8};
  (void)next_word(arguments);  // the server's time
  const std::uint32_t highest = frame.extended ? can::max_extended_identifier : can::max_base_identifier;
  bool good = identifier && *identifier <= highest;
  for (std::string_view word = next_word(arguments); good && !word.empty(); word = next_word(arguments)) {
    for (; good && !word.empty(); word.remove_prefix(std::min<std::size_t>(2, word.size()))) {
      const auto byte = ascii::byte_of_hex(word.substr(0, 2));
      good = byte && frame.dlc < 8;
      if (good) frame.data[frame.dlc++] = *byte;
    }
  }
  if (!good) return peer_.complaint("a frame that cannot be read");
  frame.identifier = *identifier;
  reported_error_ = {};
  peer_.frame_received(frame);
}

// Words, or an error frame of the server's CAN interface: `020 12.000345`.
void SocketcandDialogue::error_element(std::string_view arguments) {
  std::string_view rest = arguments;
  const std::string_view class_word = next_word(rest);
  const auto error_class = ascii::parse_number<std::uint32_t>(class_word, 16);
  const std::string_view time = next_word(rest);
  const bool is_error_frame = error_class && class_word.size() >= 3 && rest.empty() &&
                              time.find('.') != std::string_view::npos &&
                              time.find_first_not_of("0123456789.") == std::string_view::npos;
  if (!is_error_frame && bit_rate_asked_ &&
      (arguments.starts_with("B:") || arguments.contains("unknown command"))) {
    bit_rate_asked_ = false;
    return peer_.bit_rate_refused(arguments);
  }
  if (!is_error_frame) return peer_.complaint(arguments);
  peer_.controller_error(*error_class);
  const std::string_view sentence = describe_error_frame(*error_class, {});
  if (sentence.empty() || sentence == reported_error_) return;
  reported_error_ = sentence;
  peer_.complaint(sentence);
}

void SocketcandDialogue::fail(std::string text) {
  error_ = std::move(text);
  state_ = State::failed;
}

}  // namespace canopus::link
