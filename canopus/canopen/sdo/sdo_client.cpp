#include "canopus/canopen/sdo/sdo_client.hpp"

#include <algorithm>
#include <cstdint>

#include "canopus/can/little_endian.hpp"
#include "canopus/canopen/sdo/sdo_frame.hpp"
#include "canopus/canopen/service/nmt.hpp"

namespace canopus::canopen {

using sdo::ServerCommand;

void SdoClient::set_server(std::uint8_t node_id) {
  set_channel(cob_id::sdo_request + node_id, cob_id::sdo_response + node_id);
  server_ = node_id;
}

void SdoClient::set_channel(std::uint32_t request, std::uint32_t response) {
  if (busy()) return;
  constexpr std::uint32_t identifier_and_format = 0x3FFF'FFFF;
  request_ = sdo::head(request & identifier_and_format);
  response_ = sdo::head(response & identifier_and_format).without_dlc();
  server_ = 0;
}

// Everything is set before a frame goes out: on a bus that is a function call, the answer comes from inside
// send().
inline bool SdoClient::start(State state, const can::Frame& request, SdoClientListener& listener,
                             can::Time now, can::Duration time_out) {
  state_ = state;
  toggle_ = 0;
  all_sent_ = false;
  end_ = End::by_server;
  abort_code_ = AbortCode::none;
  listener_ = &listener;
  multiplexer_ = sdo::multiplexer(request);
  collector_.clear();
  time_out_ = time_out;
  restart_time_out(now);
  if (sink_->send(request)) return true;
  state_ = State::idle;
  alarm_ = can::never;
  return false;
}

bool SdoClient::upload(std::uint16_t index, std::uint8_t sub, SdoClientListener& listener, can::Time now,
                       can::Duration time_out, Mode mode, ByteSink* into) {
  if (busy()) return false;
  into_ = into;
  if (mode == Mode::segmented) {
    return start(State::initiate_upload, sdo::frame(request_, 0x40, sdo::multiplexer(index, sub)), listener,
                 now, time_out);
  }
  const std::uint32_t block_size_and_threshold = own_block_size | std::uint32_t{switch_threshold_} << 8;
  return start(
      State::initiate_block_upload,
      sdo::frame(request_, 0xA0U | sdo::crc_bit, sdo::multiplexer(index, sub), block_size_and_threshold),
      listener, now, time_out);
}

bool SdoClient::start_download(State state, std::uint16_t index, std::uint8_t sub,
                               std::optional<std::uint32_t> size, SdoClientListener& listener, can::Time now,
                               can::Duration time_out) {
  expedited_ = false;
  const bool in_blocks = state == State::initiate_block_download;
  const unsigned size_bit = !size ? 0U : in_blocks ? 2U : 1U;
  const unsigned command = in_blocks ? 0xC0U | sdo::crc_bit : 0x20U;
  return start(state,
               sdo::frame(request_, command | size_bit, sdo::multiplexer(index, sub), size.value_or(0)),
               listener, now, time_out);
}

bool SdoClient::download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data,
                         SdoClientListener& listener, can::Time now, can::Duration time_out, Mode mode) {
  if (busy()) return false;
  if (data.empty() || data.size() > 4)
    return start_long_download(index, sub, data, listener, now, time_out, mode);
  unsigned command = 0x23;
  std::uint32_t value = 0;
  if (data.size() == 4) [[likely]] {
    value = can::load_as<std::uint32_t>(data.data());
  } else {
    value = can::load_u32(data);
    command |= static_cast<unsigned>(4 - data.size()) << 2;
  }
  expedited_ = true;
  return start(State::initiate_download, sdo::frame(request_, command, sdo::multiplexer(index, sub), value),
               listener, now, time_out);
}

[[gnu::noinline]] bool SdoClient::start_long_download(std::uint16_t index, std::uint8_t sub,
                                                      std::span<const std::uint8_t> data,
                                                      SdoClientListener& listener, can::Time now,
                                                      can::Duration time_out, Mode mode) {
  source_.begin(data);
  return start_download(mode == Mode::block ? State::initiate_block_download : State::initiate_download,
                        index, sub, static_cast<std::uint32_t>(data.size()), listener, now, time_out);
}

bool SdoClient::download(std::uint16_t index, std::uint8_t sub, ByteSource& source,
                         std::optional<std::uint32_t> size, SdoClientListener& listener, can::Time now,
                         can::Duration time_out, Mode mode) {
  if (busy()) return false;
  source_.begin(source);
  return start_download(mode == Mode::block ? State::initiate_block_download : State::initiate_download,
                        index, sub, size, listener, now, time_out);
}

