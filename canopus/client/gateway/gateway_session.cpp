#include "canopus/client/gateway/gateway_session.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace canopus::client {

using canopen::AbortCode;
using canopen::NmtCommand;

/// The rest of a line, word by word, and what stood in front of its command.
struct GatewaySession::Words {
  std::string_view rest;
  std::vector<std::uint64_t> numbers{};
  std::uint8_t node = 0;

  std::string_view take() { return take_gateway_word(rest); }
  std::optional<std::uint64_t> number(std::uint64_t least, std::uint64_t most) {
    const auto value = gateway_number(take());
    return value && *value >= least && *value <= most ? value : std::nullopt;
  }
  bool over() {
    std::string_view copy = rest;
    return take_gateway_word(copy).empty();
  }
};

namespace {

constexpr std::uint64_t longest_time = 24 * 3600 * 1000;  // ms

bool same(std::string_view word, std::string_view lower) {
  return std::ranges::equal(word, lower,
                            [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

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
  while (!waiting()) {
    const std::size_t end = input_.find('\n', used);
    if (end == std::string::npos) {
      if (input_.size() - used > longest_line) {
        too_long_ = true;
        used = input_.size();
      }
      break;
    }
    std::string_view text(input_.data() + used, end - used);
    if (text.ends_with('\r')) text.remove_suffix(1);
    used = end + 1;
    if (std::exchange(too_long_, false) || text.size() > longest_line) {
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
  const std::string_view first = take_gateway_word(start);
  sequence_.reset();
  if (first.empty()) return;
  if (first.starts_with('[')) {
    const std::size_t end = text.find(']');
    const std::size_t begin = text.find('[') + 1;
    std::string_view digits =
        end == std::string_view::npos ? std::string_view() : text.substr(begin, end - begin);
    sequence_ = gateway_number(take_gateway_word(digits));
    if (!sequence_ || *sequence_ > 0xFFFF'FFFF || !digits.empty()) {
      sequence_.reset();
      return answer(GatewayError::syntax);
    }
    text.remove_prefix(end + 1);
  }
  Words words{.rest = text};
  for (std::string_view rest = words.rest; words.numbers.size() < 3; rest = words.rest) {
    const auto number = gateway_number(take_gateway_word(rest));
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
  const std::string_view name = words.take();
  if (is_word(name, "r", "read") || is_word(name, "w", "write")) {
    const bool write = name.front() == 'w';
    Words ahead = words;
    const std::string_view next = ahead.take();
    if (!is_word(next, "p", "pdo")) return read_or_write(words, write, now);
    return write ? write_pdo(ahead) : read_pdo(ahead);
  }
  if (name == "start") return nmt(words, NmtCommand::start);
  if (name == "stop") return nmt(words, NmtCommand::stop);
  if (is_word(name, "preop", "preoperational")) return nmt(words, NmtCommand::enter_pre_operational);
  if (name == "reset") {
    const std::string_view what = words.take();
    if (what == "node") return nmt(words, NmtCommand::reset_node);
    if (is_word(what, "comm", "communication")) return nmt(words, NmtCommand::reset_communication);
    return answer(GatewayError::syntax);
  }
  if (name == "enable" || name == "disable") return supervise(words, name == "enable", now);
  if (name == "set") return set(words, now);
  if (name == "boot_up_indication") {
    const std::string_view what = words.take();
    if (!words.over() || !(same(what, "enable") || same(what, "disable")))
      return answer(GatewayError::syntax);
    boot_up_ = same(what, "enable");
    return answer(GatewayError::none);
  }
  if (name == "info") {
    if (words.take() != "version" || !words.over()) return answer(GatewayError::syntax);
    // Vendor, product, revision, serial number, class, versions of the protocol and of this program.
    return answer(fmt::format("0 0 0.0 0 3 2.1 {}", gateway_.version()));
  }
  if (name == "init" || name.starts_with("lss_") || name.starts_with("_lss_"))
    return answer(GatewayError::not_supported);
  answer(name.starts_with('_') ? GatewayError::not_supported : GatewayError::syntax);
}

// --- settings

void GatewaySession::set(Words& words, can::Time now) {
  const std::string_view what = words.take();
  if (what == "rpdo" || what == "tpdo") return set_pdo(words, what == "rpdo");
  if (what == "tpdox" || what == "command_size") return answer(GatewayError::not_supported);
  std::optional<std::uint64_t> value = words.number(0, longest_time);
  if (!value || !words.over()) return answer(GatewayError::syntax);
  if (words.numbers.size() > 1 || (words.numbers.size() == 1 && words.numbers[0] != Gateway::network)) {
    return answer(GatewayError::unsupported_network);
  }
  if (what == "network") {
    if (*value != Gateway::network) return answer(GatewayError::unsupported_network);
  } else if (what == "node") {
    if (*value > 127) return answer(GatewayError::unsupported_node);
    node_ = static_cast<std::uint8_t>(*value);
  } else if (what == "sdo_timeout") {
    if (*value == 0) return answer(GatewayError::syntax);
    sdo_time_out_ = milliseconds(*value);
  } else if (what == "command_timeout") {
    command_time_out_ = milliseconds(*value);
  } else if (what == "sdo_block") {
    if (*value > 1) return answer(GatewayError::syntax);
    block_ = *value == 1;
  } else if (what == "heartbeat") {
    if (gateway_.node_id() == 0) return answer(GatewayError::state);
    gateway_.set_heartbeat(milliseconds(*value), now);
  } else if (what == "id") {
    if (*value == 0 || *value > 127) return answer(GatewayError::unsupported_node);
    gateway_.set_node_id(static_cast<std::uint8_t>(*value));
  } else {
    return answer(GatewayError::syntax);
  }
  answer(GatewayError::none);
}

/// `NUMBER COB-ID event|syncN COUNT TYPE...`
void GatewaySession::set_pdo(Words& words, bool received) {
  const auto number = words.number(1, Gateway::most_pdos);
  const auto cob_id = words.number(0, 0xFFFF'FFFF);
  std::string_view type = words.take();
  const auto count = words.number(0, 64);
  if (!number || !cob_id || !count) return answer(GatewayError::syntax);
  if (type == "rtr" || *cob_id > can::max_base_identifier) return answer(GatewayError::not_supported);
  GatewayPdo pdo{.cob_id = static_cast<std::uint32_t>(*cob_id)};
  if (type.starts_with("sync")) {
    const auto sync = gateway_number(type.substr(4));
    if (!sync || *sync > 240) return answer(GatewayError::syntax);
    pdo.sync = std::max(1U, static_cast<unsigned>(*sync));
  } else if (type != "event") {
    return answer(GatewayError::syntax);
  }
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto each = parse_gateway_type(words.take());
    if (!each) return answer(GatewayError::syntax);
    if (each->bits == 0) return answer(GatewayError::not_supported);
    pdo.types.push_back(*each);
  }
  if (!words.over()) return answer(GatewayError::syntax);
  const auto number_value = static_cast<unsigned>(*number);
  answer(received ? gateway_.set_rpdo(number_value, std::move(pdo))
                  : gateway_.set_tpdo(number_value, std::move(pdo)));
}

// --- NMT

void GatewaySession::nmt(Words& words, NmtCommand command) {
  if (!words.over()) return answer(GatewayError::syntax);
  if (const GatewayError error = address(words, true); error != GatewayError::none) return answer(error);
  answer(gateway_.command(command, words.node) ? GatewayError::none : GatewayError::state);
}

void GatewaySession::supervise(Words& words, bool enable, can::Time now) {
  const std::string_view what = words.take();
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
  const std::string_view name = words.take();
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
  transfer.done = [this](AbortCode code, std::span<const std::uint8_t> bytes, can::Time when) {
    finished(code, bytes, when);
  };
  reads_ = !write;
  if (command_time_out_.count() != 0) deadline_ = now + command_time_out_;
  ticket_ = 0;  // it may be over before it is known
  const Gateway::Ticket ticket = gateway_.transfer(std::move(transfer), now);
  if (ticket_) ticket_ = ticket;
}

void GatewaySession::finished(AbortCode code, std::span<const std::uint8_t> bytes, can::Time now) {
  ticket_.reset();
  deadline_ = can::never;
  if (code != AbortCode::none) {
    answer(code);
  } else if (!reads_) {
    answer(GatewayError::none);
  } else if (const auto text = show_gateway_value(bytes, *type_)) {
    answer(*text);
  } else {
    answer(AbortCode::length_mismatch);
  }
  read_input(now);
}

void GatewaySession::tick(can::Time now) {
  if (now < deadline_ || !ticket_) return;
  gateway_.call_off(*ticket_, now);
  ticket_.reset();
  deadline_ = can::never;
  answer(GatewayError::time_out);
  read_input(now);
}

// --- PDO

void GatewaySession::read_pdo(Words& words) {
  const auto number = words.number(1, Gateway::most_pdos);
  if (!number || !words.over()) return answer(GatewayError::syntax);
  const GatewayPdo* pdo = gateway_.rpdo(static_cast<unsigned>(*number));
  if (pdo == nullptr || !pdo->values) return answer(GatewayError::state);
  answer(fmt::format("{} pdo {}", Gateway::network, show_pdo_values(*pdo)));
}

void GatewaySession::write_pdo(Words& words) {
  const auto number = words.number(1, Gateway::most_pdos);
  const auto count = words.number(0, 64);
  if (!number || !count) return answer(GatewayError::syntax);
  std::vector<std::uint64_t> values;
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto value = gateway_number(words.take());
    if (!value) return answer(GatewayError::syntax);
    values.push_back(*value);
  }
  if (!words.over()) return answer(GatewayError::syntax);
  answer(gateway_.write_pdo(static_cast<unsigned>(*number), values));
}

// --- answers

void GatewaySession::answer(std::string_view text) {
  const std::string start = sequence_ ? fmt::format("[{}] ", *sequence_) : std::string();
  peer_.say(start + std::string(text) + "\r\n");
}

void GatewaySession::answer(GatewayError error) {
  if (error == GatewayError::none) return answer("OK");
  answer(fmt::format("ERROR:{} #{}", static_cast<unsigned>(error), describe(error)));
}

void GatewaySession::answer(AbortCode code) {
  answer(fmt::format("ERROR:0x{:08X} #{}", static_cast<std::uint32_t>(code), canopen::describe(code)));
}

void GatewaySession::gateway_event(std::string_view line, bool boot_up) {
  if (boot_up && !boot_up_) return;
  peer_.say(std::string(line) + "\r\n");
}

}  // namespace canopus::client
