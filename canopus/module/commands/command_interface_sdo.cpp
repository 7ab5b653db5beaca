// SDO accesses of the command interface.

#include <algorithm>

#include "canopus/module/commands/command_interface.hpp"
#include "canopus/module/interface/word_bytes.hpp"

namespace canopus::module {

namespace {

constexpr std::size_t record_bytes = 8;
constexpr std::uint16_t record_failed = 0x0F00;

// First byte in the low byte of the first word.
void put_bytes(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> words) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    words[i / 2] = static_cast<std::uint16_t>(i % 2 == 0 ? bytes[i] : words[i / 2] | bytes[i] << 8U);
  }
}

void copy_bytes(std::span<const std::uint16_t> words, std::span<std::uint8_t> bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = i % 2 == 0 ? low_byte(words[i / 2]) : high_byte(words[i / 2]);
}

/// Of up to four bytes, low byte first.
std::uint32_t number_of(std::span<const std::uint8_t> bytes) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 4); ++i)
    number |= std::uint32_t{bytes[i]} << (8 * i);
  return number;
}

}  // namespace

void CommandInterface::start_access(can::Time now) {
  const std::size_t word = 1 + record_ * words_per_record;
  const std::size_t maximum = is_multiple() ? record_bytes : layout_->data_bytes;
  const std::uint16_t node = running_request_[word];
  const std::uint16_t index = running_request_[word + 1];
  const std::uint8_t sub = low_byte(running_request_[word + 2]);
  const std::uint16_t length = running_request_[word + 3];
  result_[word] = node;
  result_[word + 1] = index;
  result_[word + 2] = sub;

  if (node > 127) return access_done(layout_->no_such_node, {}, now);
  if (!is_read()) {
    if (length == 0 || length > maximum) return access_done(canopen::AbortCode::length_mismatch, {}, now);
    copy_bytes(std::span(running_request_).subspan(word + 4), std::span(download_).first(length));
  }
  const auto value = std::span<const std::uint8_t>(download_).first(is_read() ? 0 : length);
  if (is_local(node)) {
    const bool deletes = value.size() == 1 && value[0] == 0;
    if (!is_read() && index == layout_->object_not_set && !deletes)
      return access_done(canopen::AbortCode::unsupported_access, {}, now);
    if (!is_read()) return access_done(host_->dictionary().write(index, sub, value, now), {}, now);
    const auto read = host_->dictionary().read(index, sub, now);
    if (!read) return access_done(read.error(), {}, now);
    if (read->size() > maximum) return access_done(abort_buffer_too_small, {}, now);
    return access_done(canopen::AbortCode::none, *read, now);
  }
  const auto server = static_cast<std::uint8_t>(node);
  if (!layout_->has_state_classes && host_->bus_obstacle() != 0)
    return access_done(abort_no_channel, {}, now);
  if (!host_->sdo_channel_available(server)) return access_done(layout_->channel_in_use, {}, now);
  client_.set_server(server);
  client_.set_maximum_size(maximum);
  const bool started = is_read() ? client_.upload(index, sub, *this, now, host_->sdo_time_out())
                                 : client_.download(index, sub, value, *this, now, host_->sdo_time_out());
  if (!started) access_done(abort_no_channel, {}, now);
}

void CommandInterface::sdo_finished(canopen::SdoClient& client, can::Time now) {
  if (command_->kind == CommandKind::set_up) {
    const std::span<const std::uint8_t> data =
        set_up_reads_ ? client.data() : std::span<const std::uint8_t>{};
    set_up_.done(client.abort_code(), number_of(data));
    return continue_set_up(now);
  }
  access_done(shown_code(), is_read() ? client.data() : std::span<const std::uint8_t>{}, now);
}

canopen::AbortCode CommandInterface::shown_code() const noexcept {
  const canopen::AbortCode code = client_.abort_code();
  if (code == abort_buffer_too_small && !client_.data().empty()) return layout_->too_long_at_last;
  const bool is_own =
      client_.gave_up() &&
      (code == canopen::AbortCode::timed_out || code == canopen::AbortCode::command_specifier ||
       code == canopen::AbortCode::toggle_bit || client_.short_answer() != nullptr);
  // Time-out and protocol mismatch are one code where a time-out is not CiA 301's [FX2N-32CAN 6.4.2].
  return is_own && layout_->silent_node != canopen::AbortCode::timed_out ? layout_->silent_node : code;
}

// The node cannot talk any more, and there is no class of errors for it.
void CommandInterface::connection_lost(can::Time now) {
  if (command_->kind != CommandKind::set_up) return access_done(abort_no_channel, {}, now);
  set_up_.done(abort_no_channel, 0);
  continue_set_up(now);
}