void SdoClient::cancel(AbortCode code) {
  if (!busy()) return;
  drop(code);
  sink_->send(sdo::abort_frame(request_, multiplexer_, code));
}

void SdoClient::drop(AbortCode code) noexcept {
  state_ = State::idle;
  block_sender_.stop();
  alarm_ = can::never;
  abort_code_ = code;
}

void SdoClient::finish(AbortCode code, can::Time now) {
  state_ = State::idle;
  block_sender_.stop();
  alarm_ = can::never;
  abort_code_ = code;
  listener_->sdo_finished(*this, now);  // may start the next transfer
}

void SdoClient::give_up(AbortCode code, can::Time now) {
  sink_->send(sdo::abort_frame(request_, multiplexer_, code));
  end_ = End::gave_up;
  finish(code, now);
}

// What does not fit: the server gets the code of a full memory, the listener that of too small a buffer.
void SdoClient::refuse(AbortCode code, can::Time now) {
  if (code != buffer_too_small) return give_up(code, now);
  sink_->send(sdo::abort_frame(request_, multiplexer_, AbortCode::out_of_memory));
  finish(buffer_too_small, now);
}

/// An answer on this channel while a transfer runs.
void SdoClient::process(const can::Frame& frame, can::Time now) {
  switch (state_) {
    case State::idle: return;
    case State::initiate_upload: return upload_initiated(frame, now);
    case State::upload_segment: return segment_uploaded(frame, now);
    case State::initiate_download: return download_initiated(frame, now);
    case State::download_segment: return segment_downloaded(frame, now);
    default: return receive_in_block(frame, now);
  }
}

// Bytes that are missing are no zeros: what the answer says cannot be known.
[[gnu::noinline]] void SdoClient::receive_short(const can::Frame& frame, can::Time now) {
  if (state_ == State::idle) return;
  const bool is_first_answer = state_ == State::initiate_upload || state_ == State::initiate_download ||
                               state_ == State::initiate_block_upload ||
                               state_ == State::initiate_block_download;
  const bool is_abort = frame.dlc != 0 && frame.data[0] == 0x80;
  constexpr std::uint8_t command_and_object = 4;
  if (is_first_answer && !is_abort && frame.dlc >= command_and_object && !is_about_this_object(frame))
    return;  // late, or of another client
  if (!is_abort) sink_->send(sdo::abort_frame(request_, multiplexer_, AbortCode::length_too_low));
  short_answer_ = frame;
  end_ = End::short_answer;
  finish(AbortCode::length_too_low, now);
}

/// Not the answer that is due: an abort, or a mistake of the server.
[[gnu::noinline]] void SdoClient::unexpected(const can::Frame& frame, can::Time now) {
  if (static_cast<ServerCommand>(frame.data[0] >> 5) == ServerCommand::abort) return aborted(frame, now);
  give_up(AbortCode::command_specifier, now);
}

void SdoClient::aborted(const can::Frame& frame, can::Time now) {
  const auto code = static_cast<AbortCode>(sdo::value(frame));
  // An abort without a reason is one, too.
  finish(code != AbortCode::none ? code : AbortCode::general, now);
}

bool SdoClient::is_about_this_object(const can::Frame& frame) const noexcept {
  return sdo::multiplexer(frame) == multiplexer_;
}

void SdoClient::upload_initiated(const can::Frame& frame, can::Time now) {
  if (sdo::command_and_multiplexer(frame) == (0x40U | multiplexer_)) return object_uploaded(frame, now);
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::initiate_upload) {
    return unexpected(frame, now);
  }
  // A late answer to a transfer given up: nothing.
}

inline void SdoClient::object_uploaded(const can::Frame& frame, can::Time now) {
  is_size_indicated_ = (frame.data[0] & sdo::expedited_bit) == 0 || (frame.data[0] & sdo::size_bit) != 0;
  if ((frame.data[0] & sdo::expedited_bit) == 0) return long_upload_initiated(frame, now);
  constexpr std::size_t most_expedited = 4;
  if (into_ != nullptr || maximum_size_ < most_expedited) return receive_expedited(frame, now);
  collector_.append(sdo::value(frame), sdo::expedited_data(frame).size());
  finish(AbortCode::none, now);
}

void SdoClient::receive_expedited(const can::Frame& frame, can::Time now) {
  const auto data = sdo::expedited_data(frame);
  if (data.size() > maximum_size_) return refuse(buffer_too_small, now);
  if (into_ == nullptr) {
    collector_.append(sdo::value(frame), data.size());
  } else if (const AbortCode code = into_->write(data); code != AbortCode::none) {
    return give_up(code, now);
  }
  finish(AbortCode::none, now);
}

