// Block transfers of the SDO client.

#include "canopus/canopen/sdo_client.hpp"
#include "canopus/canopen/sdo_crc.hpp"
#include "canopus/canopen/sdo_frame.hpp"

namespace canopus::canopen {

using sdo::ServerCommand;

namespace {

constexpr can::Duration full_queue_retry = std::chrono::microseconds(500);

}  // namespace

void SdoClient::receive_in_block(const can::Frame& frame, can::Time now) {
  const auto command = static_cast<ServerCommand>(frame.data[0] >> 5);
  const unsigned subcommand = frame.data[0] & 3U;
  switch (state_) {
    case State::initiate_block_upload:
      if (command == ServerCommand::initiate_upload) return upload_initiated(frame, now);  // it switched
      if (command == ServerCommand::block_upload && (subcommand & 1U) == 0) {
        return block_upload_initiated(frame, now);
      }
      break;
    case State::block_upload: return block_segment(frame, now);
    case State::block_upload_end:
      if (command == ServerCommand::block_upload && (subcommand & 1U) == 1)
        return end_block_upload(frame, now);
      break;
    case State::initiate_block_download:
      if (command == ServerCommand::block_download && subcommand == 0) {
        return block_download_initiated(frame, now);
      }
      break;
    case State::block_download:
    case State::block_download_confirm:
      if (command == ServerCommand::block_download && subcommand == 2) return block_confirmed(frame, now);
      break;
    case State::block_download_end:
      if (command == ServerCommand::block_download && subcommand == 1) return finish(AbortCode::none, now);
      break;
    default: break;
  }
  give_up(AbortCode::command_specifier, now);
}

void SdoClient::block_upload_initiated(const can::Frame& frame, can::Time now) {
  if (!is_about_this_object(frame)) return;
  std::optional<std::size_t> announced;
  if ((frame.data[0] & 2U) != 0) announced = sdo::value(frame);
  const std::size_t maximum = maximum_size_ != 0 ? maximum_size_ : SIZE_MAX / 2;
  if (announced && *announced > maximum) return refuse(buffer_too_small, now);
  collector_.begin(into_, maximum, buffer_too_small, announced, sdo::segment_size);
  crc_is_used_ = (frame.data[0] & sdo::crc_bit) != 0;
  collector_.count_crc(crc_is_used_);
  block_size_ = own_block_size;
  sequence_ = 0;
  last_sequence_ = 0;
  confirmed_early_ = false;
  state_ = State::block_upload;
  restart_time_out(now);
  deadline_ = can::later(now, time_out_ / 4);
  sink_->send(sdo::frame(request_cob_id_, 0xA3));
}

void SdoClient::block_segment(const can::Frame& frame, can::Time now) {
  const std::uint8_t sequence = frame.data[0] & 0x7F;
  const bool last = (frame.data[0] & 0x80) != 0;
  if (sequence == 0 || sequence > block_size_) return give_up(AbortCode::sequence_number, now);
  last_heard_ = now;
  confirmed_early_ = false;
  if (sequence == sequence_ + 1) {
    const AbortCode code = collector_.add({&frame.data[1], sdo::segment_size});
    if (code != AbortCode::none) return refuse(code, now);
    sequence_ = sequence;
    if (last) last_sequence_ = sequence;
  }
  if (last || sequence == block_size_) confirm_block();
}

void SdoClient::confirm_block() {
  can::Frame answer = sdo::frame(request_cob_id_, 0xA2);
  answer.data[1] = sequence_;
  answer.data[2] = block_size_;
  if (last_sequence_ != 0) state_ = State::block_upload_end;
  sequence_ = 0;
  sink_->send(answer);
}

void SdoClient::end_block_upload(const can::Frame& frame, can::Time now) {
  AbortCode code = collector_.finish(frame.data[0] >> 2 & 7U);
  const auto crc = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
  if (code == AbortCode::none && crc_is_used_ && crc != collector_.crc()) code = AbortCode::crc;
  if (code != AbortCode::none) return refuse(code, now);
  sink_->send(sdo::frame(request_cob_id_, 0xA1));
  finish(AbortCode::none, now);
}

void SdoClient::block_download_initiated(const can::Frame& frame, can::Time now) {
  if (!is_about_this_object(frame)) return;
  block_size_ = frame.data[4];
  if (block_size_ < 1 || block_size_ > 127) return give_up(AbortCode::block_size, now);
  crc_is_used_ = (frame.data[0] & sdo::crc_bit) != 0;
  crc_ = 0;
  sequence_ = 0;
  last_sequence_ = 0;
  state_ = State::block_download;
  restart_time_out(now);
  send_block(now);
}

// A confirmation may come from inside send(), when the bus is a function call: it is then block_confirmed()
// that says where this loop goes on.
void SdoClient::send_block(can::Time now) {
  if (sending_) return;
  sending_ = true;
  AbortCode failure = AbortCode::none;
  while (state_ == State::block_download) {
    failure = source_.prepare(block_size_ * sdo::segment_size);
    if (failure != AbortCode::none) break;
    const auto rest = source_.window().subspan(sequence_ * sdo::segment_size);
    const std::size_t count = std::min(rest.size(), sdo::segment_size);
    const bool last = count == rest.size() && source_.ends_in_window();
    const auto sequence = static_cast<std::uint8_t>(sequence_ + 1);
    can::Frame segment = sdo::frame(request_cob_id_, sequence | (last ? 0x80U : 0U));
    std::copy_n(rest.data(), count, &segment.data[1]);
    sequence_ = sequence;
    if (last) {
      last_sequence_ = sequence;
      unused_ = static_cast<std::uint8_t>(sdo::segment_size - count);
    }
    if (last || sequence == block_size_) {
      state_ = State::block_download_confirm;
      deadline_ = can::later(last_heard_, time_out_);
    }
    if (!sink_->send(segment)) {  // not out: again later
      if (sequence_ != sequence) break;
      --sequence_;
      if (last) last_sequence_ = 0;
      state_ = State::block_download;
      deadline_ = can::later(now, full_queue_retry);
      break;
    }
  }
  sending_ = false;
  if (failure != AbortCode::none) give_up(failure, now);
}

void SdoClient::block_confirmed(const can::Frame& frame, can::Time now) {
  const std::uint8_t confirmed = frame.data[1];
  const std::uint8_t block_size = frame.data[2];
  if (confirmed > sequence_) return give_up(AbortCode::sequence_number, now);
  if (block_size < 1 || block_size > 127) return give_up(AbortCode::block_size, now);
  restart_time_out(now);
  const bool complete = last_sequence_ != 0 && confirmed == last_sequence_;
  const std::size_t bytes = confirmed * sdo::segment_size - (complete ? unused_ : 0U);
  if (crc_is_used_) crc_ = sdo::crc16(crc_, source_.window().first(bytes));
  source_.advance(bytes);
  block_size_ = block_size;
  sequence_ = 0;
  last_sequence_ = 0;
  if (!complete) {
    state_ = State::block_download;
    return send_block(now);
  }
  state_ = State::block_download_end;
  can::Frame end = sdo::frame(request_cob_id_, 0xC1U | static_cast<unsigned>(unused_) << 2);
  end.data[1] = static_cast<std::uint8_t>(crc_);
  end.data[2] = static_cast<std::uint8_t>(crc_ >> 8);
  sink_->send(end);
}

}  // namespace canopus::canopen
