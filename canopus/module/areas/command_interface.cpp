#include "canopus/module/areas/command_interface.hpp"

#include <algorithm>

namespace canopus::module {

namespace {

constexpr std::size_t records = 8;
constexpr std::size_t words_per_record = 8;
constexpr std::size_t record_bytes = 8;
constexpr std::uint16_t end_of_list = 0xFFFF;
constexpr std::uint16_t clear_code = 0xFFFF;
constexpr std::uint16_t record_failed = 0x0F00;
constexpr std::uint16_t frame_timeout = 0x2002;

constexpr std::uint8_t low(std::uint16_t word) { return static_cast<std::uint8_t>(word & 0xFF); }
constexpr std::uint8_t high(std::uint16_t word) { return static_cast<std::uint8_t>(word >> 8); }

// First byte in the low byte of the first word.
void put_bytes(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> words) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    words[i / 2] = static_cast<std::uint16_t>(words[i / 2] | bytes[i] << (i % 2 * 8));
  }
}

/// Of up to four bytes, low byte first.
std::uint32_t number_of(std::span<const std::uint8_t> bytes) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 4); ++i)
    number |= std::uint32_t{bytes[i]} << (8 * i);
  return number;
}

void take_bytes(std::span<const std::uint16_t> words, std::span<std::uint8_t> bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = i % 2 == 0 ? low(words[i / 2]) : high(words[i / 2]);
}

}  // namespace

CommandInterface::CommandInterface(const std::optional<CommandLayout>& layout, BufferMemory& memory,
                                   CommandHost& host, can::Sink& sink)
    : layout_(layout), host_(&host), client_(sink) {
  client_.set_maximum_size(data_bytes);
  if (layout) memory.attach(layout->first, layout->first + word_count - 1, *this);
}

void CommandInterface::reset() {
  if (client_.busy()) client_.cancel(canopen::AbortCode::local_control);
  request_.fill(0);
  result_.fill(0);
  last_issued_.fill(0);
  show_result_ = running_ = locked_ = false;
  command_ = nullptr;
  begin_at_ = frame_due_ = can::never;
}

std::uint16_t CommandInterface::read_word(BufferAddress address, can::Time) {
  const std::size_t word = address - layout_->first;
  if (locked_) {
    constexpr std::array<std::uint16_t, 2> was_busy{command_error::result, command_error::was_busy};
    return word < was_busy.size() ? was_busy[word] : 0;
  }
  if (running_ && word == 0) return 0xFFFF;
  return show_result_ ? result_[word] : request_[word];
}

WriteResult CommandInterface::write_word(BufferAddress address, std::uint16_t value, can::Time) {
  if (running_) {
    // Not stored [ME3CAN1-Q 5.4.2], but for the command that ends the locked state.
    const bool may_clear = locked_ || layout_->clear_code_stops;
    if (may_clear && address == layout_->first && value == clear_code) request_[0] = value;
    locked_ = true;
    return WriteResult::done;
  }
  request_[address - layout_->first] = value;
  show_result_ = false;
  return WriteResult::done;
}

void CommandInterface::execute(Modes mode, can::Time now, can::Duration duration) {
  if (locked_) {
    if (request_[0] != clear_code) {
      if (!running_) host_->command_finished(now);  // refused: the result stays what it is
      return;
    }
  } else if (running_) {
    return;
  }
  if (client_.busy()) client_.cancel(canopen::AbortCode::local_control);
  frame_due_ = can::never;
  locked_ = false;  // by FFFFH; a write from now on locks anew
  mode_ = mode;
  running_request_ = request_;
  running_ = true;
  begin_at_ = can::later(now, duration);
}

void CommandInterface::bus_lost(std::uint16_t error_class, can::Time now) {
  if (!client_.busy() && frame_due_ == can::never) return;
  if (client_.busy()) client_.drop(canopen::AbortCode::local_control);
  frame_due_ = can::never;
  result_.fill(0);
  fail(error_class, now);
}

void CommandInterface::tick(can::Time now) {
  if (now >= begin_at_) {
    begin_at_ = can::never;
    begin(now);
  }
  if (now >= frame_due_) {
    frame_due_ = can::never;
    result_[2] = frame_timeout;
    fail(command_error::slot_error, now);
  }
  if (now >= client_.deadline()) client_.tick(now);
}

can::Time CommandInterface::deadline() const noexcept {
  return std::min({begin_at_, frame_due_, client_.deadline()});
}

void CommandInterface::begin(can::Time now) {
  result_.fill(0);
  const std::span<const CommandRow> table = layout_->commands;
  const auto row = std::ranges::find_if(table, [&](const CommandRow& known) {
    return known.code == running_request_[0] && (known.modes & mode_) != 0;
  });
  const bool is_issue =
      row == table.end() || (row->kind != CommandKind::display && row->kind != CommandKind::clear);
  if (is_issue) last_issued_ = running_request_;
  if (row == table.end()) return fail(command_error::unknown_command, now);
  command_ = &*row;
  if (needs_bus()) {
    if (const std::uint16_t obstacle = host_->bus_obstacle(); obstacle != 0) return fail(obstacle, now);
  }
  switch (command_->kind) {
    case CommandKind::display:
      // Restored, to be shown and adjusted; what stands beside the code now is unused [ME3CAN1-Q 5.3].
      request_ = last_issued_;
      request_[0] = running_request_[0];
      result_ = request_;
      return finish(command_->success, now);
    case CommandKind::clear: return finish(command_->success, now);
    case CommandKind::emergency: return send_emergency(now);
    case CommandKind::send_frame: return send_frame(now);
    case CommandKind::set_up: return set_up(now);
    case CommandKind::map_pdos: return map_pdos(now);
    case CommandKind::sdo_read:
    case CommandKind::sdo_write:
    case CommandKind::multi_read:
    case CommandKind::multi_write:
      record_ = 0;
      any_failed_ = false;
      if (is_multiple() && !skip_empty_records()) return finish(command_->success, now);
      return start_access(now);
  }
}