void SdoClient::long_upload_initiated(const can::Frame& frame, can::Time now) {
  std::optional<std::size_t> announced;
  if ((frame.data[0] & sdo::size_bit) != 0) announced = sdo::value(frame);
  if (announced && *announced > maximum_size_) return refuse(buffer_too_small, now);
  collector_.begin(into_, maximum_size_, buffer_too_small, announced, 0);
  state_ = State::upload_segment;
  request_segment(now);
}

void SdoClient::request_segment(can::Time now) {
  restart_time_out(now);
  sink_->send(sdo::frame(request_, 0x60U | toggle_));
}

void SdoClient::segment_uploaded(const can::Frame& frame, can::Time now) {
  // Not the last one, with the toggle bit that is due, and nothing to see to.
  if ((frame.data[0] & ~sdo::unused_bits) == toggle_ &&
      collector_.add_plain(frame, sdo::segment_length(frame))) {
    toggle_ ^= sdo::toggle_bit;
    return request_segment(now);
  }
  receive_segment_checked(frame, now);
}

void SdoClient::receive_segment_checked(const can::Frame& frame, can::Time now) {
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::upload_segment) {
    return unexpected(frame, now);
  }
  if ((frame.data[0] & sdo::toggle_bit) != toggle_) return give_up(AbortCode::toggle_bit, now);
  AbortCode code = collector_.add(frame, sdo::segment_length(frame));
  const bool last = (frame.data[0] & sdo::last_bit) != 0;
  if (last && code == AbortCode::none) code = collector_.finish(0);
  if (code != AbortCode::none) return refuse(code, now);
  if (last) return finish(AbortCode::none, now);
  toggle_ ^= sdo::toggle_bit;
  request_segment(now);
}

void SdoClient::download_initiated(const can::Frame& frame, can::Time now) {
  // The command and the object that are due, asked at once.
  if (expedited_ && sdo::command_and_multiplexer(frame) == (0x60U | multiplexer_)) {
    return finish(AbortCode::none, now);
  }
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::initiate_download) {
    return unexpected(frame, now);
  }
  if (!is_about_this_object(frame)) return;
  state_ = State::download_segment;
  send_segment(now);
}

void SdoClient::send_segment(can::Time now) {
  const auto rest = source_.window();
  if (rest.size() <= sdo::segment_size) return send_last_segment(now);
  const can::Frame segment = sdo::block_segment(request_, toggle_, rest);
  source_.advance(sdo::segment_size);
  restart_time_out(now);
  sink_->send(segment);
}

/// The last one at hand: perhaps of all.
void SdoClient::send_last_segment(can::Time now) {
  if (const AbortCode code = source_.prepare(sdo::segment_size); code != AbortCode::none) {
    return give_up(code, now);
  }
  const auto window = source_.window();
  const std::size_t count = std::min(window.size(), sdo::segment_size);
  all_sent_ = count == window.size() && source_.ends_in_window();
  const can::Frame segment = sdo::segment(request_, toggle_, window, all_sent_);
  source_.advance(count);
  restart_time_out(now);
  sink_->send(segment);
}

void SdoClient::segment_downloaded(const can::Frame& frame, can::Time now) {
  constexpr unsigned command_and_toggle = 0xF0;
  if ((frame.data[0] & command_and_toggle) == (0x20U | toggle_) && !all_sent_) {
    toggle_ ^= sdo::toggle_bit;
    return send_segment(now);
  }
  if (static_cast<ServerCommand>(frame.data[0] >> 5) != ServerCommand::download_segment) {
    return unexpected(frame, now);
  }
  if ((frame.data[0] & sdo::toggle_bit) != toggle_) return give_up(AbortCode::toggle_bit, now);
  finish(AbortCode::none, now);
}

void SdoClient::tick(can::Time now) {
  if (!busy() || now < alarm_) return;
  const can::Time end = can::later(last_heard_, time_out_);
  if (now >= end) return give_up(AbortCode::timed_out, now);
  if (state_ == State::block_download && block_sender_.is_sending())
    return send_block(now);  // the transmit queue was full
  alarm_ = end;
  if (state_ != State::block_upload) return;
  const can::Duration pause = time_out_ / 4;
  const bool is_silent = now >= can::later(last_heard_, pause);
  alarm_ = std::min(end, can::later(is_silent ? now : last_heard_, pause));
  if (is_silent && block_receiver_.may_confirm_early()) {
    sink_->send(block_receiver_.early_confirmation(request_));
  }
}

}  // namespace canopus::canopen
