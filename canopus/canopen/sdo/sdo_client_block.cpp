// Block transfers of the SDO client.

#include "canopus/canopen/sdo/sdo_client.hpp"
#include "canopus/canopen/sdo/sdo_frame.hpp"

namespace canopus::canopen {

using sdo::ServerCommand;

void SdoClient::receive_in_block(const can::Frame& frame, can::Time now) {
  const auto command = static_cast<ServerCommand>(frame.data[0] >> 5);
  const unsigned subcommand = frame.data[0] & 3U;
  // Among the segments of a block, 81H.. is the last segment, also when it comes twice.
  const bool among_segments = state_ == State::block_upload || state_ == State::block_upload_end;
  if (command == ServerCommand::abort && (!among_segments || frame.data[0] == 0x80))
    return aborted(frame, now);
  switch (state_) {
    case State::initiate_block_upload:
      if (command == ServerCommand::initiate_upload) {  // it switched to another protocol
        if (switch_threshold_ != 0) return upload_initiated(frame, now);
        if (!is_about_this_object(frame)) return;
        break;
      }
      if (command == ServerCommand::block_upload && (subcommand & 1U) == 0) {
        return block_upload_initiated(frame, now);
      }
      break;
    case State::block_upload: return block_segment(frame, now);
    case State::block_upload_end:
      if (block_receiver_.is_last_segment_again(frame)) return;
      if (command == ServerCommand::block_upload && (subcommand & 1U) == 1)
        return end_block_upload(frame, now);
      break;
    case State::initiate_block_download:
      if (command == ServerCommand::block_download && subcommand == 0) {
        return block_download_initiated(frame, now);
      }
      break;
    case State::block_download:
      if (command == ServerCommand::block_download && subcommand == 2) return block_confirmed(frame, now);
      break;
    case State::block_download_end:
      if (command != ServerCommand::block_download) break;
      if (subcommand == 1) return finish(AbortCode::none, now);
      if (subcommand == 2 && block_sender_.is_confirmed_again(frame)) return;
      break;
    default: break;
  }
  give_up(AbortCode::command_specifier, now);
}

void SdoClient::block_upload_initiated(const can::Frame& frame, can::Time now) {
  if (!is_about_this_object(frame)) return;
  std::optional<std::size_t> announced;
  if ((frame.data[0] & 2U) != 0) announced = sdo::value(frame);
  if (announced && *announced > maximum_size_) return refuse(buffer_too_small, now);
  is_size_indicated_ = true;
  const bool with_crc = (frame.data[0] & sdo::crc_bit) != 0;
  collector_.begin(into_, maximum_size_, buffer_too_small, announced, sdo::segment_size);
  collector_.count_crc(with_crc);
  block_receiver_.begin(own_block_size, with_crc, frame);
  state_ = State::block_upload;
  restart_time_out(now);
  alarm_ = can::later(now, time_out_ / 4);
  sink_->send(sdo::frame(request_, 0xA3));
}

void SdoClient::block_segment(const can::Frame& frame, can::Time now) {
  last_heard_ = now;
  auto next = BlockReceiver::Next::segment;
  if (const AbortCode code = block_receiver_.receive(frame, collector_, next); code != AbortCode::none) {
    return refuse(code, now);
  }
  if (next == BlockReceiver::Next::confirmation) confirm_block();
}

void SdoClient::confirm_block() {
  if (block_receiver_.has_all()) state_ = State::block_upload_end;
  sink_->send(block_receiver_.confirmation(request_, own_block_size));
}

void SdoClient::end_block_upload(const can::Frame& frame, can::Time now) {
  if (const AbortCode code = block_receiver_.finish(frame, collector_); code != AbortCode::none) {
    return refuse(code, now);
  }
  sink_->send(sdo::frame(request_, 0xA1));
  finish(AbortCode::none, now);
}

void SdoClient::block_download_initiated(const can::Frame& frame, can::Time now) {
  if (!is_about_this_object(frame)) return;
  const AbortCode code = block_sender_.begin(frame.data[4], (frame.data[0] & sdo::crc_bit) != 0);
  if (code != AbortCode::none) return give_up(code, now);
  state_ = State::block_download;
  restart_time_out(now);
  send_block(now);
}

void SdoClient::send_block(can::Time now) {
  const AbortCode code = block_sender_.send(source_, *sink_, request_);
  if (code != AbortCode::none) return give_up(code, now);
  if (state_ != State::block_download) return;  // ended by answers that came meanwhile
  alarm_ = block_sender_.is_sending() ? can::later(now, BlockSender::full_queue_retry)
                                      : can::later(last_heard_, time_out_);
}

void SdoClient::block_confirmed(const can::Frame& frame, can::Time now) {
  const AbortCode code = block_sender_.confirmed(frame, source_);
  if (code != AbortCode::none) return give_up(code, now);
  restart_time_out(now);
  if (!block_sender_.is_complete()) return send_block(now);
  state_ = State::block_download_end;
  sink_->send(block_sender_.end(request_));
}

}  // namespace canopus::canopen