bool CommandInterface::needs_bus() const noexcept {
  switch (command_->kind) {
    case CommandKind::sdo_read:
    case CommandKind::sdo_write: return !is_local(running_request_[1]);
    case CommandKind::multi_read:
    case CommandKind::multi_write:
      for (std::size_t record = 0; record < records; ++record) {
        const std::uint16_t node = running_request_[1 + record * words_per_record];
        if (node == end_of_list && !layout_->skips_empty_records) return false;
        if (node != end_of_list && !is_local(node)) return true;
      }
      return false;
    default: return false;
  }
}

void CommandInterface::start_access(can::Time now) {
  const std::size_t word = 1 + record_ * words_per_record;
  const std::size_t maximum = is_multiple() ? record_bytes : data_bytes;
  const std::uint16_t node = running_request_[word];
  const std::uint16_t index = running_request_[word + 1];
  const std::uint8_t sub = low(running_request_[word + 2]);
  const std::uint16_t length = running_request_[word + 3];
  result_[word] = node;
  result_[word + 1] = index;
  result_[word + 2] = sub;

  if (node > 127) return access_done(layout_->no_such_node, {}, now);
  if (!is_read()) {
    if (length == 0 || length > maximum) return access_done(canopen::AbortCode::length_mismatch, {}, now);
    take_bytes(std::span(running_request_).subspan(word + 4), std::span(download_).first(length));
  }
  const auto value = std::span<const std::uint8_t>(download_).first(is_read() ? 0 : length);
  if (is_local(node)) {
    if (!is_read()) return access_done(host_->dictionary().write(index, sub, value, now), {}, now);
    const auto read = host_->dictionary().read(index, sub, now);
    if (!read) return access_done(read.error(), {}, now);
    if (read->size() > maximum) return access_done(abort_buffer_too_small, {}, now);
    return access_done(canopen::AbortCode::none, *read, now);
  }
  const auto server = static_cast<std::uint8_t>(node);
  if (!host_->sdo_channel_free(server)) return access_done(canopen::AbortCode::no_sdo_connection, {}, now);
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
  access_done(client.abort_code(), is_read() ? client.data() : std::span<const std::uint8_t>{}, now);
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
    }
  } else if (is_multiple()) {
    any_failed_ = true;
    result_[word] = static_cast<std::uint16_t>(record_failed | low(running_request_[word]));
    result_[word + 3] = 0;
    result_[word + 4] = low_word;
    result_[word + 5] = high_word;
  } else {
    const std::uint16_t node = running_request_[1];
    result_.fill(0);
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
  if (command_->set_up == SetUpKind::slave_assignment && !host_->is_nmt_master())
    return fail(command_error::wrong_state, now);
  set_up_.begin(command_->set_up, std::span(running_request_).subspan<1, command_parameters>(),
                std::span(result_).subspan<1, command_parameters>(), host_->own_node_id(), host_->pdos());
  continue_set_up(now);
}

// Accesses of the local node end at once; one of another node goes on with sdo_finished().
void CommandInterface::continue_set_up(can::Time now) {
  for (;;) {
    const auto access = set_up_.next();
    if (set_up_.takes_reset()) {
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
      result_.fill(0);
      return fail(obstacle, now);
    }
    if (!host_->sdo_channel_free(access->node)) {
      set_up_.done(canopen::AbortCode::no_sdo_connection, 0);
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

void CommandInterface::send_emergency(can::Time now) {
  if (host_->bus_obstacle() == command_error::bus_off) return fail(command_error::bus_off, now);
  const std::uint16_t* word = &running_request_[1];
  const std::array<std::uint8_t, 5> manufacturer{high(word[1]), low(word[2]), high(word[2]), low(word[3]),
                                                 high(word[3])};
  const auto answer = host_->send_emergency(word[0], low(word[1]), manufacturer, now);
  result_[1] = static_cast<std::uint16_t>(answer);
  finish(answer == CommandHost::EmergencyAnswer::sent ? command_->success : command_->partial, now);
}

void CommandInterface::send_frame(can::Time now) {
  if (const std::uint16_t obstacle = host_->bus_obstacle(); obstacle != 0) return fail(obstacle, now);
  const auto answer =
      host_->send_plain_frame(std::span(running_request_).subspan(1), std::span(result_).subspan(1));
  const bool waits = layout_->frame_time_out != can::Duration{};
  if (answer == CommandHost::FrameAnswer::no_room) {
    if (!waits) return fail(command_error::queue_full, now);
    result_[2] = frame_timeout;
    return fail(command_error::slot_error, now);
  }
  if (answer == CommandHost::FrameAnswer::queued && waits) {
    frame_due_ = can::later(now, layout_->frame_time_out);
    return;
  }
  finish(answer == CommandHost::FrameAnswer::queued ? command_->success : command_->partial, now);
}

void CommandInterface::frame_sent(can::Time now) {
  if (frame_due_ == can::never) return;
  frame_due_ = can::never;
  finish(command_->success, now);
}

void CommandInterface::fail(std::uint16_t error_class, can::Time now) {
  result_[1] = error_class;
  finish(command_error::result, now);
}

void CommandInterface::finish(std::uint16_t result, can::Time now) {
  result_[0] = result;
  show_result_ = true;
  running_ = false;
  host_->command_finished(now);
}

}  // namespace canopus::module
