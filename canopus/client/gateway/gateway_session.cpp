#include "canopus/client/gateway/gateway_session.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "canopus/ascii/counted.hpp"
#include "canopus/ascii/words.hpp"
#include "canopus/canopen/sdo/uploaded_value.hpp"

namespace canopus::client {

using canopen::AbortCode;
using canopen::NmtCommand;

namespace {

constexpr std::uint64_t longest_time = 24 * 3600 * 1000;  // ms
constexpr std::uint64_t longest_sdo_time_out = 65535;     // ms

/// `short` or any further part of `whole`.
bool is_word(std::string_view word, std::string_view shortest, std::string_view whole) {
  return word == shortest || word == whole;
}

can::Duration milliseconds(std::uint64_t value) { return std::chrono::milliseconds(value); }

/// Without its comment, which does not begin within quotes.
std::string_view without_comment(std::string_view text) {
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (text[i] == '#' && !quoted) return text.substr(0, i);
  }
  return text;
}

}  // namespace

GatewaySession::GatewaySession(Gateway& gateway, Peer& peer) : gateway_(gateway), peer_(peer) {
  gateway_.add(*this);
}

GatewaySession::~GatewaySession() {
  gateway_.remove(*this);
  end({});
}

void GatewaySession::end(can::Time now) {
  if (ticket_) gateway_.call_off(*ticket_, now);
  ticket_.reset();
}

void GatewaySession::receive(std::string_view bytes, can::Time now) {
  input_.append(bytes);
  read_input(now);
}

void GatewaySession::read_input(can::Time now) {
  // A transfer may be over before the command that began it is.
  if (std::exchange(reading_, true)) return;
  std::size_t used = 0;
  while (!waiting() && !peer_.is_full()) {
    const std::size_t end = input_.find('\n', used);
    if (end == std::string::npos) {
      if (input_.size() - used > command_size_ + 1) {
        too_long_ = true;
        used = input_.size();
      }
      break;
    }
    std::string_view text(input_.data() + used, end - used);
    if (text.ends_with('\r')) text.remove_suffix(1);
    used = end + 1;
    if (std::exchange(too_long_, false) || text.size() > command_size_) {
      sequence_.reset();
      answer(GatewayError::syntax);
      continue;
    }
    const std::string copy(text);
    line(copy, now);
  }
  input_.erase(0, used);
  reading_ = false;
}

void GatewaySession::line(std::string_view text, can::Time now) {
  text = without_comment(text);
  std::string_view start = text;
  const std::string_view first = next_gateway_word(start);
  sequence_.reset();
  if (first.empty()) return;
  if (first.starts_with('[')) {
    const std::size_t end = text.find(']');
    const std::size_t begin = text.find('[') + 1;
    std::string_view digits =
        end == std::string_view::npos ? std::string_view() : text.substr(begin, end - begin);
    sequence_ = gateway_number(next_gateway_word(digits));
    if (!sequence_ || *sequence_ > 0xFFFF'FFFF || !digits.empty()) {
      sequence_.reset();
      return answer(GatewayError::syntax);
    }
    text.remove_prefix(end + 1);
  }
  Words words{.rest = text};
  for (std::string_view rest = words.rest; words.numbers.size() < 3; rest = words.rest) {
    const auto number = gateway_number(next_gateway_word(rest));
    if (!number) break;
    words.numbers.push_back(*number);
    words.rest = rest;
  }
  if (words.numbers.size() > 2) return answer(GatewayError::syntax);
  command(words, now);
}

/// Network and node of a command.
GatewayError GatewaySession::address(Words& words, bool all_allowed) const {
  const auto& numbers = words.numbers;
  if (numbers.size() == 2 && numbers[0] != Gateway::network) return GatewayError::unsupported_network;
  if (numbers.empty() && !node_) return GatewayError::no_node;
  const std::uint64_t node = numbers.empty() ? *node_ : numbers.back();
  if (node > 127 || (node == 0 && !all_allowed)) return GatewayError::unsupported_node;
  words.node = static_cast<std::uint8_t>(node);
  return GatewayError::none;
}

