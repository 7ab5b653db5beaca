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

/// `text` begins with an element.
std::size_t element_limit(std::string_view text) noexcept {
  text.remove_prefix(1);
  return next_word(text) == "muxfilter" ? socketcand_max_muxfilter : socketcand_max_element;
}

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
                                   can::Time time, SocketcandData data) noexcept {
  constexpr std::string_view start = "< frame ";
  char* p = std::ranges::copy(start, out.data()).out;
  p = ascii::write_hex(p, frame.identifier, frame.extended ? 8 : 3);
  *p++ = ' ';
  p = write_time(p, time);
  *p++ = ' ';
  const bool is_apart = data == SocketcandData::apart && frame.length() != 0;
  for (const std::uint8_t byte : frame.bytes()) {
    p = ascii::write_hex(p, byte, 2);
    if (is_apart) *p++ = ' ';
  }
  if (!is_apart) *p++ = ' ';
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
  manager_.clear();
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
    if (std::min(end, input_.size()) - used >= element_limit(std::string_view(input_).substr(used))) {
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
  const std::string_view command = next_word(text);
  std::string_view rest = text;
  const std::string_view second = next_word(rest);
  const bool alone = second.empty();
  if (state_ != State::dropped && state_ != State::closed) {
    if (command == bus_name_ && second == "B") return set_bit_rate(rest);
    if (command == "B") return set_bit_rate(text);
  }
  switch (state_) {
    case State::no_bus:
      if (command != "open") {
        if (!refuse(command)) error("unknown command, expected open");
        return;
      }
      if (const auto name = next_word(text);
          (!name.empty() && name != bus_name_) || !next_word(text).empty()) {
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
        manager_.clear();
        return peer_.message("< ok >");
      }
      if (command == "bcmmode" && alone) {
        state_ = State::quiet;
        return peer_.message("< ok >");
      }
      if (manage(command, text) || refuse(command)) return;
      return error("unknown command");
    case State::dropped:
      if (command == "send" || command == "sendrtr") ++frames_dropped_;
      return;
    case State::closed: return;
  }
}

// Behind the bit rate there may be the sample point and the parts of a bit, which a simulated bus has not.
void SocketcandSession::set_bit_rate(std::string_view arguments) {
  const auto bit_rate = parse_number<std::uint32_t>(next_word(arguments));
  if (!bit_rate || std::ranges::find(can::bit_rates, *bit_rate) == std::end(can::bit_rates)) {
    return error("B: expected 10000 to 1000000 bit/s, of those that CAN networks have");
  }
  if (!peer_.restart(*bit_rate)) return error("B: the bit rate of this bus is not set from here");
  peer_.message("< ok >");
}

void SocketcandSession::send(std::string_view arguments, bool remote) {
  const auto frame = read_frame_words(arguments, remote);
  if (!frame) return error("send", frame.error());
  if (!bus_.send(*frame)) refused_ = *frame;
}

bool SocketcandSession::manage(std::string_view command, std::string_view arguments) {
  const bool is_job = command == "add" || command == "update" || command == "delete";
  const bool is_filter =
      command == "subscribe" || command == "unsubscribe" || command == "filter" || command == "muxfilter";
  if (!is_job && !is_filter) return false;
  Done done = std::unexpected("expected in bcmmode, not in rawmode");
  if (state_ == State::quiet)
    done = is_job ? manage_jobs(command, arguments) : manage_filters(command, arguments);
  if (!done) error(command, done.error());
  return true;
}

SocketcandSession::Done SocketcandSession::manage_jobs(std::string_view command, std::string_view arguments) {
  constexpr std::string_view not_there = "no frame of this identifier is sent";
  if (command == "delete") {
    const auto identifier = take_identifier(arguments);
    if (!identifier) return std::unexpected(identifier.error());
    if (!next_word(arguments).empty()) return std::unexpected("expected nothing behind the identifier");
    return manager_.remove(*identifier) ? Done{} : std::unexpected(not_there);
  }
  const bool is_new = command == "add";
  const auto period = is_new ? take_interval(arguments) : can::Duration{};
  if (!period) return std::unexpected(period.error());
  const auto frame = read_frame_words(arguments, false);
  if (!frame) return std::unexpected(frame.error());
  if (!is_new) return manager_.update(*frame) ? Done{} : std::unexpected(not_there);
  return manager_.add(*frame, *period, peer_.now()) ? Done{} : std::unexpected("64 frames are sent already");
}

SocketcandSession::Done SocketcandSession::manage_filters(std::string_view command,
                                                          std::string_view arguments) {
  constexpr std::string_view too_many = "256 identifiers are filtered already";
  const bool ends = command == "unsubscribe";
  const auto interval = ends ? can::Duration{} : take_interval(arguments);
  if (!interval) return std::unexpected(interval.error());
  const auto identifier = take_identifier(arguments);
  if (!identifier) return std::unexpected(identifier.error());
  if (command == "muxfilter") return set_multiplex_filter(*identifier, *interval, arguments);
  BroadcastManager::Content mask = 0;
  if (command == "filter") {
    const auto length = parse_number<std::uint8_t>(next_word(arguments));
    if (!length || *length > most_data) return std::unexpected("expected a length of 0 to 8");
    const auto content = take_content(arguments, *length);
    if (!content) return std::unexpected(content.error());
    mask = *content;
  }
  if (!next_word(arguments).empty()) return std::unexpected("expected fewer words");
  if (ends)
    return manager_.unsubscribe(*identifier) ? Done{} : std::unexpected("this identifier has no filter");
  const bool is_set = command == "filter" ? manager_.filter(*identifier, mask, *interval)
                                          : manager_.subscribe(*identifier, *interval);
  return is_set ? Done{} : std::unexpected(too_many);
}

SocketcandSession::Done SocketcandSession::set_multiplex_filter(CanIdentifier identifier,
                                                                can::Duration interval,
                                                                std::string_view arguments) {
  constexpr std::uint32_t most_contents = 257;  // with that of the selector
  const auto count = parse_number<std::uint32_t>(next_word(arguments));
  if (!count || *count < 2 || *count > most_contents)
    return std::unexpected("expected 2 to 257 contents of 8 bytes");
  std::vector<BroadcastManager::Content> contents;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const auto content = take_content(arguments, most_data);
    if (!content) return std::unexpected("expected 8 bytes for each content, 0 to FF");
    contents.push_back(*content);
  }
  if (!next_word(arguments).empty()) return std::unexpected("expected fewer words");
  const BroadcastManager::Content selector = contents.front();
  contents.erase(contents.begin());
  if (manager_.filter_multiplex(identifier, selector, contents, interval)) return {};
  return std::unexpected("256 identifiers or 4096 contents are filtered already");
}

bool SocketcandSession::refuse(std::string_view command) {
  if (command == "isotpmode" || command == "isotpconf" || command == "sendpdu") {
    error(command, "ISO-TP is not offered here, frames alone");
  } else if (command == "controlmode" || command == "statistics") {
    error(command, "statistics are not offered here");
  } else if (command == "list") {
    error(command, "no command of the protocol; the only bus here is " + bus_name_);
  } else {
    return false;
  }
  return true;
}

void SocketcandSession::filter(const can::Frame& frame, can::Time now) {
  if (state_ == State::quiet) manager_.receive(frame, now);
}

void SocketcandSession::tick(can::Time now) {
  if (now >= manager_.deadline()) manager_.tick(now);
}

void SocketcandSession::filtered_frame(const can::Frame& frame, can::Time time) {
  peer_.filtered_frame(frame, time);
}

void SocketcandSession::error(std::string_view command, std::string_view text) {
  error(std::string(command) + ": " + std::string(text));
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
  manager_.clear();
}

}  // namespace canopus::link