void CommandInterface::access_done(canopen::AbortCode code, std::span<const std::uint8_t> data,
                                   can::Time now) {
  const std::size_t word = 1 + record_ * words_per_record;
  const auto raw = static_cast<std::uint32_t>(code);
  const auto low_word = static_cast<std::uint16_t>(raw & 0xFFFF);
  const auto high_word = static_cast<std::uint16_t>(raw >> 16);
  if (code == canopen::AbortCode::none) {
    if (is_read()) {
      result_[word + 3] = static_cast<std::uint16_t>(data.size());
      put_bytes(data, std::span(result_).subspan(word + 4));
    } else if (layout_->shows_written_length) {
      result_[word + 3] = running_request_[word + 3];
    }
  } else if (is_multiple()) {
    any_failed_ = true;
    result_[word] = static_cast<std::uint16_t>(record_failed | low_byte(running_request_[word]));
    if (is_read() || !layout_->is_one_memory) result_[word + 3] = 0;
    result_[word + 4] = low_word;
    result_[word + 5] = high_word;
  } else {
    const std::uint16_t node = running_request_[1];
    begin_result();
    result_[2] = node;
    result_[3] = low_word;
    result_[4] = high_word;
    return fail(command_error::sdo, now);
  }
  next_access(now);
}

void CommandInterface::next_access(can::Time now) {
  ++record_;
  if (is_multiple() && skip_empty_records()) return start_access(now);
  finish(any_failed_ ? command_->partial : command_->success, now);
}

// Goes on to the next record that has a node; false: there is none.
bool CommandInterface::skip_empty_records() noexcept {
  for (; record_ < records; ++record_) {
    if (running_request_[1 + record_ * words_per_record] != end_of_list) return true;
    if (!layout_->skips_empty_records) return false;
  }
  return false;
}

void CommandInterface::set_up(can::Time now) {
  if (command_->set_up == SetUpKind::slave_assignment && !host_->is_nmt_master()) {
    if (layout_->has_state_classes) return fail(command_error::wrong_state, now);
    return refuse_slaves(now);
  }
  set_up_.begin(command_->set_up, layout_->set_up,
                std::span(running_request_).subspan<1, command_parameters>(),
                std::span(result_).subspan<1, command_parameters>(), host_->own_node_id(), host_->pdos());
  continue_set_up(now);
}

// Accesses of the local node end at once; one of another node goes on with sdo_finished().
void CommandInterface::continue_set_up(can::Time now) {
  for (;;) {
    const auto access = set_up_.next();
    if (set_up_.pop_reset()) {
      host_->map_pdos(PdoMapping::mode_b, now);
      continue;
    }
    if (!access) return finish(set_up_.failed() ? command_->partial : command_->success, now);
    std::array<std::uint8_t, 4> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::uint8_t>(access->value >> (8 * i));
    const auto value = std::span<const std::uint8_t>(bytes).first(access->length);
    if (is_local(access->node)) {
      if (!access->reads) {
        set_up_.done(host_->dictionary().write(access->index, access->sub, value, now), 0);
      } else if (const auto read = host_->dictionary().read(access->index, access->sub, now)) {
        set_up_.done(canopen::AbortCode::none, number_of(*read));
      } else {
        set_up_.done(read.error(), 0);
      }
      continue;
    }
    if (const std::uint16_t obstacle = host_->bus_obstacle(); obstacle != 0) {
      if (!layout_->has_state_classes) {
        set_up_.done(abort_no_channel, 0);
        continue;
      }
      result_.fill(0);
      return fail(obstacle, now);
    }
    if (!host_->sdo_channel_available(access->node)) {
      set_up_.done(layout_->channel_in_use, 0);
      continue;
    }
    set_up_reads_ = access->reads;
    client_.set_server(access->node);
    client_.set_maximum_size(bytes.size());
    std::ranges::copy(value, download_.begin());
    const auto download = std::span<const std::uint8_t>(download_).first(access->length);
    const bool started =
        access->reads
            ? client_.upload(access->index, access->sub, *this, now, host_->sdo_time_out())
            : client_.download(access->index, access->sub, download, *this, now, host_->sdo_time_out());
    if (started) return;
    set_up_.done(abort_no_channel, 0);
  }
}

void CommandInterface::map_pdos(can::Time now) {
  constexpr std::uint8_t mode_a_nodes = 8;
  if (command_->mapping == PdoMapping::mode_a && host_->own_node_id() > mode_a_nodes)
    return finish(command_->partial, now);
  host_->map_pdos(command_->mapping, now);
  finish(command_->success, now);
}

// Without an NMT master there are no slaves: each number is wrong here [FX2N-32CAN 8.2.1].
void CommandInterface::refuse_slaves(can::Time now) {
  constexpr std::size_t words_per_slave = 4, last_record = 61;
  for (std::size_t at = 1; at <= last_record && running_request_[at] != end_of_list; at += words_per_slave) {
    result_[at] = running_request_[at];
    for (std::size_t i = 1; i < words_per_slave; ++i) result_[at + i] = 0xFFFF;
  }
  finish(command_->partial, now);
}

}  // namespace canopus::module