void GatewaySession::command(Words& words, can::Time now) {
  const std::string_view name = words.next();
  if (is_word(name, "r", "read") || is_word(name, "w", "write")) {
    const bool write = name.front() == 'w';
    Words ahead = words;
    const std::string_view next = ahead.next();
    if (!is_word(next, "p", "pdo")) return read_or_write(words, write, now);
    return write ? write_pdo(ahead, now) : read_pdo(ahead, now);
  }
  if (name == "start") return nmt(words, NmtCommand::start);
  if (name == "stop") return nmt(words, NmtCommand::stop);
  if (is_word(name, "preop", "preoperational")) return nmt(words, NmtCommand::enter_pre_operational);
  if (name == "reset") {
    const std::string_view what = words.next();
    if (what == "node") return nmt(words, NmtCommand::reset_node);
    if (is_word(what, "comm", "communication")) return nmt(words, NmtCommand::reset_communication);
    return answer(GatewayError::syntax);
  }
  if (name == "enable" || name == "disable") return supervise(words, name == "enable", now);
  if (name == "set") return set(words, now);
  if (name == "boot_up_indication") {
    const std::string_view what = words.next();
    if (!words.over() ||
        !(ascii::equal_ignoring_case(what, "enable") || ascii::equal_ignoring_case(what, "disable")))
      return answer(GatewayError::syntax);
    boot_up_ = ascii::equal_ignoring_case(what, "enable");
    return answer(GatewayError::none);
  }
  if (name == "info") {
    if (words.next() != "version" || !words.over()) return answer(GatewayError::syntax);
    // Vendor, product, revision, serial number, class, versions of the protocol and of this program.
    return answer(fmt::format("0 0 0.0 0 3 2.1 {}", gateway_.version()));
  }
  if (name == "init") return init(words, now);
  if (name.starts_with("lss_") || name.starts_with("_lss_")) return lss_command(name, words, now);
  answer(name.starts_with('_') ? GatewayError::not_supported : GatewayError::syntax);
}

// --- settings

/// Only a network number may precede the command.
GatewayError GatewaySession::network_only(const Words& words) {
  const auto& numbers = words.numbers;
  const bool own = numbers.empty() || (numbers.size() == 1 && numbers[0] == Gateway::network);
  return own ? GatewayError::none : GatewayError::unsupported_network;
}

void GatewaySession::set(Words& words, can::Time now) {
  const std::string_view what = words.next();
  if (what == "rpdo" || what == "tpdo" || what == "tpdox")
    return set_pdo(words, what == "rpdo", what == "tpdox");
  const std::optional<std::uint64_t> value = words.number(0, longest_time);
  if (!value || !words.over()) return answer(GatewayError::syntax);
  if (const GatewayError error = network_only(words); error != GatewayError::none) return answer(error);
  if (set_value(what, *value, now)) answer(GatewayError::none);
}

/// False: it was answered why not.
bool GatewaySession::set_value(std::string_view what, std::uint64_t value, can::Time now) {
  GatewayError error = GatewayError::none;
  if (what == "network") {
    if (value != Gateway::network) error = GatewayError::unsupported_network;
  } else if (what == "node") {
    if (value > 127) error = GatewayError::unsupported_node;
    if (value <= 127) node_ = static_cast<std::uint8_t>(value);
  } else if (what == "sdo_timeout") {
    if (value == 0 || value > longest_sdo_time_out) error = GatewayError::syntax;
    if (error == GatewayError::none) sdo_time_out_ = milliseconds(value);
  } else if (what == "command_timeout") {
    command_time_out_ = milliseconds(value);
  } else if (what == "command_size") {
    if (value < least_command_size) error = GatewayError::syntax;
    if (value > longest_line) error = GatewayError::memory;
    if (error == GatewayError::none) command_size_ = static_cast<std::size_t>(value);
  } else if (what == "sdo_block") {
    if (value > 1) error = GatewayError::syntax;
    if (value <= 1) block_ = value == 1;
  } else if (what == "heartbeat") {
    if (gateway_.node_id() == 0) error = GatewayError::state;
    if (gateway_.node_id() != 0) gateway_.set_heartbeat(milliseconds(value), now);
  } else if (what == "id") {
    if (value == 0 || value > 127) error = GatewayError::unsupported_node;
    if (value != 0 && value <= 127) gateway_.set_node_id(static_cast<std::uint8_t>(value));
  } else {
    error = GatewayError::syntax;
  }
  if (error != GatewayError::none) answer(error);
  return error == GatewayError::none;
}

/// `INDEX` of table 0 of LSS.
void GatewaySession::init(Words& words, can::Time now) {
  constexpr std::uint64_t automatic = 9;
  const auto index = words.number(0, automatic);
  if (!index || !words.over()) return answer(GatewayError::syntax);
  if (const GatewayError error = network_only(words); error != GatewayError::none) return answer(error);
  const std::uint32_t rate = *index < lss::bit_rates.size() ? lss::bit_rates[*index] : 0;
  if (rate == 0) return answer(GatewayError::not_supported);
  if (const auto done = gateway_.restart(rate); !done) return answer(GatewayError::controller, done.error());
  answer(GatewayError::none);
  gateway_.reset(now);
}

// --- NMT

void GatewaySession::nmt(Words& words, NmtCommand command) {
  if (!words.over()) return answer(GatewayError::syntax);
  if (const GatewayError error = address(words, true); error != GatewayError::none) return answer(error);
  answer(gateway_.command(command, words.node) ? GatewayError::none : GatewayError::overflow);
}

