// What commands send, request, show and clear besides SDO.

#include <algorithm>

#include "canopus/module/commands/command_interface.hpp"
#include "canopus/module/commands/pdo_mapping.hpp"
#include "canopus/module/interface/word_bytes.hpp"
#include "canopus/module/layer2/layer2.hpp"

namespace canopus::module {

void CommandInterface::send_emergency(can::Time now) {
  if (host_->bus_obstacle() == command_error::bus_off) return fail(command_error::bus_off, now);
  const std::uint16_t* word = &running_request_[1];
  const std::array<std::uint8_t, 5> manufacturer{high_byte(word[1]), low_byte(word[2]), high_byte(word[2]),
                                                 low_byte(word[3]), high_byte(word[3])};
  const auto answer = host_->send_emergency(word[0], low_byte(word[1]), manufacturer, now);
  result_[1] = static_cast<std::uint16_t>(answer);
  finish(answer == CommandHost::EmergencyAnswer::sent ? command_->success : command_->partial, now);
}

void CommandInterface::send_frame(can::Time now) {
  if (const std::uint16_t obstacle = host_->bus_obstacle(); obstacle != 0) return fail(obstacle, now);
  std::array<std::uint16_t, plain_frame_parameters> faults{};
  const auto answer = host_->send_plain_frame(std::span(running_request_).subspan(1), faults);
  if (answer == PlainFrameResult::setting_error) std::ranges::copy(faults, &result_[1]);
  const bool waits = layout_->frame_time_out != can::Duration{};
  if (answer == PlainFrameResult::no_room) {
    if (!waits) return fail(command_error::queue_full, now);
    result_[2] = frame_timeout;
    return fail(command_error::slot_error, now);
  }
  if (answer == PlainFrameResult::queued && waits) {
    frame_due_ = can::later(now, layout_->frame_time_out);
    return;
  }
  finish(answer == PlainFrameResult::queued ? command_->success : command_->partial, now);
}

void CommandInterface::frame_sent(can::Time now) {
  if (frame_due_ == can::never) return;
  frame_due_ = can::never;
  finish(command_->success, now);
}

// --- the FX2N-32CAN's own

// The bytes as they are [FX2N-32CAN 9.2].
void CommandInterface::send_emergency_bytes(can::Time now) {
  constexpr std::uint32_t emergency = 0x080;
  can::Frame frame{.identifier = emergency + host_->own_node_id(), .dlc = 8};
  for (std::size_t i = 0; i < frame.data.size(); ++i) {
    const std::uint16_t word = running_request_[1 + i / 2];
    frame.data[i] = i % 2 == 0 ? low_byte(word) : high_byte(word);
  }
  if (host_->bus_obstacle() != 0 || !host_->send_now(frame)) return fail(command_error::queue_full, now);
  finish(command_->success, now);
}

void CommandInterface::send_any_frame(can::Time now) {
  std::array<std::uint16_t, plain_frame_parameters> faults{};
  const auto frame = plain_frame(std::span(running_request_).subspan(1), faults, false);
  if (!frame) return fail_internally(now);
  if (!host_->send_now(*frame)) return fail(command_error::queue_full, now);
  finish(command_->success, now);
}

void CommandInterface::request_pdos(can::Time now) {
  const std::uint16_t number = running_request_[1];
  next_pdo_ = 0;
  if (number == 0) return request_next_pdo(now);
  result_[1] = number;
  const auto frame = number <= host_->pdos()
                         ? rpdo_frame(host_->dictionary(), static_cast<std::uint16_t>(number - 1))
                         : std::nullopt;
  if (!frame) return finish(command_->partial, now);
  result_[1] = 0;
  if (!host_->send_now(can::remote_frame(frame->identifier, frame->length)))
    return finish(command_error::queue_full, now);
  finish(command_->success, now);
}

// One after another, each when the one before is on the wire [FX2N-32CAN Tab. 6.3 note 1].
void CommandInterface::request_next_pdo(can::Time now) {
  pdo_requested_.reset();
  while (next_pdo_ < host_->pdos()) {
    const auto frame = rpdo_frame(host_->dictionary(), next_pdo_++);
    if (!frame) continue;
    pdo_requested_ = can::remote_frame(frame->identifier, frame->length);
    if (!host_->send_now(*pdo_requested_)) give_up_sending(now);
    return;
  }
  finish(command_->success, now);
}

void CommandInterface::give_up_sending(can::Time now) {
  pdo_requested_.reset();
  finish(command_error::queue_full, now);
}

// [FX2N-32CAN 8.2.7]
std::uint16_t CommandInterface::shown_guarding(std::uint8_t node_id) const {
  namespace bits = manager::error_control;
  constexpr std::uint16_t same = bits::guarding_active | bits::guarding_miss | bits::node_lost |
                                 bits::unexpected_state | bits::life_guarding;
  constexpr std::uint16_t shown_toggle_error = 0x10;
  const std::uint16_t status = host_->nmt_status().status(node_id);
  return static_cast<std::uint16_t>((status & same) |
                                    ((status & bits::toggle_error) != 0 ? shown_toggle_error : 0U));
}

void CommandInterface::show_guarding(can::Time now) {
  const std::uint8_t parameter = low_byte(running_request_[1]);
  if (parameter == 0) {
    for (std::uint8_t node = 1; node <= last_node; ++node) {
      std::uint16_t& word = result_[1 + (node - 1U) / 2];
      word = static_cast<std::uint16_t>(word | shown_guarding(node) << (node % 2 == 1 ? 0 : 8));
    }
    return finish(static_cast<std::uint16_t>(command_->success + 2), now);
  }
  if (parameter <= last_node) {
    result_[1] = parameter;
    result_[2] = shown_guarding(parameter);
    return finish(command_->success, now);
  }
  // The next one after the last that was shown, and round again.
  for (unsigned step = 1; step <= last_node; ++step) {
    const auto node = static_cast<std::uint8_t>((shown_failing_ + step - 1) % last_node + 1);
    if (!host_->nmt_status().fails(node)) continue;
    shown_failing_ = node;
    result_[1] = node;
    result_[2] = shown_guarding(node);
    break;
  }
  finish(static_cast<std::uint16_t>(command_->success + 1), now);
}

void CommandInterface::clear_guarding(can::Time now) {
  const std::uint8_t parameter = low_byte(running_request_[1]);
  host_->clear_error_control(parameter <= last_node ? parameter : std::uint8_t{0}, now);
  finish(command_->success, now);
}

void CommandInterface::put_emergency(const EmergencyBuffer::Received& received, std::size_t word) {
  const canopen::Emergency& message = received.message;
  const auto& bytes = message.manufacturer;
  const std::array<std::uint16_t, 6> record{message.node_id,
                                            received.number,
                                            message.code,
                                            word_of(bytes[0], message.error_register),
                                            word_of(bytes[2], bytes[1]),
                                            word_of(bytes[4], bytes[3])};
  std::ranges::copy(record, result_.begin() + static_cast<std::ptrdiff_t>(word));
}

// [FX2N-32CAN 9.1]
void CommandInterface::show_emergencies(can::Time now) {
  enum Parameter : std::uint16_t {
    stack = 0,
    ring = 1,
    next_unread = 2,
    stack_and_clear = 0x10,
    ring_and_clear = 0x11
  };
  constexpr std::size_t words_per_message = 6;
  EmergencyBuffer& buffer = host_->emergencies();
  const std::uint16_t parameter = running_request_[1];
  const auto put_all = [&](std::span<const EmergencyBuffer::Received> messages) {
    std::size_t word = 1;
    for (const auto& received : messages) {
      put_emergency(received, word);
      word += words_per_message;
    }
  };
  switch (parameter) {
    case stack:
    case stack_and_clear: put_all(buffer.stack()); break;
    case ring:
    case ring_and_clear: put_all(buffer.ring()); break;
    case next_unread:
      if (const auto* received = buffer.next_unread()) put_emergency(*received, 1);
      break;
    default: return fail_internally(now);
  }
  if (parameter >= stack_and_clear) buffer.clear();
  finish(static_cast<std::uint16_t>(command_->success + parameter % stack_and_clear), now);
}

// [FX2N-32CAN 6.4.8] The manual prints no classification values; the error buffer holds the parameters.
void CommandInterface::fail_internally(can::Time now) {
  constexpr std::uint16_t wrong_parameter = 1;
  result_.fill(0);
  result_[2] = wrong_parameter;
  std::ranges::copy(std::span(running_request_).subspan(1, word_count - 3), result_.begin() + 3);
  fail(command_error::internal, now);
}

}  // namespace canopus::module
