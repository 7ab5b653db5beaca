// Planes of words, and the way of a command through them.

#include "canopus/module/commands/command_interface.hpp"

#include <algorithm>

namespace canopus::module {

namespace {

constexpr std::uint16_t clear_code = 0xFFFF;

}  // namespace

CommandInterface::CommandInterface(const std::optional<CommandLayout>& layout, BufferMemory& memory,
                                   CommandHost& host, can::Sink& sink)
    : layout_(layout), host_(&host), client_(sink) {
  client_.set_maximum_size(most_data_bytes);
  for (can::Alarm* part : {&begin_at_, &frame_due_, &client_.alarm()}) alarm_.add_part(*part);
  if (layout) memory.attach(layout->first, layout->first + word_count - 1, *this);
}

void CommandInterface::reset() {
  if (client_.busy()) client_.cancel(canopen::AbortCode::local_control);
  request_.fill(0);
  result_.fill(0);
  last_issued_.fill(0);
  show_result_ = running_ = locked_ = false;
  command_ = nullptr;
  begin_at_.cancel();
  frame_due_.cancel();
  held_ = false;
  pdo_requested_.reset();
  shown_failing_ = 0;
}

std::uint16_t CommandInterface::read_word(BufferAddress address, can::Time) const {
  const std::size_t word = address - layout_->first;
  if (locked_) {
    constexpr std::array<std::uint16_t, 2> was_busy{command_error::result, command_error::was_busy};
    if (word < was_busy.size()) return was_busy[word];
    return layout_->is_one_memory ? request_[word] : std::uint16_t{0};
  }
  if (running_ && word == 0) return 0xFFFF;
  if (layout_->is_one_memory) return request_[word];
  return show_result_ || layout_->reads_results_only ? result_[word] : request_[word];
}

WriteResult CommandInterface::write_word(BufferAddress address, std::uint16_t value, can::Time) {
  if (running_) {
    // Not stored [ME3CAN1-Q 5.4.2], but for the command that ends the locked state.
    const bool may_clear = locked_ || layout_->clear_code_stops;
    if (may_clear && address == layout_->first && value == clear_code) request_[0] = value;
    locked_ = true;
    if (layout_->is_one_memory) request_[1] = command_error::was_busy;
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
  pdo_requested_.reset();
  held_ = false;
  locked_ = false;  // by FFFFH; a write from now on locks anew
  mode_ = mode;
  running_request_ = request_;
  running_ = true;
  begin_at_ = can::later(now, duration);
}

void CommandInterface::bus_lost(std::uint16_t error_class, can::Time now) {
  if (pdo_requested_) return give_up_sending(now);
  if (!client_.busy() && frame_due_ == can::never) return;
  if (client_.busy()) client_.drop(canopen::AbortCode::local_control);
  if (!layout_->has_state_classes) return connection_lost(now);
  frame_due_ = can::never;
  begin_result();
  fail(error_class, now);
}

void CommandInterface::tick(can::Time now) {
  if (now >= begin_at_) {
    begin_at_ = can::never;
    held_ = host_->holds_commands();
    if (!held_) begin(now);
  }
  if (now >= frame_due_) {
    frame_due_ = can::never;
    result_[2] = frame_timeout;
    fail(command_error::slot_error, now);
  }
  if (now >= client_.deadline()) client_.tick(now);
}

void CommandInterface::begin(can::Time now) {
  held_ = false;
  begin_result();
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
    if (const std::uint16_t obstacle = bus_obstacle_class(); obstacle != 0) return fail(obstacle, now);
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
    case CommandKind::emergency_bytes: return send_emergency_bytes(now);
    case CommandKind::plain_frame: return send_any_frame(now);
    case CommandKind::request_pdos: return request_pdos(now);
    case CommandKind::guarding_status: return show_guarding(now);
    case CommandKind::clear_guarding: return clear_guarding(now);
    case CommandKind::read_emergencies: return show_emergencies(now);
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

std::uint16_t CommandInterface::bus_obstacle_class() const {
  return layout_->has_state_classes ? host_->bus_obstacle() : std::uint16_t{0};
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

void CommandInterface::fail(std::uint16_t error_class, can::Time now) {
  result_[1] = error_class;
  finish(command_error::result, now);
}

void CommandInterface::begin_result() noexcept {
  result_ = layout_->is_one_memory ? running_request_ : Plane{};
}

void CommandInterface::finish(std::uint16_t result, can::Time now) {
  result_[0] = result;
  show_result_ = true;
  running_ = false;
  if (layout_->is_one_memory && !locked_) request_ = result_;
  host_->command_finished(now);
}

}  // namespace canopus::module