void GatewaySession::supervise(Words& words, bool enable, can::Time now) {
  const std::string_view what = words.next();
  if (what != "heartbeat" && what != "guarding") return answer(GatewayError::syntax);
  const bool guarding = what == "guarding";
  const auto time = enable ? words.number(1, longest_time) : std::optional<std::uint64_t>(0);
  const auto factor = enable && guarding ? words.number(1, 255) : std::optional<std::uint64_t>(0);
  if (!time || !factor || !words.over()) return answer(GatewayError::syntax);
  if (const GatewayError error = address(words, false); error != GatewayError::none) return answer(error);
  if (guarding) {
    gateway_.watch_guarding(words.node, milliseconds(*time), static_cast<unsigned>(*factor), now);
  } else {
    gateway_.watch_heartbeat(words.node, milliseconds(*time), now);
  }
  answer(GatewayError::none);
}

// --- SDO

void GatewaySession::read_or_write(Words& words, bool write, can::Time now) {
  const auto index = words.number(0, 0xFFFF);
  const auto sub = words.number(0, 0xFF);
  if (!index || !sub) return answer(GatewayError::syntax);
  const std::string_view name = words.next();
  type_ = name.empty() && !write ? GatewayType{} : parse_gateway_type(name);
  if (!type_ || (!write && !words.over())) return answer(GatewayError::syntax);
  Gateway::Transfer transfer{.index = static_cast<std::uint16_t>(*index),
                             .sub = static_cast<std::uint8_t>(*sub)};
  if (write) {
    transfer.value = encode_gateway_value(words.rest, *type_);
    if (!transfer.value) return answer(GatewayError::syntax);
  }
  if (const GatewayError error = address(words, false); error != GatewayError::none) return answer(error);
  transfer.node = words.node;
  transfer.block = block_;
  transfer.time_out = sdo_time_out_;
  transfer.done = [this](const Gateway::Answer& answer, can::Time when) { finished(answer, when); };
  reads_ = !write;
  begins(now);
  const Gateway::Ticket ticket = gateway_.transfer(std::move(transfer), now);
  if (ticket_) ticket_ = ticket;
}

/// A command that waits for the bus. It may be over before its ticket is known.
void GatewaySession::begins(can::Time now, bool limited) {
  alarm() = limited && command_time_out_.count() != 0 ? can::later(now, command_time_out_) : can::never;
  ticket_ = 0;
}

void GatewaySession::goes_on(can::Time now) {
  ticket_.reset();
  alarm() = can::never;
  read_input(now);
}

void GatewaySession::finished(const Gateway::Answer& end, can::Time now) {
  if (end.code == canopen::SdoClient::buffer_too_small) {
    answer(GatewayError::memory);
  } else if (end.short_answer != nullptr) {
    answer(fmt::format("ERROR:0x{:08X} #{}, expected 8", static_cast<std::uint32_t>(end.code),
                       ascii::counted(end.short_answer->length(), "byte")));
  } else if (end.code != AbortCode::none) {
    answer(end.code);
  } else if (!reads_) {
    answer(GatewayError::none);
  } else {
    answer_value(end);
  }
  goes_on(now);
}

/// With a comment where the answer of the node leaves a doubt.
void GatewaySession::answer_value(const Gateway::Answer& end) {
  using Remark = canopen::UploadedValue::Remark;
  const std::size_t length = (type_->bits + 7) / 8;
  const auto value = canopen::uploaded_value(end.bytes, end.size_indicated, length);
  const auto text = show_gateway_value(value.bytes, *type_);
  if (!text) return answer(AbortCode::length_mismatch);
  std::string comment;
  if (value.remark == Remark::longer_than_type)
    comment = fmt::format(" #{} came, the others are 0", ascii::counted(end.bytes.size(), "byte"));
  if (value.remark == Remark::size_not_indicated && length == 0) comment = " #size not indicated";
  answer(*text + comment);
}

void GatewaySession::tick(can::Time now) {
  if (now < deadline() || !ticket_) return;
  gateway_.call_off(*ticket_, now);
  answer(GatewayError::time_out);
  goes_on(now);
}

// --- answers

void GatewaySession::answer(std::string_view text) {
  const std::string start = sequence_ ? fmt::format("[{}] ", *sequence_) : std::string();
  peer_.send_line(start + std::string(text) + "\r\n");
}

void GatewaySession::answer(GatewayError error, std::string_view detail) {
  if (error == GatewayError::none) return answer("OK");
  answer(fmt::format("ERROR:{} #{}{}{}", static_cast<unsigned>(error), describe(error),
                     detail.empty() ? "" : ": ", detail));
}

void GatewaySession::answer(AbortCode code) {
  answer(fmt::format("ERROR:0x{:08X} #{}", static_cast<std::uint32_t>(code), canopen::describe(code)));
}

void GatewaySession::gateway_event(std::string_view line, bool boot_up) {
  if (boot_up && !boot_up_) return;
  peer_.send_line(std::string(line) + "\r\n");
}

}  // namespace canopus::client
